"""Points sorted into the cells of a grid, for compiled searches."""

from typing import NamedTuple

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import njit


class Grid(NamedTuple):
    """Points sorted by grid cell, the last axis running fastest.

    Attributes
    ----------
    low : (3,) array
        Lower corner [m].
    side : float
        Side of the cells [m].
    shape : (3,) array
        Number of cells along each axis.
    start : (c + 1,) array
        First point of each cell.
    order : (n,) array
        Numbers of the points, by cell.
    x : (n, 3) array
        The points in that order [m].
    """

    low: FloatArray
    side: float
    shape: IntArray
    start: IntArray
    order: IntArray
    x: FloatArray


@njit()
def _sort(x, low, side, shape):  # type: ignore[no-untyped-def]
    n = len(x)
    cell = np.empty(n, np.int64)
    start = np.zeros(shape[0] * shape[1] * shape[2] + 1, np.int64)
    for i in range(n):
        c = 0
        for a in range(3):
            c = c * shape[a] + min(int((x[i, a] - low[a]) / side), shape[a] - 1)
        cell[i] = c
        start[c + 1] += 1
    for c in range(len(start) - 1):
        start[c + 1] += start[c]
    place = start[:-1].copy()
    order = np.empty(n, np.int64)
    sorted_x = np.empty((n, 3))
    for i in range(n):
        k = place[cell[i]]
        place[cell[i]] += 1
        order[k] = i
        for a in range(3):
            sorted_x[k, a] = x[i, a]
    return start, order, sorted_x


def grid_of(x: FloatArray, spacing: float) -> Grid:
    """Sort points into cells about as large as their spacing; but not much more cells than points, nor much fewer."""
    low, high = x.min(axis=0), x.max(axis=0)
    extent = high - low
    per_point = float(np.prod(np.maximum(extent, 1e-3 * (extent.max() or 1.0)))) / len(x)
    side = float(np.clip(spacing, (per_point / 8.0) ** (1 / 3), (2.0 * per_point) ** (1 / 3)))
    shape = (extent / side).astype(np.int64) + 1
    return Grid(low, side, shape, *_sort(x, low, side, shape))


@njit()
def within(x, reach2, grid):  # type: ignore[no-untyped-def]
    """Whether a point of the grid lies within each point's own (squared) reach, its rim included."""
    out = np.zeros(len(x), np.bool_)
    c = np.empty((3, 2), np.int64)
    for i in range(len(x)):
        reach = np.sqrt(reach2[i]) + 1e-9 * grid.side  # whatever round-off does at the rim of a cell
        empty = False
        for a in range(3):
            first, last = (x[i, a] - reach - grid.low[a]) / grid.side, (x[i, a] + reach - grid.low[a]) / grid.side
            c[a, 0], c[a, 1] = max(int(np.floor(first)), 0), min(int(np.floor(last)), grid.shape[a] - 1)
            empty |= c[a, 0] > c[a, 1]
        if empty:
            continue
        for c0 in range(c[0, 0], c[0, 1] + 1):
            for c1 in range(c[1, 0], c[1, 1] + 1):
                row = (c0 * grid.shape[1] + c1) * grid.shape[2]
                for m in range(grid.start[row + c[2, 0]], grid.start[row + c[2, 1] + 1]):
                    d2 = 0.0
                    for a in range(3):
                        d2 += (x[i, a] - grid.x[m, a]) ** 2
                    if d2 <= reach2[i]:
                        out[i] = True
    return out
