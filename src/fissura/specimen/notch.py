"""Notches: ideal cuts of zero width and saw cuts of a given width."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError

if TYPE_CHECKING:
    from fissura.case import Notch as NotchPart

__all__ = ["AXES", "FACES", "Notch", "notch_from_part"]

FloatArray = NDArray[np.float64]

AXES = {"x": 0, "y": 1, "z": 2}

#: Distance from the plane of an ideal cut, relative to the specimen's size, that is due to round-off.
_IN_PLANE = 1e-9

#: Faces of a box: name -> (axis, 0 for the lower and 1 for the upper side).
FACES = {"left": (0, 0), "right": (0, 1), "bottom": (1, 0), "top": (1, 1), "front": (2, 0), "back": (2, 1)}


@dataclass(frozen=True)
class Notch:
    """A straight notch across the specimen.

    It removes the points with ``|x_normal - position| < width / 2`` that lie less than `depth` below the
    face. A notch of zero width is a cut: it removes nothing, but no contact crosses it.

    Attributes
    ----------
    normal : int
        Axis perpendicular to the plane of the notch.
    axis : int
        Axis along which the notch is deep, perpendicular to the face from which it is cut.
    side : int
        0 when cut from the lower face of `axis`, 1 from the upper.
    position : float
        Coordinate of the mid-plane along `normal` [m].
    root : float
        Coordinate of the notch's root along `axis` [m].
    depth, width : float
        Depth and width [m].
    size : tuple of float
        Dimensions of the specimen [m].
    """

    normal: int
    axis: int
    side: int
    position: float
    root: float
    depth: float
    width: float
    size: tuple[float, float, float]

    @property
    def through(self) -> int:
        """Axis along which the notch runs through the whole specimen."""
        return 3 - self.normal - self.axis

    @property
    def void_volume(self) -> float:
        """Volume that the notch removes [m^3]."""
        return self.width * self.depth * self.size[self.through]

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the removed box [m]; of a cut, the corners of its plane."""
        low, high = np.zeros(3), np.asarray(self.size, float).copy()
        low[self.normal] = self.position - 0.5 * self.width
        high[self.normal] = self.position + 0.5 * self.width
        (high if self.side == 0 else low)[self.axis] = self.root
        return low, high

    def height(self, x: FloatArray) -> FloatArray:
        """Distance of points above the root, negative beside the notch [m]; shape (n, 3) -> (n,)."""
        h = x[..., self.axis] - self.root
        return h if self.side == 0 else -h

    def in_void(self, x: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie inside the removed volume; shape (n, 3) -> (n,)."""
        return (np.abs(x[..., self.normal] - self.position) < 0.5 * self.width) & (self.height(x) < 0.0)

    def in_mouth(self, x: FloatArray) -> NDArray[np.bool_]:
        """Whether points belong to neither side of the notch, root included; shape (n, 3) -> (n,).

        Of a saw cut these are the points that it removes; of an ideal cut those in its plane, to round-off: which of
        the bodies on both sides would own them is chance.
        """
        if self.width > 0.0:
            return self.in_void(x)
        tolerance = _IN_PLANE * max(self.size)
        return (np.abs(x[..., self.normal] - self.position) <= tolerance) & (self.height(x) <= tolerance)

    def tip_lines(self) -> FloatArray:
        """Ends of the lines along the notch's tip, shape (k, 2, 3): one for a cut, both corners of a saw cut."""
        offsets = (0.0,) if self.width == 0.0 else (-0.5 * self.width, 0.5 * self.width)
        lines = np.zeros((len(offsets), 2, 3))
        for line, offset in zip(lines, offsets, strict=True):
            line[:, self.normal] = self.position + offset
            line[:, self.axis] = self.root
            line[1, self.through] = self.size[self.through]
        return lines


def notch_from_part(part: NotchPart, size: tuple[float, float, float], key: str) -> Notch:
    """Build a notch from its part of the case and check that it fits into a box of the given size.

    Raises
    ------
    InputError
        Unknown face or axis, a notch as deep as the specimen or outside it.
    """
    if part.face not in FACES:
        raise InputError(f"{key}.face", f"{part.face!r} is not a face", ", ".join(FACES))
    axis, side = FACES[part.face]
    normal = AXES[part.normal]
    if normal == axis:
        raise InputError(
            f"{key}.normal", f"'{'xyz'[normal]}' is perpendicular to the face {part.face!r}", "another axis"
        )
    if part.depth >= size[axis]:
        raise InputError(
            f"{key}.depth",
            f"{part.depth:g} m cuts through the specimen",
            f"less than {size[axis]:g} m, the specimen's size there",
        )
    low, high = part.position - 0.5 * part.width, part.position + 0.5 * part.width
    if not (0.0 < low <= high < size[normal]):
        raise InputError(
            f"{key}.position",
            f"a notch from {low:g} to {high:g} m is not inside the specimen",
            f"between 0 and {size[normal]:g} m",
        )
    root = part.depth if side == 0 else size[axis] - part.depth
    return Notch(normal, axis, side, part.position, root, part.depth, part.width, size)
