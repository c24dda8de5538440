"""Compiled positions of corners: the same, bit for bit, for all bodies that share them."""

import numpy as np

from fissura.kernels import INNER, njit
from fissura.tessellation.limits import SAME_CORNER


@njit(**INNER)
def corner_scratch():  # type: ignore[no-untyped-def]
    """Arrays for `place_corner`."""
    return np.empty((2, 4), np.int64), np.empty((5, 3))


@njit(**INNER)
def _meeting(i, v, first, x, table, plane_id, face, planes, whole, rows):  # type: ignore[no-untyped-def]
    """Where three planes meet, computed in an order of operations that their identities decide."""
    big = len(x)
    whole[0, 0] = i
    for m in range(3):
        behind = planes[face[4 * v + m]]
        row = first - 1 - behind
        number = behind if behind >= 0 else big + plane_id[row]
        q = m + 1
        while q > 0 and whole[0, q - 1] > number:
            whole[0, q], whole[1, q] = whole[0, q - 1], whole[1, q - 1]
            q -= 1
        whole[0, q], whole[1, q] = number, row
    o = whole[0, 0]
    for m in range(3):
        j = whole[0, m + 1]
        if j < big:
            d2 = 0.0
            for a in range(3):
                rows[m, a] = x[j, a] - x[o, a]
                d2 += rows[m, a] ** 2
            rows[3, m] = 0.5 * d2
        else:
            f = whole[1, m + 1]
            d = table[f, 3]
            for a in range(3):
                rows[m, a] = table[f, a]
                d -= table[f, a] * x[o, a]
            rows[3, m] = d
    a0, a1, a2 = rows[0, 0], rows[0, 1], rows[0, 2]
    b0, b1, b2 = rows[1, 0], rows[1, 1], rows[1, 2]
    c0, c1, c2 = rows[2, 0], rows[2, 1], rows[2, 2]
    d0, d1, d2 = rows[3, 0], rows[3, 1], rows[3, 2]
    u0, u1, u2 = b1 * c2 - b2 * c1, b2 * c0 - b0 * c2, b0 * c1 - b1 * c0
    v0, v1, v2 = c1 * a2 - c2 * a1, c2 * a0 - c0 * a2, c0 * a1 - c1 * a0
    w0, w1, w2 = a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0
    determinant = a0 * u0 + a1 * u1 + a2 * u2
    if determinant == 0.0:
        return False
    rows[4, 0] = (d0 * u0 + d1 * v0 + d2 * w0) / determinant + x[o, 0]
    rows[4, 1] = (d0 * u1 + d1 * v1 + d2 * w1) / determinant + x[o, 1]
    rows[4, 2] = (d0 * u2 + d1 * v2 + d2 * w2) / determinant + x[o, 2]
    return True


@njit(**INNER)
def place_corner(  # type: ignore[no-untyped-def]
    i, v, k, first, x, table, bounds, plane_id, p, face, planes, radius, whole, rows, corner
):
    """Place corner `v` of a piece in convex cell `k`: computed from its planes where that is well conditioned.

    Coordinates on planes of the cell that are normal to an axis are exact. The cell's planes begin with `first`;
    `table` holds normals and offsets of planes (P, 4), `bounds` those of cells (K, 6), since few arrays are passed
    faster than many; `whole` and `rows` are those of `corner_scratch`.
    """
    for a in range(3):
        corner[v, a] = x[i, a] + p[a, v]
    if _meeting(i, v, first, x, table, plane_id, face, planes, whole, rows):
        off = max(abs(rows[4, 0] - corner[v, 0]), abs(rows[4, 1] - corner[v, 1]), abs(rows[4, 2] - corner[v, 2]))
        if off <= SAME_CORNER * radius:
            for a in range(3):
                corner[v, a] = rows[4, a]
    for a in range(3):
        corner[v, a] = min(max(corner[v, a], bounds[k, a]), bounds[k, 3 + a])
    for m in range(3):
        behind = planes[face[4 * v + m]]
        if behind < 0:
            f = first - 1 - behind
            for a in range(3):
                if abs(table[f, a]) == 1.0:
                    corner[v, a] = table[f, 3] * table[f, a]
