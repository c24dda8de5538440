"""Voxels of a complex: which convex cells each of them meets, and which planes cut it.

The roots are voxels of one size that fill the bounds of the complex. Finer voxels, their parts, keep the number of
their root, and with it the few planes that matter there.
"""

from typing import NamedTuple

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.kernels import INNER, njit
from fissura.specimen.complex import Complex
from fissura.specimen.polyhedron import TOO_SHORT, UNCUT, box, cut, following
from fissura.tessellation.limits import FULL, IN_BOX
from fissura.tessellation.piece import work_arrays
from fissura.tessellation.search import longer


class Roots(NamedTuple):
    """Root voxels, the last axis running fastest.

    Attributes
    ----------
    interior : (r,) bool array
        Whether all of a root lies in the complex.
    start : (r + 1,) array
        Where the convex cells that each root meets begin.
    cell : (e,) array
        These cells.
    begin, end : (e,) array
        Where the planes of each of them that cut the root begin and end.
    normal, offset : (p, 3), (p,) array
        These planes, relative to the lower corner of the first root [m].
    """

    interior: BoolArray
    start: IntArray
    cell: IntArray
    begin: IntArray
    end: IntArray
    normal: FloatArray
    offset: FloatArray


@njit(inline="always")
def extremes(low, high, normal, f):  # type: ignore[no-untyped-def]
    """Least and largest coordinate of a box along a normal."""
    least, most = 0.0, 0.0
    for a in range(3):
        u, w = normal[f, a] * low[a], normal[f, a] * high[a]
        least += min(u, w)
        most += max(u, w)
    return least, most


@njit(**INNER)
def _ranges(low, high, side, shape):  # type: ignore[no-untyped-def]
    """Roots that a box may meet, along each axis."""
    out = np.empty((3, 2), np.int64)
    for a in range(3):
        out[a, 0] = max(int(low[a] / side) - 1, 0)
        out[a, 1] = min(int(high[a] / side) + 1, shape[a] - 1)
    return out


@njit(**INNER)
def part_of(low, high, crossing, n_crossing, normal, offset, work):  # type: ignore[no-untyped-def]
    """Clip a box by planes, into the first of the work arrays; returns its corners, -1 for more than there is room."""
    p, r2, s, twin, face, edges, gone, new = work
    count = box(low, high, p, r2, twin, face)
    tolerance = IN_BOX * (high[0] - low[0] + high[1] - low[1] + high[2] - low[2])
    for q in range(n_crossing):
        f = crossing[q]
        n0, n1, n2 = normal[f, 0], normal[f, 1], normal[f, 2]
        left = cut(p, r2, s, twin, face, count, n0, n1, n2, offset[f], tolerance, 6, edges, gone, new)
        if left == TOO_SHORT:
            return -1
        if left != UNCUT:
            count = left
        if count == 0:
            return 0
    return count


@njit(**INNER)
def _volume(count, p, twin, done):  # type: ignore[no-untyped-def]
    """Volume of a polyhedron: of all tetrahedra from its first corner to fans of its facets."""
    total = 0.0
    for edge in range(4 * count):
        done[edge] = False
    for first in range(4 * count):
        if first & 3 == 3 or done[first]:
            continue
        done[first] = True
        o, b = first >> 2, following(first, twin)
        while b != first:
            done[b] = True
            u, b = b >> 2, following(b, twin)
            w = b >> 2
            a0, a1, a2 = p[0, o] - p[0, 0], p[1, o] - p[1, 0], p[2, o] - p[2, 0]
            b0, b1, b2 = p[0, u] - p[0, 0], p[1, u] - p[1, 0], p[2, u] - p[2, 0]
            c0, c1, c2 = p[0, w] - p[0, 0], p[1, w] - p[1, 0], p[2, w] - p[2, 0]
            total += a0 * (b1 * c2 - b2 * c1) + a1 * (b2 * c0 - b0 * c2) + a2 * (b0 * c1 - b1 * c0)
    return total / 6.0


@njit(**INNER)
def _crossing(low, high, first, last, normal, offset, crossing):  # type: ignore[no-untyped-def]
    """List the planes of a convex cell that cut a box; -1 where one of them keeps the two apart."""
    n = 0
    for f in range(first, last):
        least, most = extremes(low, high, normal, f)
        if least >= offset[f]:
            return -1
        if most > offset[f]:
            crossing[n] = f
            n += 1
    return n


@njit()
def met(shape, side, low, high, plane_start, normal, offset):  # type: ignore[no-untyped-def]
    """Roots with the cells that they meet, and with the planes of these."""
    total = shape[0] * shape[1] * shape[2]
    filled, start = np.zeros(total), np.zeros(total + 1, np.int64)
    root, cell, first = np.empty(total, np.int64), np.empty(total, np.int64), np.empty(total + 1, np.int64)
    planes = np.empty(total, np.int64)
    most = 0
    for k in range(len(low)):
        most = max(most, plane_start[k + 1] - plane_start[k])
    crossing, work, done = np.empty(most, np.int64), work_arrays(8 + 4 * most), np.empty(4 * (8 + 4 * most), np.bool_)
    n, n_planes = 0, 0
    lower, upper = np.empty(3), np.empty(3)
    for k in range(len(low)):
        c = _ranges(low[k], high[k], side, shape)
        for c0 in range(c[0, 0], c[0, 1] + 1):
            for c1 in range(c[1, 0], c[1, 1] + 1):
                for c2 in range(c[2, 0], c[2, 1] + 1):
                    lower[0], lower[1], lower[2] = c0 * side, c1 * side, c2 * side
                    for a in range(3):
                        upper[a] = lower[a] + side
                    cuts = _crossing(lower, upper, plane_start[k], plane_start[k + 1], normal, offset, crossing)
                    if cuts < 0:
                        continue
                    r = (c0 * shape[1] + c1) * shape[2] + c2
                    volume = side**3
                    if cuts > 0:
                        # Several planes may keep a box and a cell apart although none of them alone does.
                        count = part_of(lower, upper, crossing, cuts, normal, offset, work)
                        if count == 0:
                            continue
                        volume = _volume(count, work[0], work[3], done) if count > 0 else 0.0
                    filled[r] += volume
                    if n == len(root):
                        root, cell, first = longer(root), longer(cell), longer(first)
                    while n_planes + cuts > len(planes):
                        planes = longer(planes)
                    root[n], cell[n], first[n] = r, k, n_planes
                    start[r + 1] += 1
                    for q in range(cuts):
                        planes[n_planes] = crossing[q]
                        n_planes += 1
                    n += 1
    for r in range(total):
        start[r + 1] += start[r]
    place = start[:-1].copy()
    of_root, begin, end = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n, np.int64)
    first[n] = n_planes
    for e in range(n):
        q = place[root[e]]
        place[root[e]] += 1
        of_root[q], begin[q], end[q] = cell[e], first[e], first[e + 1]
    return filled >= (1.0 - FULL) * side**3, start, of_root, begin, end, planes[:n_planes]


def roots_of(complex_: Complex, origin: FloatArray, shape: IntArray, side: float) -> Roots:
    """Roots of a complex.

    Parameters
    ----------
    complex_ : Complex
        The convex cells.
    origin : (3,) array
        Lower corner of the first root [m].
    shape : (3,) array
        Number of roots along each axis.
    side : float
        Their side [m].
    """
    c = complex_
    offset = c.offset - c.normal[:, 0] * origin[0] - c.normal[:, 1] * origin[1] - c.normal[:, 2] * origin[2]
    bounds = (c.low - origin, c.high - origin)
    interior, start, cell, begin, end, planes = met(shape, side, *bounds, c.plane_start, c.normal, offset)
    return Roots(interior, start, cell, begin, end, c.normal[planes], offset[planes])


def free_roots(count: int) -> Roots:
    """Roots that no face cuts."""
    none = np.empty(0, np.int64)  # nobody asks for the cell of a root inside
    return Roots(np.ones(count, np.bool_), np.arange(count + 1), none, none, none, np.empty((0, 3)), np.empty(0))


@njit(**INNER)
def holder(p, root, start, cell, begin, end, normal, offset, least):  # type: ignore[no-untyped-def]
    """The convex cell in which a point of a root lies deepest, -1 where that is less than a least depth."""
    out = -1
    for e in range(start[root], start[root + 1]):
        deep = np.inf
        for f in range(begin[e], end[e]):
            deep = min(deep, offset[f] - normal[f, 0] * p[0] - normal[f, 1] * p[1] - normal[f, 2] * p[2])
        if deep > least or (deep == least and out < 0):
            least, out = deep, cell[e]
    return out
