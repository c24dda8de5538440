"""Placement of nuclei in blocks: each a function of its own random numbers and of blocks that come before it.

Nuclei of coarser levels and of neighbours with lower colours are there already. First come random trials, fewer and
fewer beyond the faces of the block, then the block is saturated as a whole specimen is
(`fissura.tessellation.placement`): trials fall into active voxels, which are divided until none is left. What is near
the face between two blocks is left to the later one, else nuclei would crowd along it as along a wall.
"""

from typing import NamedTuple

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import INNER, njit
from fissura.specimen.complex import Complex
from fissura.tessellation.levels import Levels
from fissura.tessellation.limits import (
    ARRIVALS,
    CELLS,
    FADING,
    MOST_IN_BLOCK,
    MOST_LEVELS,
    RIM,
    TRIALS_PER_VOXEL,
    WIDTH,
)
from fissura.tessellation.placement import first_voxels
from fissura.tessellation.random import drawn, mixed
from fissura.tessellation.roots import Roots, holder, met
from fissura.tessellation.search import longer, taller
from fissura.tessellation.voxels import Placed, cell_of, divided, free, surroundings


class _Shape(NamedTuple):
    """Convex cells of the specimen; see `Complex`."""

    low: FloatArray
    high: FloatArray
    plane_start: IntArray
    normal: FloatArray
    offset: FloatArray


@njit(**INNER)
def _roots(lower, side, shape, cells):  # type: ignore[no-untyped-def]
    """Roots of a block, relative to its lower corner."""
    width = shape[0] * side
    near = np.empty(len(cells.low), np.int64)
    n, planes = 0, 0
    for k in range(len(cells.low)):
        apart = False
        for a in range(3):
            apart |= cells.low[k, a] >= lower[a] + width or cells.high[k, a] <= lower[a]
        if not apart:
            near[n] = k
            n += 1
            planes += cells.plane_start[k + 1] - cells.plane_start[k]
    low, high, start = np.empty((n, 3)), np.empty((n, 3)), np.zeros(n + 1, np.int64)
    normal, offset = np.empty((planes, 3)), np.empty(planes)
    f = 0
    for q in range(n):
        k = near[q]
        for p in range(cells.plane_start[k], cells.plane_start[k + 1]):
            offset[f] = cells.offset[p]
            for a in range(3):
                normal[f, a] = cells.normal[p, a]
                offset[f] -= cells.normal[p, a] * lower[a]
            f += 1
        start[q + 1] = f
        for a in range(3):
            low[q, a], high[q, a] = cells.low[k, a] - lower[a], cells.high[k, a] - lower[a]
    interior, begins, cell, begin, end, used = met(shape, side, low, high, start, normal, offset)
    for e in range(len(cell)):
        cell[e] = near[cell[e]]
    own_normal, own_offset = np.empty((len(used), 3)), np.empty(len(used))
    for f in range(len(used)):
        own_offset[f] = offset[used[f]]
        for a in range(3):
            own_normal[f, a] = normal[used[f], a]
    return Roots(interior, begins, cell, begin, end, own_normal, own_offset)


@njit(**INNER)
def _colour(i, j, k):  # type: ignore[no-untyped-def]
    return 4 * (i & 1) + 2 * (j & 1) + (k & 1)


@njit(**INNER)
def _own_voxels(here, size, shape, roots):  # type: ignore[no-untyped-def]
    """Roots that this block saturates, as voxels: along each axis, the later one of two neighbours has both rims."""
    active, root = first_voxels(shape, roots)
    count = 0
    for v in range(len(active)):
        own = True
        for a in range(3):
            begin, end = 2 * RIM, CELLS
            if here[a] & 1:
                begin, end = 0, CELLS + 2 * RIM
            if here[a] == 0:
                begin = RIM
            if here[a] + 1 == size[a]:
                end = CELLS + RIM
            own &= begin <= active[v, a] < end
        if own:
            for a in range(3):
                active[count, a] = active[v, a]
            root[count] = root[v]
            count += 1
    return active[:count].copy(), root[:count].copy()


@njit(**INNER)
def _gather(here, level, lower, side, known, table, x, grid, near):  # type: ignore[no-untyped-def]
    """Nuclei that come before a block and are near it, relative to its lower corner, into its grid; their number.

    Only those blocks are looked at on which this one depends, so that what else is known has no influence.
    """
    first, count, shape, base = table
    n = 0
    most = CELLS + 2 * RIM + 4
    low, high = here.copy(), here.copy()
    for m in range(level, len(shape)):
        if m > level:
            for a in range(3):
                low[a], high[a] = (low[a] - 1) >> 1, (high[a] + 1) >> 1
        around = 1 if m == level else 0
        for i in range(max(low[0] - around, 0), min(high[0] + around, shape[m, 0] - 1) + 1):
            for j in range(max(low[1] - around, 0), min(high[1] + around, shape[m, 1] - 1) + 1):
                for k in range(max(low[2] - around, 0), min(high[2] + around, shape[m, 2] - 1) + 1):
                    if m == level and _colour(i, j, k) >= _colour(here[0], here[1], here[2]):
                        continue
                    b = base[m] + (i * shape[m, 1] + j) * shape[m, 2] + k
                    for q in range(first[b], first[b] + count[b]):
                        c0 = int(np.floor((known[q, 0] - lower[0]) / side)) + 2
                        c1 = int(np.floor((known[q, 1] - lower[1]) / side)) + 2
                        c2 = int(np.floor((known[q, 2] - lower[2]) / side)) + 2
                        if 0 <= c0 < most and 0 <= c1 < most and 0 <= c2 < most:
                            for a in range(3):
                                x[n, a] = known[q, a] - lower[a]
                            c = (c0 * most + c1) * most + c2
                            grid[c] = n
                            near[n] = c
                            n += 1
    return n


@njit(**INNER)
def _put(p, k, n, placed, home):  # type: ignore[no-untyped-def]
    """Put nucleus `n` at a point in convex cell `k`."""
    x, grid, _, shape, cell, _ = placed
    for a in range(3):
        x[n, a] = p[a]
    home[n] = k
    grid[cell_of(p[0], p[1], p[2], shape, cell)] = n


@njit(**INNER)
def _scatter(roots, state, n, placed, home):  # type: ignore[no-untyped-def]
    """Add nuclei at random, fewer beyond the faces of the block, so that there is no wall; returns their number."""
    x, grid, steps, shape, cell, l2 = placed
    _, start, cells, begin, end, normal, offset = roots
    width = shape[0] * cell
    p = np.empty(3)
    for _ in range(int(ARRIVALS * (width / cell * WIDTH / CELLS) ** 3)):
        beyond = 0.0
        for a in range(3):
            p[a] = drawn(state) * width
            beyond += max(max(RIM * cell - p[a], p[a] - (width - RIM * cell)), 0.0)
        if drawn(state) > np.exp(-FADING * beyond / cell):
            continue
        r = (int(p[0] / cell) * shape[1] + int(p[1] / cell)) * shape[2] + int(p[2] / cell)
        if start[r + 1] > start[r] and free(p, x, grid, steps, shape, cell, l2):
            k = holder(p, r, start, cells, begin, end, normal, offset, 0.0)
            if k >= 0:
                _put(p, k, n, placed, home)
                n += 1
    return n


@njit(**INNER)
def _saturate(active, root, roots, state, n, placed, home):  # type: ignore[no-untyped-def]
    """Add nuclei to the `n` that are there until the block can take no more; returns their number."""
    x, grid, steps, shape, cell, l2 = placed
    active, root = divided(active, root, 1, cell, roots, placed)
    _, start, cells, begin, end, normal, offset = roots
    side, level, count = cell, 0, len(active)
    p = np.empty(3)
    while count > 0 and level <= MOST_LEVELS:
        for _ in range(int(TRIALS_PER_VOXEL * count) + 1):
            if count == 0:
                break
            v = int(drawn(state) * count)
            for a in range(3):
                p[a] = (active[v, a] + drawn(state)) * side
            if not free(p, x, grid, steps, shape, cell, l2):
                continue
            k = holder(p, root[v], start, cells, begin, end, normal, offset, 0.0)
            if k < 0:
                continue
            _put(p, k, n, placed, home)
            n += 1
            count -= 1
            root[v] = root[count]
            for a in range(3):
                active[v, a] = active[count, a]
        active, root = divided(active[:count], root[:count], 2, side, roots, placed)
        count = len(active)
        side /= 2
        level += 1
    return n


@njit()
def _filled(todo, l_f, origin, key, table, cells, steps, x, home, n):  # type: ignore[no-untyped-def]
    """Place nuclei in blocks, one after another."""
    first, count, shapes, base = table
    shape = np.full(3, CELLS + 2 * RIM, np.int64)
    most = (CELLS + 2 * RIM + 4) ** 3
    grid = np.full(most, -1, np.int32)
    own, own_home, near = np.empty((most, 3)), np.empty(most, np.int64), np.empty(most, np.int64)
    here, lower = np.empty(3, np.int64), np.empty(3)
    state = np.empty(1, np.uint64)
    for b in todo:
        level = len(shapes) - 1
        while level > 0 and b >= base[level - 1]:
            level -= 1
        index, size = b - base[level], shapes[level]
        here[0], here[1], here[2] = index // (size[1] * size[2]), index // size[2] % size[1], index % size[2]
        spacing = l_f * 2.0**level
        side = WIDTH * spacing / CELLS
        for a in range(3):
            lower[a] = origin[a] + (here[a] * CELLS - RIM) * side
        first[b], count[b] = n, 0
        roots = _roots(lower, side, shape, cells)
        active, root = _own_voxels(here, size, shape, roots)
        if len(active) == 0:
            continue
        state[0] = mixed(key ^ mixed(np.uint64(b)))
        before = _gather(here, level, lower, side, x, table, own, grid, near)
        placed = Placed(own, grid, steps, shape, side, spacing * spacing)
        after = _scatter(roots, state, before, placed, own_home)
        after = _saturate(active, root, roots, state, after, placed, own_home)
        while n + after - before > len(x):
            x, home = taller(x), longer(home)
        for q in range(before, after):
            for a in range(3):
                x[n, a] = own[q, a] + lower[a]
            home[n] = own_home[q]
            n += 1
            near[q] = cell_of(own[q, 0], own[q, 1], own[q, 2], shape, side)
        count[b] = after - before
        for q in range(after):
            grid[near[q]] = -1
    return x, home, n


def filled(
    todo: IntArray,
    levels: Levels,
    key: int,
    complex_: Complex,
    known: IntArray,
    x: FloatArray,
    home: IntArray,
    identity: IntArray,
) -> tuple[FloatArray, IntArray, IntArray]:
    """Place nuclei in further blocks.

    Parameters
    ----------
    todo : (q,) array
        Numbers of these blocks; each comes after all blocks on which it depends.
    levels : Levels
        The blocks of the specimen.
    key : int
        Of its random numbers, 64 bits.
    complex_ : Complex
        The specimen.
    known : (b,) array
        Numbers of the blocks that have their nuclei, ascending.
    x, home, identity : (n, 3), (n,), (n,) arrays
        These nuclei: positions [m], the convex cell that holds each of them, and identities, ascending.

    Returns
    -------
    x, home, identity : (n', 3), (n',), (n',) arrays
        All nuclei then.
    """
    first, count = np.zeros(levels.base[-1], np.int64), np.zeros(levels.base[-1], np.int64)
    first[known] = np.searchsorted(identity, known * MOST_IN_BLOCK)
    count[known] = np.searchsorted(identity, (known + 1) * MOST_IN_BLOCK) - first[known]
    cells = _Shape(complex_.low, complex_.high, complex_.plane_start, complex_.normal, complex_.offset)
    _, steps = surroundings(np.full(3, CELLS + 2 * RIM - 0.5), 1.0)
    n, table = len(x), (first, count, levels.shape, levels.base)
    x, home = (np.concatenate([old, np.empty_like(old, shape=(1024, *old.shape[1:]))]) for old in (x, home))
    x, home, total = _filled(todo, levels.l_f, levels.origin, np.uint64(key), table, cells, steps, x, home, n)
    number = np.arange(n, total) - np.repeat(first[todo], count[todo])
    identity = np.concatenate([identity, np.repeat(todo, count[todo]) * MOST_IN_BLOCK + number])
    order = np.argsort(identity, kind="stable")
    return x[order], home[order], identity[order]
