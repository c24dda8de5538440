"""Regions of a specimen, balls and boxes: where the material stays elastic, where it is fine from the start."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from fissura.arrays import BoolArray, FloatArray
from fissura.case import BallRegion, BoxRegion, Case
from fissura.errors import InputError
from fissura.specimen import domain_from_case

_KEY = "material.elastic"


def _empty(*shape: int) -> FloatArray:
    return np.empty(shape)


@dataclass(frozen=True)
class Regions:
    """Union of balls and boxes; nothing by default.

    Attributes
    ----------
    balls, radii : (b, 3), (b,) arrays
        Centres and radii [m].
    lower, upper : (q, 3) arrays
        Corners of boxes [m].
    """

    balls: FloatArray = field(default_factory=lambda: _empty(0, 3))
    radii: FloatArray = field(default_factory=lambda: _empty(0))
    lower: FloatArray = field(default_factory=lambda: _empty(0, 3))
    upper: FloatArray = field(default_factory=lambda: _empty(0, 3))

    @classmethod
    def from_parts(cls, parts: Sequence[BallRegion | BoxRegion]) -> Regions:
        """Regions as a case lists them."""
        balls = [part for part in parts if part.type == "ball"]
        boxes = [part for part in parts if part.type == "box"]
        return cls(
            np.array([part.center for part in balls]).reshape(-1, 3),
            np.array([part.radius for part in balls], dtype=float),
            np.array([part.lower for part in boxes]).reshape(-1, 3),
            np.array([part.upper for part in boxes]).reshape(-1, 3),
        )

    @classmethod
    def everywhere(cls) -> Regions:
        """All of space."""
        return cls(lower=np.full((1, 3), -np.inf), upper=np.full((1, 3), np.inf))

    def __len__(self) -> int:
        return len(self.balls) + len(self.lower)

    def distance(self, x: FloatArray) -> FloatArray:
        """Distance of points from the nearest region [m], zero or negative inside; (n, 3) -> (n,)."""
        nearest = np.full(len(x), np.inf)
        for center, radius in zip(self.balls, self.radii, strict=True):
            nearest = np.minimum(nearest, np.linalg.norm(x - center, axis=1) - radius)
        for low, high in zip(self.lower, self.upper, strict=True):
            outside = np.maximum(np.maximum(low - x, x - high), 0.0)
            nearest = np.minimum(nearest, np.linalg.norm(outside, axis=1))
        return nearest

    def contains(self, x: FloatArray) -> BoolArray:
        """Whether points lie in a region, its surface included; (n, 3) -> (n,)."""
        return np.asarray(self.distance(x) <= 0.0, dtype=np.bool_)

    def overlaps(self, bounds: FloatArray) -> bool:
        """Whether part of a box, its corners ``bounds`` (2, 3) [m], lies in a region; its surface does not count."""
        low, high = bounds
        gap = np.linalg.norm(self.balls - np.clip(self.balls, low, high), axis=1)
        return bool((gap < self.radii).any() or np.all((self.lower < high) & (self.upper > low), axis=1).any())


def elastic_from_case(case: Case) -> Regions:
    """Regions of a case where contacts never get damage.

    Raises
    ------
    InputError
        A region lies outside the specimen.
    """
    check_overlap(case, case.material.elastic, _KEY)
    return Regions.from_parts(case.material.elastic)


def check_overlap(case: Case, parts: Sequence[BallRegion | BoxRegion], key: str) -> None:
    """Each of the regions at a key must overlap the specimen.

    Raises
    ------
    InputError
        One lies outside.
    """
    bounds = domain_from_case(case).bounds
    for k, part in enumerate(parts):
        if not Regions.from_parts([part]).overlaps(bounds):
            raise InputError(
                f"{key}[{k}]" if len(parts) > 1 else key,
                f"the {part.type} lies outside the specimen",
                "a region that overlaps the specimen, " + " x ".join(f"{a:g} to {b:g} m" for a, b in bounds.T),
            )


def check_not_everywhere(elastic: Regions, x: FloatArray) -> None:
    """Some of the specimen must be able to crack.

    Parameters
    ----------
    elastic : Regions
        Where contacts never get damage.
    x : (n, 3) array
        Centroids of all contacts at full resolution [m].

    Raises
    ------
    InputError
        All of them lie in elastic regions.
    """
    if elastic.contains(x).all():
        raise InputError(_KEY, "covers the whole specimen, so that nothing can crack", "regions that leave some out")
