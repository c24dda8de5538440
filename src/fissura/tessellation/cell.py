"""Compiled kernel that clips Voronoi cells, one after another, each a function of its own surroundings only.

A cell begins as the box. The bisector planes of the other nuclei cut it, nearest first and lower numbers first at
equal distance, until the next nucleus is more than twice as far as the cell's farthest corner. Nuclei beyond
leave no trace in the result, not even in its last bit.
"""

from __future__ import annotations

import numpy as np

from fissura.kernels import njit
from fissura.tessellation.polyhedron import TOO_SHORT, UNCUT, box, cut, farthest, following

__all__ = ["clip_cells"]

_GROWTH = 2.0  # of the squared radius within which further nuclei are sought
_PLANE = 1e-13  # of the cell's radius: planes that reach less into it do not cut
_ROUND_OFF = 1e-15  # of the coordinates: the same
_SAME = 1e-7  # of the cell's radius: a corner computed again from its four nuclei may lie this far off


@njit(cache=True)
def _sorted(n, d2, number):  # type: ignore[no-untyped-def]
    """Sort by distance, then number (Shell 1959; there are some dozens)."""
    for gap in (3937, 1750, 701, 301, 132, 57, 23, 10, 4, 1):
        for m in range(gap, n):
            d, k = d2[m], number[m]
            q = m
            while q >= gap and (d2[q - gap] > d or (d2[q - gap] == d and number[q - gap] > k)):
                d2[q], number[q] = d2[q - gap], number[q - gap]
                q -= gap
            d2[q], number[q] = d, k


@njit(cache=True)
def _gather(i, x, grid, inner2, outer2, d2, number):  # type: ignore[no-untyped-def]
    """Collect nuclei farther than one radius and at most another from nucleus `i`; -1 when there are too many."""
    low, side, shape, start, order, sorted_x = grid
    outer = np.sqrt(outer2) + 1e-9 * side  # whatever round-off does at the rim of a cell
    c = np.empty((3, 2), np.int64)
    for a in range(3):
        c[a, 0] = max(int((x[i, a] - outer - low[a]) / side), 0)
        c[a, 1] = min(int((x[i, a] + outer - low[a]) / side), shape[a] - 1)
    x0, x1, x2 = x[i, 0], x[i, 1], x[i, 2]
    n = 0
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
                    if n == len(d2):
                        return -1
                    d2[n], number[n] = d, order[m]
                    n += 1
    return n


@njit(cache=True)
def _corner(i, planes, x, size, ids, rows, right, out):  # type: ignore[no-untyped-def]
    """A corner from its four nuclei (or faces of the box), in the same order of operations for all cells there."""
    # Sort nuclei by number; faces of the box come last.
    ids[0] = i
    for m in range(3):
        k = planes[m] if planes[m] >= 0 else len(x) + 6 + planes[m]
        q = m + 1
        while q > 0 and ids[q - 1] > k:
            ids[q] = ids[q - 1]
            q -= 1
        ids[q] = k
    o = ids[0]
    for m in range(3):
        k = ids[m + 1]
        if k < len(x):
            d2 = 0.0
            for a in range(3):
                rows[m, a] = x[k, a] - x[o, a]
                d2 += rows[m, a] ** 2
            right[m] = 0.5 * d2
        else:
            face = k - len(x)
            a = face >> 1
            rows[m, 0] = rows[m, 1] = rows[m, 2] = 0.0
            rows[m, a] = 1.0
            right[m] = (size[a] if face & 1 else 0.0) - x[o, a]
    a0, a1, a2 = rows[0, 0], rows[0, 1], rows[0, 2]
    b0, b1, b2 = rows[1, 0], rows[1, 1], rows[1, 2]
    c0, c1, c2 = rows[2, 0], rows[2, 1], rows[2, 2]
    u0, u1, u2 = b1 * c2 - b2 * c1, b2 * c0 - b0 * c2, b0 * c1 - b1 * c0
    v0, v1, v2 = c1 * a2 - c2 * a1, c2 * a0 - c0 * a2, c0 * a1 - c1 * a0
    w0, w1, w2 = a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0
    determinant = a0 * u0 + a1 * u1 + a2 * u2
    if determinant == 0.0:
        return False
    out[0] = (right[0] * u0 + right[1] * v0 + right[2] * w0) / determinant + x[o, 0]
    out[1] = (right[0] * u1 + right[1] * v1 + right[2] * w1) / determinant + x[o, 1]
    out[2] = (right[0] * u2 + right[1] * v2 + right[2] * w2) / determinant + x[o, 2]
    return True


@njit(cache=True)
def _longer(array):  # type: ignore[no-untyped-def]
    out = np.empty(2 * len(array), array.dtype)
    for k in range(len(array)):
        out[k] = array[k]
    return out


@njit(cache=True)
def _wider(array):  # type: ignore[no-untyped-def]
    out = np.empty((3, 2 * array.shape[1]))
    for a in range(3):
        for k in range(array.shape[1]):
            out[a, k] = array[a, k]
    return out


@njit(cache=True)
def _higher(array):  # type: ignore[no-untyped-def]
    out = np.empty((2 * len(array), 3))
    for k in range(len(array)):
        for a in range(3):
            out[k, a] = array[k, a]
    return out


@njit(cache=True)
def _clip(i, x, size, first2, grid, work, planes, d2, number):  # type: ignore[no-untyped-def]
    """Clip one cell; returns its corners, planes, squared radius and reach, and the arrays that had to grow."""
    p, r2, s, twin, face, edges, gone, new = work
    origin = x[i]
    extent = max(size[0], size[1], size[2])
    count = box(-origin, size - origin, p, r2, twin, face)
    for f in range(6):
        planes[f] = f - 6
    n_planes = 6
    limit2 = 4.0 * farthest(r2, count)
    inner2, outer2, last2 = -1.0, min(first2, limit2), 0.0
    finished = False
    while not finished:
        n = _gather(i, x, grid, inner2, outer2, d2, number)
        if n < 0:
            d2, number = _longer(d2), _longer(number)
            continue
        _sorted(n, d2, number)
        m = 0
        while m < n and d2[m] <= limit2:
            j = number[m]
            if j == i:
                m += 1
                continue
            if d2[m] == 0.0:
                raise ValueError("two nuclei coincide")
            tolerance = np.sqrt(d2[m]) * (0.5 * _PLANE * np.sqrt(limit2) + _ROUND_OFF * extent)
            n0, n1, n2 = x[j, 0] - origin[0], x[j, 1] - origin[1], x[j, 2] - origin[2]
            left = cut(p, r2, s, twin, face, count, n0, n1, n2, 0.5 * d2[m], tolerance, n_planes, edges, gone, new)
            if left == TOO_SHORT:
                p, new = _wider(p), _wider(new)
                r2, s = _longer(r2), _longer(s)
                twin, face, edges, gone = _longer(twin), _longer(face), _longer(edges), _longer(gone)
                continue
            last2 = d2[m]
            m += 1
            if left == UNCUT:
                continue
            count = left
            if n_planes == len(planes):
                planes = _longer(planes)
            planes[n_planes] = j
            n_planes += 1
            limit2 = 4.0 * farthest(r2, count)
        finished = m < n or outer2 >= limit2
        inner2, outer2 = outer2, min(limit2, _GROWTH * outer2)
    work = (p, r2, s, twin, face, edges, gone, new)
    return count, n_planes, limit2, max(limit2, last2), work, planes, d2, number


@njit(cache=True)
def _place(i, v, x, size, p, face, planes, radius, scratch, corner):  # type: ignore[no-untyped-def]
    """Position of corner `v`: computed from its nuclei where that is well conditioned, exactly on faces of the box."""
    behind, ids, rows, right, place = scratch
    for k in range(3):
        behind[k] = planes[face[4 * v + k]]
    for a in range(3):
        corner[v, a] = x[i, a] + p[a, v]
    if _corner(i, behind, x, size, ids, rows, right, place):
        off = max(abs(place[0] - corner[v, 0]), abs(place[1] - corner[v, 1]), abs(place[2] - corner[v, 2]))
        if off <= _SAME * radius:
            for a in range(3):
                corner[v, a] = place[a]
    for a in range(3):
        corner[v, a] = min(max(corner[v, a], 0.0), size[a])
    for k in range(3):
        if behind[k] < 0:
            a = (behind[k] + 6) >> 1
            corner[v, a] = size[a] if behind[k] & 1 else 0.0


@njit(cache=True)
def clip_cells(todo, x, size, guess, grid, points):  # type: ignore[no-untyped-def]
    """Clip the cells of the nuclei `todo`.

    Other parameters are all nuclei `x`, the box's `size`, a `guess` of each nucleus' distance to its neighbours, the
    nuclei sorted into a `grid`, and `points` (p, 3), a place for corners. Returns for every cell the squared radius
    within which nuclei matter and its number of facets; then for every facet its other nucleus, or the face of the box
    less 6, its number of corners, and these. A facet between two nuclei is given in the cell of the lower number only.
    """
    room = 64
    work = (
        np.empty((3, room)), np.empty(room), np.empty(room), np.empty(4 * room, np.int64), np.empty(4 * room, np.int64),
        np.empty(4 * room, np.int64), np.empty(4 * room, np.int64), np.empty((3, room)),
    )  # fmt: skip
    scratch = (np.empty(3, np.int64), np.empty(4, np.int64), np.empty((3, 3)), np.empty(3), np.empty(3))
    corner, known = np.empty((room, 3)), np.empty(room, np.bool_)
    d2, number, planes = np.empty(256), np.empty(256, np.int64), np.empty(64, np.int64)
    wanted, at = np.empty(64, np.int64), np.empty(64, np.int64)
    reach2, facets = np.empty(len(todo)), np.zeros(len(todo), np.int64)
    other, corners = np.empty(10 * len(todo) + 64, np.int64), np.empty(10 * len(todo) + 64, np.int64)
    n_facets, n_points, before2 = 0, 0, np.inf
    for cell in range(len(todo)):
        i = todo[cell]
        first2 = min(before2, max(2.0 * guess[i], grid.side) ** 2)
        count, n_planes, limit2, before2, work, planes, d2, number = _clip(
            i, x, size, first2, grid, work, planes, d2, number
        )
        reach2[cell] = before2
        p, face, twin = work[0], work[4], work[3]
        if count > len(known):
            corner, known = np.empty((len(work[1]), 3)), np.empty(len(work[1]), np.bool_)
        if n_planes > len(at):
            wanted, at = np.empty(len(planes), np.int64), np.empty(len(planes), np.int64)
        for f in range(n_planes):
            at[f] = -1
        for v in range(count):
            known[v] = False
            for k in range(3):
                at[face[4 * v + k]] = 4 * v + k
        n = 0
        for f in range(n_planes):
            if at[f] >= 0 and (planes[f] > i or planes[f] < 0):
                q = n
                while q > 0 and planes[wanted[q - 1]] > planes[f]:
                    wanted[q] = wanted[q - 1]
                    q -= 1
                wanted[q] = f
                n += 1
        facets[cell] = n
        if n_facets + n > len(other):
            other, corners = _longer(other), _longer(corners)
        for q in range(n):
            first = at[wanted[q]]
            edge, size_before = first, n_points
            while True:
                v = edge >> 2
                if not known[v]:
                    _place(i, v, x, size, p, face, planes, 0.5 * np.sqrt(limit2), scratch, corner)
                    known[v] = True
                if n_points == len(points):
                    points = _higher(points)
                for a in range(3):
                    points[n_points, a] = corner[v, a]
                n_points += 1
                edge = following(edge, twin)
                if edge == first:
                    break
            other[n_facets] = planes[wanted[q]]
            corners[n_facets] = n_points - size_before
            n_facets += 1
    return reach2, facets, other[:n_facets], corners[:n_facets], points[:n_points]
