"""Polygons of different numbers of corners, in contiguous arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import njit


@njit()
def _layout(offsets, more_offsets, chosen):  # type: ignore[no-untyped-def]
    count = len(offsets) - 1
    out = np.zeros(len(chosen) + 1, np.int64)
    for k in range(len(chosen)):
        q = chosen[k]
        if q < count:
            out[k + 1] = out[k] + offsets[q + 1] - offsets[q]
        else:
            out[k + 1] = out[k] + more_offsets[q - count + 1] - more_offsets[q - count]
    return out


@njit()
def _fill(points, offsets, more_points, more_offsets, chosen, out_offsets, out):  # type: ignore[no-untyped-def]
    count = len(offsets) - 1
    for k in range(len(chosen)):
        q, begin = chosen[k], out_offsets[k]
        first = offsets[q] if q < count else more_offsets[q - count]
        source = points if q < count else more_points
        for m in range(out_offsets[k + 1] - begin):
            for a in range(3):
                out[begin + m, a] = source[first + m, a]


@dataclass(frozen=True)
class Ragged:
    """Polygons one after another.

    Attributes
    ----------
    points : (p, 3) array
        Corners [m].
    offsets : (q + 1,) array
        First corner of each polygon.
    """

    points: FloatArray
    offsets: IntArray

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def take(self, chosen: IntArray) -> Ragged:
        """The chosen polygons, in that order."""
        return self.picked(self, chosen)

    def picked(self, other: Ragged, chosen: IntArray) -> Ragged:
        """The chosen ones of these polygons and others, counted on, in that order."""
        offsets = _layout(self.offsets, other.offsets, chosen)
        points = np.empty((offsets[-1], 3))  # numpy takes large pages for it, compiled code does not
        _fill(self.points, self.offsets, other.points, other.offsets, chosen, offsets, points)
        return Ragged(points, offsets)
