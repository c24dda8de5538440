"""Selection of nuclei for a refined region (theory section 5): one specimen at every resolution."""

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.kernels import INNER, njit
from fissura.tessellation.nuclei import Nuclei


@njit(**INNER)
def _free(p, l2, x, grid, head, following):  # type: ignore[no-untyped-def]
    """Whether no kept nucleus is closer to a point than a distance no larger than the side of this grid's cells."""
    low, side, shape, first, level = grid
    c0, c1, c2 = int((p[0] - low[0]) / side), int((p[1] - low[1]) / side), int((p[2] - low[2]) / side)
    for i in range(max(c0 - 1, 0), min(c0 + 2, shape[0])):
        for j in range(max(c1 - 1, 0), min(c1 + 2, shape[1])):
            for k in range(max(c2 - 1, 0), min(c2 + 2, shape[2])):
                q = head[first + (i * shape[1] + j) * shape[2] + k]
                while q >= 0:
                    d0, d1, d2 = p[0] - x[q, 0], p[1] - x[q, 1], p[2] - x[q, 2]
                    if d0 * d0 + d1 * d1 + d2 * d2 < l2:
                        return False
                    q = following[level, q]
    return True


@njit()
def _select(x, order, spacing, side):  # type: ignore[no-untyped-def]
    n = len(x)
    kept = np.zeros(n, np.bool_)
    low = np.empty(3)
    size = np.empty(3)
    widest, largest = 0.0, 0.0
    for a in range(3):
        low[a], high = x[0, a], x[0, a]
        for q in range(n):
            low[a], high = min(low[a], x[q, a]), max(high, x[q, a])
        size[a] = high - low[a]
        largest = max(largest, size[a])
    for q in range(n):
        widest = max(widest, spacing[q])
    # Grids of kept nuclei, each twice as coarse as the one before; a search takes the first one with cells at least
    # as large as the spacing.
    levels = 1
    while side * 2.0 ** (levels - 1) < min(widest, largest):
        levels += 1
    shape = np.empty((levels, 3), np.int64)
    first = np.zeros(levels + 1, np.int64)
    for m in range(levels):
        for a in range(3):
            shape[m, a] = int(size[a] / (side * 2.0**m)) + 1
        first[m + 1] = first[m] + shape[m, 0] * shape[m, 1] * shape[m, 2]
    head = np.full(first[levels], -1, np.int32)
    following = np.full((levels, n), -1, np.int32)
    # First the refined region, then the others by priority.
    for refined in (True, False):
        for q in range(n):
            i = order[q]
            if kept[i] or (spacing[i] <= 0.0) != refined:
                continue
            if not refined:
                reach = spacing[i]
                m = 0
                while m < levels - 1 and side * 2.0**m < reach:
                    m += 1
                grid = (low, side * 2.0**m, shape[m], first[m], m)
                if not _free(x[i], reach * reach, x, grid, head, following):
                    continue
            kept[i] = True
            for m in range(levels):
                width = side * 2.0**m
                step = 0
                for a in range(3):
                    step = step * shape[m, a] + int((x[i, a] - low[a]) / width)
                following[m, i] = head[first[m] + step]
                head[first[m] + step] = i
    return kept


def select(nuclei: Nuclei, spacing: FloatArray) -> tuple[IntArray, BoolArray]:
    """Select the nuclei of a discretization.

    All nuclei with zero spacing (the refined region) are kept; then, by priority, each one that has no kept
    nucleus closer than its own spacing. The result is a pure function of the arguments, so it does not depend on the
    order in which a region grew; nor on nuclei that are too fine for the spacing wanted where they are.

    Parameters
    ----------
    nuclei : Nuclei
        All fine nuclei that may be used with this spacing.
    spacing : (n,) array
        Wanted spacing at every nucleus [m], 0 inside the refined region.

    Returns
    -------
    kept : (k,) array
        Indices of the selected nuclei, ascending.
    fine : (k,) bool array
        Which of them lie in the refined region.
    """
    used = nuclei.used(spacing)
    order = np.argsort(nuclei.priority[used], kind="stable")
    kept = used[_select(nuclei.x[used], order, spacing[used], 2.0 * nuclei.spacing)]
    return kept, spacing[kept] <= 0.0
