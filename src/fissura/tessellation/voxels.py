"""Compiled tests of points and voxels against the nuclei placed so far.

Nuclei are sorted into a grid whose cells hold one at most. The grid has two more cells on every side, so that the
125 cells around any point of the specimen can be looked up without regard to its ends, nearest first.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import INNER, njit
from fissura.tessellation.piece import work_arrays
from fissura.tessellation.roots import extremes, part_of
from fissura.tessellation.search import longer, taller


class Placed(NamedTuple):
    """Nuclei placed so far.

    Attributes
    ----------
    x : (c, 3) array
        Nuclei [m], and room for more.
    grid : (g,) array
        Number of the nucleus in each cell of the grid, -1 for none.
    steps : (125,) array
        Steps from a cell to those around it, nearest first.
    shape : (3,) array
        Number of cells along each axis, without the margin.
    cell : float
        Side of the cells [m].
    spacing2 : float
        Squared spacing [m^2].
    """

    x: FloatArray
    grid: NDArray[np.int32]
    steps: IntArray
    shape: IntArray
    cell: float
    spacing2: float


def surroundings(size: FloatArray, cell: float) -> tuple[IntArray, IntArray]:
    """Number of cells along each axis, and the steps from a cell to the 125 around it, nearest first."""
    shape = (size / cell).astype(np.int64) + 1
    away = np.stack(np.meshgrid(*[np.arange(-2, 3)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    away = away[np.argsort((away**2).sum(axis=1), kind="stable")]
    return shape, (away[:, 0] * (shape[1] + 4) + away[:, 1]) * (shape[2] + 4) + away[:, 2]


@njit(inline="always")
def cell_of(p0, p1, p2, shape, cell):  # type: ignore[no-untyped-def]
    """Number of the grid cell of a point."""
    return ((int(p0 / cell) + 2) * (shape[1] + 4) + int(p1 / cell) + 2) * (shape[2] + 4) + int(p2 / cell) + 2


@njit(**INNER)
def free(p, x, grid, steps, shape, cell, l2):  # type: ignore[no-untyped-def]
    """Whether no nucleus is closer to `p` than a distance, given squared, of at most the spacing."""
    here = cell_of(p[0], p[1], p[2], shape, cell)
    for step in steps:
        q = grid[here + step]
        if q >= 0:
            d0, d1, d2 = p[0] - x[q, 0], p[1] - x[q, 1], p[2] - x[q, 2]
            if d0 * d0 + d1 * d1 + d2 * d2 < l2:
                return False
    return True


@njit(**INNER)
def _near(m0, m1, m2, x, grid, steps, shape, cell, l2, near):  # type: ignore[no-untyped-def]
    """List the nuclei that cover a point, or do but for round-off; at most 125."""
    here = cell_of(m0, m1, m2, shape, cell)
    n = 0
    for step in steps:
        q = grid[here + step]
        if q >= 0:
            d0, d1, d2 = m0 - x[q, 0], m1 - x[q, 1], m2 - x[q, 2]
            if d0 * d0 + d1 * d1 + d2 * d2 < l2 * (1.0 + 1e-9):
                near[n] = q
                n += 1
    return n


@njit(**INNER)
def _covered(low, high, x, near, n, l2):  # type: ignore[no-untyped-def]
    """Whether one of these nuclei covers all corners of a box."""
    m0, m1, m2 = 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])
    h0, h1, h2 = 0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]), 0.5 * (high[2] - low[2])
    for k in range(n):
        q = near[k]
        d0, d1, d2 = abs(m0 - x[q, 0]) + h0, abs(m1 - x[q, 1]) + h1, abs(m2 - x[q, 2]) + h2
        if d0 * d0 + d1 * d1 + d2 * d2 < l2:
            return True
    return False


@njit(**INNER)
def _within_axes(low, high, e, roots, bounds, crossing):  # type: ignore[no-untyped-def]
    """The part of a voxel between those planes of a cell that are normal to an axis, in the first two of the bounds.

    Lists the other planes that cut the voxel and returns their number, -1 where it lies outside of the cell.
    """
    n = 0
    for a in range(3):
        bounds[0, a], bounds[1, a] = low[a], high[a]
    for f in range(roots.begin[e], roots.end[e]):
        least, most = extremes(low, high, roots.normal, f)
        if least >= roots.offset[f]:
            return -1
        if most <= roots.offset[f]:
            continue
        across = -1
        for a in range(3):
            if abs(roots.normal[f, a]) == 1.0:
                across = a
        if across < 0:
            crossing[n] = f
            n += 1
        elif roots.normal[f, across] > 0.0:
            bounds[1, across] = min(bounds[1, across], roots.offset[f])
        else:
            bounds[0, across] = max(bounds[0, across], -roots.offset[f])
    return n


@njit(**INNER)
def _box_corners(low, high, corner, n):  # type: ignore[no-untyped-def]
    for v in range(8):
        for a in range(3):
            corner[n + v, a] = high[a] if (v >> a) & 1 else low[a]
    return n + 8


@njit(**INNER)
def _parts(low, high, root, roots, corner, scratch):  # type: ignore[no-untyped-def]
    """Corners of the parts of a voxel in all convex cells; returns their number, -1 for more than there is room.

    Where it has one part, which is a box, that becomes the voxel and has no corners; where it has none, -2 is returned.
    """
    bounds, crossing, work = scratch
    n, boxes = 0, 0
    for e in range(roots.start[root], roots.start[root + 1]):
        n_crossing = _within_axes(low, high, e, roots, bounds, crossing)
        if n_crossing < 0:
            continue
        if n + 16 > len(corner):
            return -1
        if n_crossing == 0:
            boxes += 1
            if boxes == 1:
                for a in range(3):
                    bounds[2, a], bounds[3, a] = bounds[0, a], bounds[1, a]
            else:
                n = _box_corners(bounds[0], bounds[1], corner, n)
            continue
        count = part_of(bounds[0], bounds[1], crossing, n_crossing, roots.normal, roots.offset, work)
        if count < 0 or n + count + 8 > len(corner):
            return -1
        for v in range(count):
            for a in range(3):
                corner[n + v, a] = work[0][a, v]
        n += count
    if boxes == 0:
        return n if n > 0 else -2
    if n > 0:
        return _box_corners(bounds[2], bounds[3], corner, n)
    for a in range(3):
        low[a], high[a] = bounds[2, a], bounds[3, a]
    return 0


@njit(**INNER)
def _needed(low, high, root, roots, placed, near, corner, scratch):  # type: ignore[no-untyped-def]
    """Whether a nucleus may fit into a voxel that faces cut: no other one covers all of its parts."""
    x, grid, steps, shape, cell, l2 = placed
    n = _parts(low, high, root, roots, corner, scratch)
    if n < 0:
        return n == -1
    m0, m1, m2 = 0.0, 0.0, 0.0
    if n == 0:
        m0, m1, m2 = 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])
    for v in range(n):
        m0, m1, m2 = m0 + corner[v, 0] / n, m1 + corner[v, 1] / n, m2 + corner[v, 2] / n
    count = _near(m0, m1, m2, x, grid, steps, shape, cell, l2, near)
    if n == 0:
        return not _covered(low, high, x, near, count, l2)
    for k in range(count):
        q, inside = near[k], True
        for v in range(n):
            d0, d1, d2 = corner[v, 0] - x[q, 0], corner[v, 1] - x[q, 1], corner[v, 2] - x[q, 2]
            if not d0 * d0 + d1 * d1 + d2 * d2 < l2:
                inside = False
                break
        if inside:
            return False
    return True


@njit(**INNER)
def _inside(low, high, root, roots):  # type: ignore[no-untyped-def]
    """Whether all of a voxel lies in one convex cell."""
    for e in range(roots.start[root], roots.start[root + 1]):
        inside = True
        for f in range(roots.begin[e], roots.end[e]):
            _, most = extremes(low, high, roots.normal, f)
            if most > roots.offset[f]:
                inside = False
                break
        if inside:
            return True
    return False


@njit(**INNER)
def _limits(root, start, begin, end, normal, offset, limits):  # type: ignore[no-untyped-def]
    """Whether only planes normal to an axis cut a root, of one cell; what they leave, in the rows of `limits`."""
    if start[root + 1] != start[root] + 1:
        return False
    for a in range(3):
        limits[0, a], limits[1, a] = -np.inf, np.inf
    e = start[root]
    for f in range(begin[e], end[e]):
        across = -1
        for a in range(3):
            if abs(normal[f, a]) == 1.0:
                across = a
        if across < 0:
            return False
        if normal[f, across] > 0.0:
            limits[1, across] = min(limits[1, across], offset[f])
        else:
            limits[0, across] = max(limits[0, across], -offset[f])
    return True


@njit(**INNER)
def divided(active, root, parts, side, roots, placed):  # type: ignore[no-untyped-def]
    """Divide voxels and keep those into which another nucleus may fit; voxels (v, 3) and their roots (v,)."""
    x, grid, steps, shape, cell, l2 = placed
    interior, start, _, begin, end, normal, offset = roots
    limits = np.empty((2, 3))
    out, out_root = np.empty((2 * len(active) + 8, 3), np.int32), np.empty(2 * len(active) + 8, np.int32)
    kept = 0
    new_side = side / parts
    low, high, near = np.empty(3), np.empty(3), np.empty(125, np.int64)
    most = 0
    for e in range(len(roots.cell)):
        most = max(most, roots.end[e] - roots.begin[e])
    scratch = (np.empty((4, 3)), np.empty(most, np.int64), work_arrays(8 + 4 * most))
    corner = np.empty((2048, 3))
    for v in range(len(active)):
        if kept + 8 > len(out):
            out, out_root = taller(out), longer(out_root)
        for a in range(3):
            low[a] = active[v, a] * side
            high[a] = low[a] + side
        whole, square = interior[root[v]], False
        if not whole:
            square = _limits(root[v], start, begin, end, normal, offset, limits)
            if square:
                whole = True
                for a in range(3):
                    whole &= limits[0, a] <= low[a] and high[a] <= limits[1, a]
                square = not whole
            else:
                whole = _inside(low, high, root[v], roots)
        # The centre is a corner of all eight parts, so what covers one of them covers the centre.
        n = 0
        if whole:
            m0, m1, m2 = 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])
            n = _near(m0, m1, m2, x, grid, steps, shape, cell, l2, near)
        for part in range(parts**3):
            for a in range(3):
                out[kept, a] = parts * active[v, a] + ((part >> (2 - a)) & 1)
                low[a] = out[kept, a] * new_side
                high[a] = low[a] + new_side
            needed = True
            if square:
                for a in range(3):
                    low[a], high[a] = max(low[a], limits[0, a]), min(high[a], limits[1, a])
                    needed &= low[a] < high[a]
                m0, m1, m2 = 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])
                n = _near(m0, m1, m2, x, grid, steps, shape, cell, l2, near) if needed else 0
            if whole or square:
                needed = needed and not _covered(low, high, x, near, n, l2)
            else:
                needed = _needed(low, high, root[v], roots, placed, near, corner, scratch)
            if needed:
                out_root[kept] = root[v]
                kept += 1
    return out[:kept].copy(), out_root[:kept].copy()
