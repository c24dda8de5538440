"""Compiled search for the nuclei around a nucleus, nearest first."""

import numpy as np

from fissura.kernels import INNER, njit


@njit(**INNER)
def longer(array):  # type: ignore[no-untyped-def]
    """A copy with room for twice as much."""
    out = np.empty(2 * len(array), array.dtype)
    for k in range(len(array)):
        out[k] = array[k]
    return out


@njit(**INNER)
def taller(array):  # type: ignore[no-untyped-def]
    """A copy with room for twice as many rows of three."""
    out = np.empty((2 * len(array), 3), array.dtype)
    for k in range(len(array)):
        for a in range(3):
            out[k, a] = array[k, a]
    return out


@njit(**INNER)
def _sorted(first, last, d2, number):  # type: ignore[no-untyped-def]
    """Sort by distance, then number (Shell 1959; there are some dozens)."""
    for gap in (3937, 1750, 701, 301, 132, 57, 23, 10, 4, 1):
        for m in range(first + gap, last):
            d, k = d2[m], number[m]
            q = m
            while q >= first + gap and (d2[q - gap] > d or (d2[q - gap] == d and number[q - gap] > k)):
                d2[q], number[q] = d2[q - gap], number[q - gap]
                q -= gap
            d2[q], number[q] = d, k


@njit(**INNER)
def _gather(i, x, grid, inner2, outer2, n, d2, number):  # type: ignore[no-untyped-def]
    """Append the nuclei farther than one radius and at most another from nucleus `i`; -1 when there are too many."""
    low, side, shape, start, order, sorted_x = grid
    outer = np.sqrt(outer2) + 1e-9 * side  # whatever round-off does at the rim of a cell
    c = np.empty((3, 2), np.int64)
    for a in range(3):
        c[a, 0] = max(int((x[i, a] - outer - low[a]) / side), 0)
        c[a, 1] = min(int((x[i, a] + outer - low[a]) / side), shape[a] - 1)
    x0, x1, x2 = x[i, 0], x[i, 1], x[i, 2]
    for c0 in range(c[0, 0], c[0, 1] + 1):
        e0 = low[0] + c0 * side - x0
        e0 = max(e0, -e0 - side, 0.0)
        for c1 in range(c[1, 0], c[1, 1] + 1):
            e1 = low[1] + c1 * side - x1
            e1 = max(e1, -e1 - side, 0.0)
            if (e0 * e0 + e1 * e1) * (1.0 - 1e-9) > outer2:
                continue
            row = (c0 * shape[1] + c1) * shape[2]
            for m in range(start[row + c[2, 0]], start[row + c[2, 1] + 1]):
                d0, d1, d = sorted_x[m, 0] - x0, sorted_x[m, 1] - x1, sorted_x[m, 2] - x2
                d = d0 * d0 + d1 * d1 + d * d
                if inner2 < d <= outer2:
                    if order[m] == i:
                        continue
                    if n == len(d2):
                        return -1
                    d2[n], number[n] = d, order[m]
                    n += 1
    return n


@njit(**INNER)
def found_within(i, x, grid, inner2, outer2, n, d2, number):  # type: ignore[no-untyped-def]
    """Add the nuclei between two radii around nucleus `i` to the `n` nearer ones known so far.

    Returns their number, and the squared distances and numbers, which may have been given more room.
    """
    while True:
        more = _gather(i, x, grid, inner2, outer2, n, d2, number)
        if more >= 0:
            break
        d2, number = longer(d2), longer(number)
    _sorted(n, more, d2, number)
    return more, d2, number
