"""Straight lines in which a plane across an axis meets the surface."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray
from fissura.specimen.limits import ROUND_OFF
from fissura.specimen.surface_part import SurfacePart


@dataclass(frozen=True, eq=False)
class Trace:
    """A straight line on one or more parts of a surface.

    Attributes
    ----------
    start, end : (3,) array
        Its ends [m].
    parts : tuple of SurfacePart
        What it runs over, in that order.
    ends : (k,) array
        Distance from the start at which each of them ends [m].
    """

    start: FloatArray
    end: FloatArray
    parts: tuple[SurfacePart, ...]
    ends: FloatArray

    @property
    def length(self) -> float:
        """Its length [m]."""
        return float(np.linalg.norm(self.end - self.start))


def traces_at(parts: Sequence[SurfacePart], axis: int, coordinate: float, tolerance: float) -> list[Trace]:
    """Lines in which the plane at a coordinate meets parts of a surface.

    Of parts that meet in the plane one counts.

    Parameters
    ----------
    parts : sequence of SurfacePart
        Parts of the surface.
    axis : int
        Number of the axis across the plane.
    coordinate : float
        Its place along the axis [m].
    tolerance : float
        Length that is round-off [m].
    """
    found = _segments(parts, axis, coordinate, tolerance, above=True)
    if not found:
        found = _segments(parts, axis, coordinate, tolerance, above=False)
    out: list[Trace] = []
    while found:
        a, b, part = found.pop(0)
        chain = [(a, b, part)]
        grown = True
        while grown:
            grown = False
            for k, (c, d, other) in enumerate(found):
                if not _straight(chain[0], (c, d), part, other):
                    continue
                for p, q in ((c, d), (d, c)):
                    if np.abs(p - chain[-1][1]).max() <= tolerance:
                        chain.append((p, q, other))
                        grown = True
                    elif np.abs(q - chain[0][0]).max() <= tolerance:
                        chain.insert(0, (p, q, other))
                        grown = True
                    if grown:
                        break
                if grown:
                    del found[k]
                    break
        if tuple(chain[0][0]) > tuple(chain[-1][1]):
            chain = [(q, p, other) for p, q, other in reversed(chain)]
        start, end = chain[0][0], chain[-1][1]
        ends = np.cumsum([np.linalg.norm(q - p) for p, q, _ in chain])
        out.append(Trace(start, end, tuple(other for *_, other in chain), ends))
    return out


def _straight(
    first: tuple[FloatArray, FloatArray, SurfacePart],
    second: tuple[FloatArray, FloatArray],
    part: SurfacePart,
    other: SurfacePart,
) -> bool:
    """Whether two lines have one direction, on flat ground."""
    u, v = first[1] - first[0], second[1] - second[0]
    flat = np.abs(part.normal - other.normal).max() <= ROUND_OFF
    return bool(flat and np.linalg.norm(np.cross(u, v)) <= 1e-6 * np.linalg.norm(u) * np.linalg.norm(v))


def _segments(
    parts: Sequence[SurfacePart], axis: int, coordinate: float, tolerance: float, *, above: bool
) -> list[tuple[FloatArray, FloatArray, SurfacePart]]:
    """One line for each part that the plane meets; a part that only touches it counts if it lies above, or below."""
    out = []
    for part in parts:
        h = part.polygon[:, axis] - coordinate
        h[np.abs(h) <= 1e-3 * tolerance] = 0.0
        side = h > 0.0 if above else h >= 0.0
        crossing = np.flatnonzero(side != np.roll(side, -1))
        if len(crossing) != 2:
            continue
        after, h_after = np.roll(part.polygon, -1, axis=0), np.roll(h, -1)
        share = (h[crossing] / (h[crossing] - h_after[crossing]))[:, None]
        a, b = part.polygon[crossing] + share * (after[crossing] - part.polygon[crossing])
        if np.abs(b - a).max() > tolerance:
            a[axis] = b[axis] = coordinate
            out.append((a, b, part))
    return out
