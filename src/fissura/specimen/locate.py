"""Which convex cell holds a point."""

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import compiled_when_large, njit
from fissura.specimen.complex import Complex


@compiled_when_large(lambda *given: len(given[0]), 300)
@njit()
def _boxes(low, high, origin, side, shape):  # type: ignore[no-untyped-def]
    """Cells that reach into each box of a grid, box after box."""
    start = np.zeros(shape[0] * shape[1] * shape[2] + 1, np.int64)
    cells = np.empty(0, np.int64)
    for step in range(2):
        for k in range(len(low)):
            first, last = np.empty(3, np.int64), np.empty(3, np.int64)
            for a in range(3):
                first[a] = min(max(int((low[k, a] - origin[a]) / side[a]), 0), shape[a] - 1)
                last[a] = min(max(int((high[k, a] - origin[a]) / side[a]), 0), shape[a] - 1)
            for i in range(first[0], last[0] + 1):
                for j in range(first[1], last[1] + 1):
                    for m in range(first[2], last[2] + 1):
                        box = (i * shape[1] + j) * shape[2] + m
                        if step == 0:
                            start[box + 1] += 1
                        else:
                            cells[start[box]] = k
                            start[box] += 1
        if step == 0:
            for box in range(len(start) - 1):
                start[box + 1] += start[box]
            cells = np.empty(start[-1], np.int64)
    for box in range(len(start) - 1, 0, -1):
        start[box] = start[box - 1]
    start[0] = 0
    return start, cells


@compiled_when_large(lambda *given: len(given[0]), 1000)
@njit()
def _located(x, low, high, plane_start, normal, offset, origin, side, shape, start, cells):  # type: ignore[no-untyped-def]
    """The convex cell in which each point lies deepest, -1 for those outside of all."""
    out = np.full(len(x), -1, np.int64)
    for i in range(len(x)):
        box, outside = 0, False
        for a in range(3):
            at = (x[i, a] - origin[a]) / side[a]
            outside |= not -1.0 <= at <= shape[a] + 1.0
            box = box * shape[a] + (0 if outside else min(max(int(at), 0), shape[a] - 1))
        if outside:
            continue
        most = -1.0
        for q in range(start[box], start[box + 1]):
            k = cells[q]
            for a in range(3):
                if x[i, a] < low[k, a] or x[i, a] > high[k, a]:
                    break
            else:
                deep = np.inf
                for f in range(plane_start[k], plane_start[k + 1]):
                    h = offset[f] - normal[f, 0] * x[i, 0] - normal[f, 1] * x[i, 1] - normal[f, 2] * x[i, 2]
                    deep = min(deep, h)
                    if deep < 0.0:
                        break
                if deep >= 0.0 and deep > most:
                    most = deep
                    out[i] = k
    return out


class Locator:
    """Finds convex cells in a grid of boxes.

    Parameters
    ----------
    complex_ : Complex
        The cells.
    """

    def __init__(self, complex_: Complex) -> None:
        self._complex = c = complex_
        size = c.high.max(axis=0) - c.low.min(axis=0)
        self._origin = c.low.min(axis=0)
        self._shape = np.clip(np.round(size / np.cbrt(size.prod() / len(c.low))), 1, 100).astype(np.int64)
        self._side = size / self._shape
        self._start, self._cells = _boxes(c.low, c.high, self._origin, self._side, self._shape)

    def __call__(self, x: FloatArray) -> IntArray:
        """The cell that holds each point, -1 for points outside of all; shape (n, 3) -> (n,)."""
        c = self._complex
        points = np.ascontiguousarray(x, dtype=float).reshape(-1, 3)
        grid = (self._origin, self._side, self._shape, self._start, self._cells)
        out: IntArray = _located(points, c.low, c.high, c.plane_start, c.normal, c.offset, *grid)
        return out
