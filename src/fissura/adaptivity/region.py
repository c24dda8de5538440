"""The refined region: a set of balls, lines with a radius, and boxes; and the spacing that it asks for."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fissura.material import Regions

if TYPE_CHECKING:
    from fissura.case import Case
    from fissura.specimen import Box

__all__ = ["RefinedRegion", "region_from_case"]

FloatArray = NDArray[np.float64]


def _empty(*shape: int) -> FloatArray:
    return np.empty(shape)


@dataclass(frozen=True)
class RefinedRegion:
    """Where the specimen is fine (theory section 5).

    Attributes
    ----------
    l_f, l_c : float
        Fine and coarse spacing [m].
    r_f : float
        Radius of the balls around critical centres, and of tip lines [m].
    ramp : float
        Distance ``r_c - r_f`` over which spacing grows from `l_f` to `l_c` [m].
    centers : (k, 3) array
        Critical centres so far [m].
    lines : (q, 2, 3) array
        Ends of lines that are fine within `r_f` from the start [m].
    balls, radii : (b, 3), (b,) arrays
        Further balls from the start [m].
    lower, upper : (b, 3) arrays
        Boxes from the start [m].
    everywhere : bool
        The whole specimen is fine.
    """

    l_f: float
    l_c: float
    r_f: float
    ramp: float
    centers: FloatArray = field(default_factory=lambda: _empty(0, 3))
    lines: FloatArray = field(default_factory=lambda: _empty(0, 2, 3))
    balls: FloatArray = field(default_factory=lambda: _empty(0, 3))
    radii: FloatArray = field(default_factory=lambda: _empty(0))
    lower: FloatArray = field(default_factory=lambda: _empty(0, 3))
    upper: FloatArray = field(default_factory=lambda: _empty(0, 3))
    everywhere: bool = False

    def grown(self, centers: FloatArray) -> RefinedRegion:
        """The same region with further critical centres, shape (k, 3)."""
        return replace(self, centers=np.unique(np.concatenate([self.centers, centers]), axis=0))

    def distance(self, x: FloatArray) -> FloatArray:
        """Distance of points from the region [m], zero or negative inside; (n, 3) -> (n,)."""
        if self.everywhere:
            return np.full(len(x), -np.inf)
        nearest = np.full(len(x), np.inf)
        if len(self.centers):
            nearest = np.asarray(cKDTree(self.centers).query(x)[0], dtype=np.float64) - self.r_f
        for a, b in self.lines:
            along = b - a
            t = np.clip((x - a) @ along / (along @ along), 0.0, 1.0)
            nearest = np.minimum(nearest, np.linalg.norm(x - a - t[:, None] * along, axis=1) - self.r_f)
        given = Regions(self.balls, self.radii, self.lower, self.upper).distance(x)
        return np.asarray(np.minimum(nearest, given), dtype=np.float64)

    def spacing(self, x: FloatArray) -> FloatArray:
        """Wanted spacing at points [m], 0 inside the region; (n, 3) -> (n,)."""
        d = self.distance(x)
        share = np.clip(d / self.ramp, 0.0, 1.0) if self.ramp > 0.0 else np.ones(len(x))
        return np.where(d <= 0.0, 0.0, self.l_f + (self.l_c - self.l_f) * share)


def region_from_case(case: Case, box: Box, *, full: bool) -> RefinedRegion:
    """The region that is fine from the start."""
    part, sizes = case.adaptivity, case.discretization
    lines = [notch.tip_lines() for notch in box.notches] if part.notch_tips else []
    regions = Regions.from_parts(part.regions)
    return RefinedRegion(
        sizes.l_f,
        sizes.l_c,
        part.r_f,
        part.r_c - part.r_f,
        lines=np.concatenate([_empty(0, 2, 3), *lines]),
        balls=regions.balls,
        radii=regions.radii,
        lower=regions.lower,
        upper=regions.upper,
        everywhere=full,
    )
