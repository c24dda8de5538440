"""Selection of nuclei for a refined region (theory section 5): one specimen at every resolution."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fissura.tessellation.nuclei import Nuclei

__all__ = ["select"]


@njit(cache=True)
def _select(x, order, twin, spacing, side):  # type: ignore[no-untyped-def]
    n = len(x)
    kept = np.zeros(n, np.bool_)
    low = np.empty(3)
    shape = np.empty(3, np.int64)
    for a in range(3):
        low[a] = x[:, a].min()
        shape[a] = int((x[:, a].max() - low[a]) / side) + 1
    head = np.full(shape[0] * shape[1] * shape[2], -1, np.int64)
    following = np.full(n, -1, np.int64)
    cell = np.empty((n, 3), np.int64)
    for i in range(n):
        for a in range(3):
            cell[i, a] = int((x[i, a] - low[a]) / side)
    # First the refined region, then the others by priority.
    for refined in (True, False):
        for i in order:
            j = twin[i]
            if kept[i] or (spacing[i] <= 0.0) != refined:
                continue
            free = True
            if not refined:
                for member in (i, j):
                    if member < 0 or not free:
                        continue
                    l2 = spacing[member] ** 2
                    reach = int(spacing[member] / side) + 1
                    for c0 in range(max(cell[member, 0] - reach, 0), min(cell[member, 0] + reach + 1, shape[0])):
                        for c1 in range(max(cell[member, 1] - reach, 0), min(cell[member, 1] + reach + 1, shape[1])):
                            for c2 in range(
                                max(cell[member, 2] - reach, 0), min(cell[member, 2] + reach + 1, shape[2])
                            ):
                                k = head[(c0 * shape[1] + c1) * shape[2] + c2]
                                while k >= 0 and free:
                                    d2 = 0.0
                                    for a in range(3):
                                        d2 += (x[member, a] - x[k, a]) ** 2
                                    if d2 < l2:
                                        free = False
                                    k = following[k]
            if free:
                for member in (i, j):
                    if member >= 0 and not kept[member]:
                        kept[member] = True
                        c = (cell[member, 0] * shape[1] + cell[member, 1]) * shape[2] + cell[member, 2]
                        following[member] = head[c]
                        head[c] = member
    return kept


def select(nuclei: Nuclei, spacing: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Select the nuclei of a discretization.

    All nuclei with zero spacing (the refined region) are kept; then, by priority, each one that has no kept
    nucleus closer than its own spacing. Mirrored twins are kept or left together. The result is a pure function
    of the arguments, so it does not depend on the order in which a region grew.

    Parameters
    ----------
    nuclei : Nuclei
        All fine nuclei.
    spacing : (n,) array
        Wanted spacing at every nucleus [m], 0 inside the refined region. Beside notches it is limited by
        ``nuclei.widest``.

    Returns
    -------
    kept : (k,) array
        Identities of the selected nuclei, ascending.
    fine : (k,) bool array
        Which of them lie in the refined region.
    """
    spacing = np.where(spacing > 0.0, np.minimum(spacing, np.maximum(nuclei.widest, nuclei.spacing)), 0.0)
    paired = nuclei.twin >= 0
    spacing[paired] = np.minimum(spacing[paired], spacing[nuclei.twin[paired]])
    order = np.argsort(nuclei.priority, kind="stable")
    side = 2.0 * nuclei.spacing
    kept = np.flatnonzero(_select(nuclei.x, order, nuclei.twin, spacing, side))
    return kept, spacing[kept] <= 0.0
