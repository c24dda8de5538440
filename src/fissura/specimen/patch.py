"""Patches: points, lines, strips and whole faces of the specimen, sampled by weighted points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.specimen.notch import AXES, FACES

if TYPE_CHECKING:
    from fissura.case import Patch as PatchPart
    from fissura.specimen.box import Box

__all__ = ["Patch", "patch_from_part"]

FloatArray = NDArray[np.float64]

_ON_SURFACE = 1e-6  # relative to the specimen's size


@dataclass(frozen=True)
class Patch:
    """Points sampled over a part of the surface.

    Attributes
    ----------
    points : (k, 3) array
        Sample points [m].
    weights : (k,) array
        Share of each point; they sum to 1.
    axis : int
        Axis normal to the face.
    outward : float
        +1 or -1, the direction of the outward normal along `axis`.
    """

    points: FloatArray
    weights: FloatArray
    axis: int
    outward: float

    @property
    def centroid(self) -> FloatArray:
        """Weighted mean of the points, shape (3,) [m]."""
        return self.weights @ self.points


def _midpoints(low: float, high: float, spacing: float) -> FloatArray:
    """Centres of equal intervals no longer than `spacing` that cover [low, high]."""
    count = max(1, int(np.ceil((high - low) / spacing - 1e-9)))
    return low + (high - low) * (np.arange(count) + 0.5) / count


def patch_from_part(part: PatchPart, box: Box, spacing: float, key: str) -> Patch:
    """Sample a patch of a box's face.

    Parameters
    ----------
    part : Patch part of the case
        Face, and a point, a line, a strip or nothing (the whole face).
    box : Box
        The specimen.
    spacing : float
        Largest distance of sample points [m].
    key : str
        Where the part stands in the case file, for messages.

    Raises
    ------
    InputError
        Unknown face, or a patch that is not on the specimen's surface.
    """
    if part.face not in FACES:
        raise InputError(f"{key}.face", f"{part.face!r} is not a face", ", ".join(FACES))
    axis, side = FACES[part.face]
    size = box.size
    tolerance = _ON_SURFACE * max(size)
    plane = size[axis] * side
    if part.point is not None:
        point = np.asarray(part.point, float)
        if (
            abs(point[axis] - plane) > tolerance
            or np.any(point < -tolerance)
            or np.any(point > size + np.full(3, tolerance))
        ):
            raise InputError(
                f"{key}.point",
                f"({', '.join(f'{v:g}' for v in point)}) m is not on the face {part.face!r}",
                f"{'xyz'[axis]} = {plane:g} m, other coordinates inside the specimen",
            )
        points = np.clip(point, 0.0, size)[None, :]
    else:
        along = AXES[part.along]
        if along == axis:
            raise InputError(
                f"{key}.along", f"'{'xyz'[along]}' is perpendicular to the face {part.face!r}", "another axis"
            )
        across = 3 - axis - along
        if part.at is None:
            positions = _midpoints(0.0, size[along], spacing)
        else:
            low, high = part.at - 0.5 * part.width, part.at + 0.5 * part.width
            if low < -tolerance or high > size[along] + tolerance:
                place = f"a strip from {low:g} to {high:g} m" if part.width else f"{part.at:g} m"
                raise InputError(
                    f"{key}.at",
                    f"{place} is off the face {part.face!r}",
                    f"between 0 and {size[along]:g} m along {'xyz'[along]}",
                )
            positions = _midpoints(low, high, spacing) if part.width > 0.0 else np.array([part.at])
        a, b = np.meshgrid(positions, _midpoints(0.0, size[across], spacing), indexing="ij")
        points = np.empty((a.size, 3))
        points[:, axis], points[:, along], points[:, across] = plane, a.ravel(), b.ravel()
    outside = np.zeros(len(points), bool)
    for notch in box.notches:
        outside |= notch.in_void(points)
    if outside.all():
        raise InputError(
            f"{key}.{'point' if part.point is not None else 'at'}",
            "lies in the mouth of a notch",
            "a place on the specimen's surface",
        )
    points = points[~outside]
    return Patch(points, np.full(len(points), 1.0 / len(points)), axis, 2.0 * side - 1.0)
