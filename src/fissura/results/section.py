"""Section of a structure by a plane of constant z: outlines of bodies, and the lines where their contacts cross it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.kernels import njit
from fissura.tessellation.tessellation import Polygons, Tessellation

FloatArray32 = NDArray[np.float32]
OUTSIDE, ON_LEDGE = -1, -2
"""What stands for a body where there is none; see `Section`."""

_POINT = 1e-9
"""Lines shorter than this part of the specimen are points."""


@dataclass(frozen=True)
class Section:
    """What a plane of constant z meets in one discretization.

    Attributes
    ----------
    nucleus : (b,) array
        Identities of the bodies that it cuts, ascending.
    fine : (b,) bool array
        Whether they are fine.
    lines : (s, 2, 2) float32 array
        Ends (x, y) of the lines in which it cuts facets [m]: contacts first, then facets on the surface.
    sides : (s, 2) int32 array
        The bodies on both sides of each, counted in this section; the second is -1 on the surface, and -2 on ledges at
        the tip of a notch.
    """

    nucleus: IntArray
    fine: BoolArray
    lines: FloatArray32
    sides: NDArray[np.int32]

    @property
    def skin(self) -> IntArray:
        """Lines on the surface of the specimen."""
        return np.flatnonzero(self.sides[:, 1] == OUTSIDE)

    @property
    def contacts(self) -> int:
        """Number of lines that belong to contacts; they come first."""
        return int(np.count_nonzero(self.sides[:, 1] >= 0))


@dataclass(frozen=True)
class Rows:
    """Where the entries of a section stand in the tessellation.

    Attributes
    ----------
    bodies : (b,) array
        Bodies.
    contacts : (c,) array
        Contacts of the first ``c`` lines.
    """

    bodies: IntArray
    contacts: IntArray


@dataclass(frozen=True)
class Outlines:
    """Closed outlines of the bodies of a section.

    Attributes
    ----------
    points : (p, 2) array
        Corners (x, y) [m], in order around each body.
    offsets : (b + 1,) array
        Corners of body ``k`` are ``points[offsets[k]:offsets[k + 1]]``.
    """

    points: FloatArray
    offsets: IntArray


def cut(tessellation: Tessellation, z: float) -> tuple[Section, Rows]:
    """Cut a tessellation by the plane of given z [m]."""
    contacts, surface = tessellation.contacts, tessellation.surface
    size = float(np.ptp(surface.polygons.points, axis=0).max())
    inner, contact = _lines(contacts.polygons, z, _POINT * size)
    outer, facet = _lines(surface.polygons, z, _POINT * size)
    sides = np.full((len(contact) + len(facet), 2), OUTSIDE)
    sides[: len(contact)], sides[len(contact) :, 0] = contacts.bodies[contact], surface.body[facet]
    bodies = np.unique(sides[sides >= 0])
    number = np.empty(len(tessellation), np.int64)
    number[bodies] = np.arange(len(bodies))
    sides = np.where(sides >= 0, number[sides], sides)
    sides[len(contact) :, 1][surface.ledges[facet]] = ON_LEDGE
    section = Section(
        nucleus=tessellation.nucleus[bodies],
        fine=tessellation.fine[bodies],
        lines=np.concatenate([inner, outer]).astype(np.float32),
        sides=sides.astype(np.int32),
    )
    return section, Rows(bodies, contact)


def _lines(polygons: Polygons, z: float, shortest: float) -> tuple[FloatArray, IntArray]:
    """Lines (k, 2, 2) in which the plane cuts convex polygons, and the facets of these polygons."""
    points, start = polygons.points, polygons.offsets[:-1]
    following = np.arange(1, len(points) + 1)
    following[polygons.offsets[1:] - 1] = start
    above = points[:, 2] >= z
    from_ = np.flatnonzero(above != above[following])
    to = following[from_]
    share = (z - points[from_, 2]) / (points[to, 2] - points[from_, 2])
    crossing = points[from_, :2] + share[:, None] * (points[to, :2] - points[from_, :2])
    polygon = np.searchsorted(polygons.offsets, from_, side="right") - 1
    # A convex polygon has two crossings or none; one that is not quite convex, by round-off, may have more.
    first = np.flatnonzero(np.append(True, polygon[1:] != polygon[:-1]) & np.append(polygon[1:] == polygon[:-1], False))
    lines = np.stack([crossing[first], crossing[first + 1]], axis=1)
    long = np.abs(lines[:, 1] - lines[:, 0]).max(axis=1, initial=0.0) > shortest
    return lines[long], polygons.facet[polygon[first[long]]]


def outlines(section: Section) -> Outlines:
    """Join the lines around each body of a section to its outline."""
    lines, sides = section.lines.astype(np.float64), section.sides
    inner = section.contacts
    line = np.concatenate([np.arange(len(lines)), np.arange(inner)])
    body = np.concatenate([sides[:, 0], sides[:inner, 1]])
    order = np.argsort(body, kind="stable")
    offsets = np.searchsorted(body[order], np.arange(len(section.nucleus) + 1))
    return Outlines(_chained(lines[line[order]], offsets), offsets)


@njit()
def _chained(lines, offsets):  # type: ignore[no-untyped-def]
    # Every line in turn goes on from the end of the one before, at the nearest end of those left: neighbouring facets
    # share corners up to round-off only, and tiny facets may be missing.
    out = np.empty((len(lines), 2))
    used = np.zeros(len(lines), np.bool_)
    for body in range(len(offsets) - 1):
        low, high = offsets[body], offsets[body + 1]
        if low == high:
            continue
        at, side, x, y = low, 0, 0.0, 0.0
        for k in range(low, high):
            if k > low:
                nearest = np.inf
                for candidate in range(low, high):
                    if used[candidate]:
                        continue
                    for s in range(2):
                        d = (lines[candidate, s, 0] - x) ** 2 + (lines[candidate, s, 1] - y) ** 2
                        if d < nearest:
                            nearest, at, side = d, candidate, s
            used[at] = True
            out[k, 0], out[k, 1] = lines[at, side, 0], lines[at, side, 1]
            x, y = lines[at, 1 - side, 0], lines[at, 1 - side, 1]
    return out
