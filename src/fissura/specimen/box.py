"""A box with named faces and optional notches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.specimen.notch import FACES, Notch, notch_from_part

if TYPE_CHECKING:
    from fissura.case import Case

__all__ = ["Box"]


@dataclass(frozen=True)
class Box:
    """A rectangular block, one corner at the origin.

    Attributes
    ----------
    size : tuple of float
        Length along x, depth along y, thickness along z [m].
    notches : tuple of Notch
        Notches cut into it.
    """

    size: tuple[float, float, float]
    notches: tuple[Notch, ...] = ()

    #: Names of the surfaces; notch walls are one surface.
    surfaces = (*FACES, "notch")

    @classmethod
    def from_case(cls, case: Case) -> Box:
        """Build the box of a case.

        Raises
        ------
        InputError
            A notch that does not fit, or overlaps another.
        """
        size = case.specimen.size
        many = len(case.notch) > 1
        notches = tuple(
            notch_from_part(part, size, f"notch[{k}]" if many else "notch") for k, part in enumerate(case.notch)
        )
        for k, notch in enumerate(notches):
            for other, earlier in enumerate(notches[:k]):
                (low, high), (lowest, highest) = notch.bounds, earlier.bounds
                if np.all((low <= highest) & (lowest <= high)):
                    raise InputError(f"notch[{k}]", f"overlaps notch[{other}]", "notches apart from each other")
        return cls(size, notches)

    @property
    def volume(self) -> float:
        """Volume without the notches [m^3]."""
        return float(np.prod(self.size)) - sum(notch.void_volume for notch in self.notches)

    @property
    def smallest_section(self) -> float:
        """Area of the smallest section perpendicular to an axis, the notches in its plane taken off [m^2]."""
        areas = np.prod(self.size) / np.asarray(self.size)
        for axis in range(3):
            cuts: dict[float, float] = {}
            for notch in self.notches:
                if notch.normal == axis:
                    area = notch.depth * np.prod(np.delete(self.size, [axis, notch.axis]))
                    cuts[notch.position] = cuts.get(notch.position, 0.0) + float(area)
            areas[axis] -= max(cuts.values(), default=0.0)
        return float(areas.min())

    def contains(self, x: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether points lie in the material; shape (n, 3) -> (n,)."""
        inside: NDArray[np.bool_] = np.all((x >= 0.0) & (x <= np.asarray(self.size)), axis=-1)
        for notch in self.notches:
            inside &= ~notch.in_void(x)
        return inside
