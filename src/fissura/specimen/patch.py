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
    along : int
        Axis on the face along which the place is given.
    """

    points: FloatArray
    weights: FloatArray
    axis: int
    outward: float
    along: int

    @property
    def centroid(self) -> FloatArray:
        """Weighted mean of the points, shape (3,) [m]."""
        return self.weights @ self.points

    @property
    def frame(self) -> FloatArray:
        """Unit vectors in rows, shape (3, 3): the axis along which the place is given, that normal to the face, across.

        The last one is the direction of a line, and of the platen that a strip stands for, whatever their lengths.
        """
        return np.eye(3)[[self.along, self.axis, 3 - self.along - self.axis]]


def _rows(low: float, high: float, spacing: float) -> FloatArray:
    """Points that stand for equal shares of [low, high], no farther apart than `spacing`.

    Centres of equal intervals; of a single one its two Gauss points, so that narrow strips have their turns.
    """
    count = max(1, int(np.ceil((high - low) / spacing - 1e-9)))
    share = (np.arange(count) + 0.5) / count if count > 1 else 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)
    return low + (high - low) * share


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
    along = AXES[part.along]
    if along == axis:
        raise InputError(f"{key}.along", f"'{'xyz'[along]}' is perpendicular to the face {part.face!r}", "another axis")
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
        across = 3 - axis - along
        if part.at is None:
            positions = _rows(0.0, size[along], spacing)
        else:
            low, high = part.at - 0.5 * part.width, part.at + 0.5 * part.width
            if low < -tolerance or high > size[along] + tolerance:
                place = f"a strip from {low:g} to {high:g} m" if part.width else f"{part.at:g} m"
                raise InputError(
                    f"{key}.at",
                    f"{place} is off the face {part.face!r}",
                    f"between 0 and {size[along]:g} m along {'xyz'[along]}",
                )
            positions = _rows(low, high, spacing) if part.width > 0.0 else np.array([part.at])
        a, b = np.meshgrid(positions, _rows(0.0, size[across], spacing), indexing="ij")
        points = np.empty((a.size, 3))
        points[:, axis], points[:, along], points[:, across] = plane, a.ravel(), b.ravel()
    where = f"{key}.{'at' if part.point is None else 'point'}"
    clear = np.ones(len(points), bool)
    for notch in box.notches:
        clear &= ~notch.in_mouth(points)
    if not clear.any():
        cut = next((notch for notch in box.notches if notch.width == 0.0 and notch.in_mouth(points).all()), None)
        problem = "lies in the mouth of a notch"
        if cut is not None:
            problem += f", in the plane {'xyz'[cut.normal]} = {cut.position:g} m of an ideal cut: neither side owns it"
        raise InputError(where, problem, "a place on the specimen's surface beside the notch")
    points = points[clear]
    return Patch(points, np.full(len(points), 1.0 / len(points)), axis, 2.0 * side - 1.0, along)
