"""Polygons of different numbers of corners, in contiguous arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fissura.kernels import njit

__all__ = ["Ragged"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@njit(cache=True)
def _layout(offsets, owner, more_offsets, more_owner, chosen):  # type: ignore[no-untyped-def]
    count = len(owner)
    out_offsets, out_owner = np.zeros(len(chosen) + 1, np.int64), np.empty(len(chosen), np.int64)
    for k in range(len(chosen)):
        q = chosen[k]
        if q < count:
            out_owner[k] = owner[q]
            out_offsets[k + 1] = out_offsets[k] + offsets[q + 1] - offsets[q]
        else:
            out_owner[k] = more_owner[q - count]
            out_offsets[k + 1] = out_offsets[k] + more_offsets[q - count + 1] - more_offsets[q - count]
    return out_offsets, out_owner


@njit(cache=True)
def _fill(points, offsets, more_points, more_offsets, chosen, out_offsets, out):  # type: ignore[no-untyped-def]
    count = len(offsets) - 1
    for k in range(len(chosen)):
        q, begin = chosen[k], out_offsets[k]
        first = offsets[q] if q < count else more_offsets[q - count]
        source = points if q < count else more_points
        for m in range(out_offsets[k + 1] - begin):
            for a in range(3):
                out[begin + m, a] = source[first + m, a]


@njit(cache=True)
def _extremes(points, offsets, axis):  # type: ignore[no-untyped-def]
    low, high = np.full(len(offsets) - 1, np.inf), np.full(len(offsets) - 1, -np.inf)
    for k in range(len(low)):
        for m in range(offsets[k], offsets[k + 1]):
            low[k], high[k] = min(low[k], points[m, axis]), max(high[k], points[m, axis])
    return low, high


@dataclass(frozen=True)
class Ragged:
    """Polygons with an owner each: the working form of facets while notches cut them.

    Attributes
    ----------
    points : (p, 3) array
        Corners [m].
    offsets : (q + 1,) array
        First corner of each polygon.
    owner : (q,) array
        Facet to which each polygon belongs.
    """

    points: FloatArray
    offsets: IntArray
    owner: IntArray

    def __len__(self) -> int:
        return len(self.owner)

    def take(self, chosen: IntArray) -> Ragged:
        """The chosen polygons, in that order."""
        counts = np.diff(self.offsets)[chosen]
        offsets = np.concatenate([[0], np.cumsum(counts)])
        points = np.empty((offsets[-1], 3))  # numpy takes large pages for it, compiled code does not
        _fill(self.points, self.offsets, self.points, self.offsets, chosen, offsets, points)
        return Ragged(points, offsets, self.owner[chosen])

    def picked(self, other: Ragged, chosen: IntArray) -> Ragged:
        """The chosen ones of these polygons and others, counted on, in that order."""
        offsets, owner = _layout(self.offsets, self.owner, other.offsets, other.owner, chosen)
        points = np.empty((offsets[-1], 3))
        _fill(self.points, self.offsets, other.points, other.offsets, chosen, offsets, points)
        return Ragged(points, offsets, owner)

    def joined(self, *others: Ragged) -> Ragged:
        """These polygons and others, sorted by owner; empty ones are dropped."""
        parts = (self, *others)
        whole = Ragged(
            np.concatenate([part.points for part in parts]),
            np.concatenate([[0], np.cumsum(np.concatenate([np.diff(part.offsets) for part in parts]))]),
            np.concatenate([part.owner for part in parts]),
        )
        order = np.argsort(whole.owner, kind="stable")
        return whole.take(order[np.diff(whole.offsets)[order] > 0])

    def extremes(self, axis: int) -> tuple[FloatArray, FloatArray]:
        """Smallest and largest coordinate of each polygon along an axis [m]."""
        low, high = _extremes(self.points, self.offsets, axis)
        return low, high
