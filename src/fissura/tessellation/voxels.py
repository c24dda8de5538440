"""Compiled tests of points and voxels against the nuclei placed so far.

Nuclei are sorted into a grid whose cells hold one at most. The grid has two more cells on every side, so that the
125 cells around any point of the specimen can be looked up without regard to its ends, nearest first.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fissura.kernels import njit

__all__ = ["cell_of", "divided", "free", "surroundings"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def surroundings(size: FloatArray, cell: float) -> tuple[IntArray, IntArray]:
    """Number of cells along each axis, and the steps from a cell to the 125 around it, nearest first."""
    shape = (size / cell).astype(np.int64) + 1
    away = np.stack(np.meshgrid(*[np.arange(-2, 3)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    away = away[np.argsort((away**2).sum(axis=1), kind="stable")]
    return shape, (away[:, 0] * (shape[1] + 4) + away[:, 1]) * (shape[2] + 4) + away[:, 2]


@njit(cache=True, inline="always")
def cell_of(p0, p1, p2, shape, cell):  # type: ignore[no-untyped-def]
    """Number of the grid cell of a point."""
    return ((int(p0 / cell) + 2) * (shape[1] + 4) + int(p1 / cell) + 2) * (shape[2] + 4) + int(p2 / cell) + 2


@njit(cache=True)
def free(p, x, grid, steps, shape, cell, l2):  # type: ignore[no-untyped-def]
    """Whether no accepted nucleus is closer to `p` than the spacing."""
    here = cell_of(p[0], p[1], p[2], shape, cell)
    for step in steps:
        q = grid[here + step]
        if q >= 0:
            d0, d1, d2 = p[0] - x[q, 0], p[1] - x[q, 1], p[2] - x[q, 2]
            if d0 * d0 + d1 * d1 + d2 * d2 < l2:
                return False
    return True


@njit(cache=True)
def _near(low, high, x, grid, steps, shape, cell, l2, near):  # type: ignore[no-untyped-def]
    """List the nuclei that may cover a part of a box with its centre in it; at most 125."""
    m0, m1, m2 = 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])
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


@njit(cache=True)
def _covered_by(low, high, x, near, n, l2):  # type: ignore[no-untyped-def]
    """Whether one of these nuclei covers all corners of a box."""
    m0, m1, m2 = 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])
    h0, h1, h2 = 0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]), 0.5 * (high[2] - low[2])
    for k in range(n):
        q = near[k]
        d0, d1, d2 = abs(m0 - x[q, 0]) + h0, abs(m1 - x[q, 1]) + h1, abs(m2 - x[q, 2]) + h2
        if d0 * d0 + d1 * d1 + d2 * d2 < l2:
            return True
    return False


@njit(cache=True)
def _covered(low, high, x, grid, steps, shape, cell, l2, near):  # type: ignore[no-untyped-def]
    """Whether one accepted nucleus covers all corners of a box no larger than a grid cell."""
    return _covered_by(low, high, x, near, _near(low, high, x, grid, steps, shape, cell, l2, near), l2)


@njit(cache=True)
def _in_void(low, high, void_lower, void_upper):  # type: ignore[no-untyped-def]
    """Whether a box lies wholly in a saw cut."""
    for v in range(len(void_lower)):
        inside = True
        for a in range(3):
            if low[a] < void_lower[v, a] or high[a] > void_upper[v, a]:
                inside = False
        if inside:
            return True
    return False


@njit(cache=True)
def _mirror_covered(low, high, zones, x, grid, steps, shape, cell, l2, near):  # type: ignore[no-untyped-def]
    """Whether no nucleus fits into a box because it, or its mirror image, is covered; part by part at a zone's rim."""
    zl, zu, za, zp, zc = zones
    for z in range(len(za)):
        # The part of the box inside the zone, and what is left of the box when one face of the zone cuts it.
        part_low, part_high = np.empty(3), np.empty(3)
        rest_low, rest_high = low.copy(), high.copy()
        cuts = 0
        empty = False
        for a in range(3):
            part_low[a], part_high[a] = max(low[a], zl[z, a]), min(high[a], zu[z, a])
            if part_low[a] >= part_high[a]:
                empty = True
            if low[a] < zl[z, a]:
                cuts += 1
                rest_high[a] = zl[z, a]
            if high[a] > zu[z, a]:
                cuts += 1
                rest_low[a] = zu[z, a]
        if empty:
            continue
        if cuts > 1 or (cuts == 1 and not _covered(rest_low, rest_high, x, grid, steps, shape, cell, l2, near)):
            return False
        # Pairs keep clear of the plane.
        a = za[z]
        below, above = zp[z] - zc, zp[z] + zc
        if part_low[a] >= below and part_high[a] <= above:
            return True
        if part_low[a] >= below:
            part_low[a] = max(part_low[a], above)
        elif part_high[a] <= above:
            part_high[a] = min(part_high[a], below)
        if _covered(part_low, part_high, x, grid, steps, shape, cell, l2, near):
            return True
        lower = part_low[a]
        part_low[a] = 2.0 * zp[z] - part_high[a]
        part_high[a] = 2.0 * zp[z] - lower
        return _covered(part_low, part_high, x, grid, steps, shape, cell, l2, near)
    return False


@njit(cache=True)
def _meets(low, high, lower, upper, margin):  # type: ignore[no-untyped-def]
    for z in range(len(lower)):
        apart = False
        for a in range(3):
            apart |= low[a] > upper[z, a] + margin or high[a] < lower[z, a] - margin
        if not apart:
            return True
    return False


@njit(cache=True)
def divided(  # type: ignore[no-untyped-def]
    active, parts, side, size, zones, void_lower, void_upper, x, grid, steps, shape, cell, l2
):
    """Divide voxels and keep those into which another nucleus may fit."""
    out = np.empty((2 * len(active) + 8, 3), np.int64)
    kept = 0
    new_side = side / parts
    low, high, near, mirror = np.empty(3), np.empty(3), np.empty(125, np.int64), np.empty(125, np.int64)
    for v in range(len(active)):
        if kept + 8 > len(out):
            longer = np.empty((2 * len(out), 3), np.int64)
            for k in range(kept):
                for a in range(3):
                    longer[k, a] = out[k, a]
            out = longer
        for a in range(3):
            low[a] = active[v, a] * side
            high[a] = low[a] + side
        # The centre is a corner of all eight parts, so what covers one of them covers the centre; parts at the end of
        # the specimen are smaller.
        alone = parts == 1 or high[0] > size[0] or high[1] > size[1] or high[2] > size[2]
        n = _near(low, high, x, grid, steps, shape, cell, l2, near)
        in_zone = _meets(low, high, zones[0], zones[1], 1e-6 * side)
        for part in range(parts**3):
            inside = True
            for a in range(3):
                bit = (part >> (2 - a)) & 1
                out[kept, a] = parts * active[v, a] + bit
                low[a] = out[kept, a] * new_side
                high[a] = min(low[a] + new_side, size[a])
                inside &= low[a] < size[a]
            if not inside or _in_void(low, high, void_lower, void_upper):
                continue
            if alone:
                n = _near(low, high, x, grid, steps, shape, cell, l2, near)
            if _covered_by(low, high, x, near, n, l2):
                continue
            if in_zone and _mirror_covered(low, high, zones, x, grid, steps, shape, cell, l2, mirror):
                continue
            kept += 1
    return out[:kept].copy()
