"""Mirrored nuclei along notches.

A Voronoi facet lies midway between its two nuclei. Where the nuclei on both sides of a notch are mirror images of
each other, the notch's mid-plane is therefore a boundary between bodies at every resolution, and the tip sits
exactly where the case says: the part of a facet below the tip is cut off, the part above it carries.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError

if TYPE_CHECKING:
    from fissura.specimen import Box, Notch

__all__ = ["MirrorZones", "mirror_zones"]

FloatArray = NDArray[np.float64]

#: How far above the tip nuclei are still mirrored, in fine spacings. A point of the notch plane has a nucleus
#: within 1.5 spacings (1 from saturation, 0.5 from the strip kept free along the plane).
REACH = 1.5


@dataclass(frozen=True)
class MirrorZones:
    """Boxes around notches in which nuclei come in mirrored pairs.

    Attributes
    ----------
    lower, upper : (k, 3) array
        Corners of the zones [m]; each is symmetric about its plane.
    axis : (k,) array
        Axis normal to the plane.
    plane : (k,) array
        Coordinate of the plane [m].
    clearance : (k,) array
        Smallest distance of a nucleus from the plane [m].
    """

    lower: FloatArray
    upper: FloatArray
    axis: NDArray[np.int64]
    plane: FloatArray
    clearance: FloatArray

    def zone_of(self, x: FloatArray) -> NDArray[np.int64]:
        """Index of the zone in which each point lies, -1 for none; shape (n, 3) -> (n,)."""
        zone = np.full(len(x), -1)
        for k in range(len(self.axis)):
            zone[np.all((x >= self.lower[k]) & (x <= self.upper[k]), axis=1)] = k
        return zone

    def mirrored(self, x: FloatArray) -> FloatArray:
        """Mirror images of points, themselves outside every zone; shape (n, 3)."""
        out = x.copy()
        zone = self.zone_of(x)
        for k, (axis, plane) in enumerate(zip(self.axis, self.plane, strict=True)):
            inside = zone == k
            out[inside, axis] = 2.0 * plane - x[inside, axis]
        return out


def _zone(notch: Notch, l_f: float, l_c: float) -> tuple[FloatArray, FloatArray]:
    lower, upper = np.zeros(3), np.asarray(notch.size, float).copy()
    half = min(0.5 * notch.width + l_f + l_c, notch.position, notch.size[notch.normal] - notch.position)
    lower[notch.normal], upper[notch.normal] = notch.position - half, notch.position + half
    if notch.side == 0:
        upper[notch.axis] = min(upper[notch.axis], notch.root + REACH * l_f)
    else:
        lower[notch.axis] = max(0.0, notch.root - REACH * l_f)
    return lower, upper


def mirror_zones(box: Box, l_f: float, l_c: float) -> MirrorZones:
    """Zones of mirrored nuclei for the notches of a box.

    Their half-width is what the coarsest bodies beside the notch can see of it, ``width/2 + l_f + l_c``.

    Raises
    ------
    InputError
        Two notches so close that their zones overlap in different planes.
    """
    corners = [_zone(notch, l_f, l_c) for notch in box.notches]
    for k, (lower, upper) in enumerate(corners):
        for other in range(k):
            overlap = np.all((lower < corners[other][1]) & (corners[other][0] < upper))
            a, b = box.notches[k], box.notches[other]
            if overlap and (a.normal != b.normal or a.position != b.position):
                raise InputError(
                    f"notch[{k}].position",
                    f"is too close to notch[{other}]",
                    f"notches in one plane, or at least {2 * (l_f + l_c):g} m apart",
                )
    count = len(corners)
    return MirrorZones(
        np.array([c[0] for c in corners]).reshape(count, 3),
        np.array([c[1] for c in corners]).reshape(count, 3),
        np.array([notch.normal for notch in box.notches], dtype=np.int64),
        np.array([notch.position for notch in box.notches], dtype=float),
        np.array([max(0.5 * l_f, 0.5 * notch.width) for notch in box.notches], dtype=float),
    )
