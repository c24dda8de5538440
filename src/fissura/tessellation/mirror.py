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

#: How far beside the notch nuclei are mirrored, in fine spacings. It bounds the size of coarse bodies there, see
#: `MirrorZones.widest`; beyond that its value does not matter.
BESIDE = 6.0


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
    clearance : float
        Smallest distance of a nucleus from the plane, half the fine spacing [m].
    """

    lower: FloatArray
    upper: FloatArray
    axis: NDArray[np.int64]
    plane: FloatArray
    clearance: float

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

    def widest(self, x: FloatArray) -> FloatArray:
        """Largest spacing at points [m] with which bodies see mirrored nuclei only across the plane; (n, 3) -> (n,).

        A point of the plane then has a selected nucleus inside the zone, and the same one on the other side.
        """
        out = np.full(len(x), np.inf)
        zone = self.zone_of(x)
        for k, axis in enumerate(self.axis):
            half = 0.5 * (self.upper[k, axis] - self.lower[k, axis])
            out[zone == k] = max(half - 2.0 * REACH * self.clearance, 0.0)
        return out


def _zone(notch: Notch, l_f: float) -> tuple[FloatArray, FloatArray]:
    lower, upper = np.zeros(3), np.asarray(notch.size, float).copy()
    half = min(0.5 * notch.width + BESIDE * l_f, notch.position, notch.size[notch.normal] - notch.position)
    lower[notch.normal], upper[notch.normal] = notch.position - half, notch.position + half
    if notch.side == 0:
        upper[notch.axis] = min(upper[notch.axis], notch.root + REACH * l_f)
    else:
        lower[notch.axis] = max(0.0, notch.root - REACH * l_f)
    return lower, upper


def mirror_zones(box: Box, l_f: float) -> MirrorZones:
    """Zones of mirrored nuclei for the notches of a box.

    Zones of one plane that meet, as of notches cut from opposite faces, become one.

    Parameters
    ----------
    box : Box
        The specimen.
    l_f : float
        Fine spacing [m].

    Raises
    ------
    InputError
        Two notches so close that their zones overlap in different planes.
    """
    zones: list[tuple[FloatArray, FloatArray, int]] = []  # corners, and the number of a notch inside
    for k, notch in enumerate(box.notches):
        lower, upper = _zone(notch, l_f)
        apart: list[tuple[FloatArray, FloatArray, int]] = []
        for low, high, other in zones:
            near = box.notches[other]
            if np.any(lower > high + l_f) or np.any(low > upper + l_f):
                apart.append((low, high, other))
            elif (near.normal, near.position) == (notch.normal, notch.position):
                lower, upper = np.minimum(lower, low), np.maximum(upper, high)
            else:
                raise InputError(
                    f"notch[{k}].position",
                    f"{notch.position:g} m is too close to notch[{other}]",
                    f"notches in one plane, or at least {(2.0 * BESIDE + 1.0) * l_f:g} m apart beside their widths",
                )
        zones = [*apart, (lower, upper, k)]
    count = len(zones)
    return MirrorZones(
        np.array([zone[0] for zone in zones]).reshape(count, 3),
        np.array([zone[1] for zone in zones]).reshape(count, 3),
        np.array([box.notches[zone[2]].normal for zone in zones], dtype=np.int64),
        np.array([box.notches[zone[2]].position for zone in zones], dtype=float),
        0.5 * l_f,
    )
