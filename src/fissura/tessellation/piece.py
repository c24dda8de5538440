"""Compiled kernel that clips one piece of a body: the part of one convex cell that is nearest to its nucleus.

A piece begins as the convex cell. The bisector planes of the other nuclei cut it, nearest first and lower numbers
first at equal distance, until the next nucleus is more than twice as far as the piece's farthest corner. Nuclei beyond
leave no trace in the result, not even in its last bit.
"""

import numpy as np

from fissura.kernels import INNER, njit
from fissura.specimen.polyhedron import TOO_SHORT, UNCUT, cut, farthest
from fissura.tessellation.limits import GROWTH, IN_COORDINATES, IN_PIECE, MIRRORED
from fissura.tessellation.search import found_within, longer


@njit(**INNER)
def contains(keys, key):  # type: ignore[no-untyped-def]
    """Whether sorted keys contain one."""
    low, high = 0, len(keys)
    while low < high:
        middle = (low + high) >> 1
        if keys[middle] < key:
            low = middle + 1
        else:
            high = middle
    return low < len(keys) and keys[low] == key


@njit(**INNER)
def admitted(j, k, x, home, cx, excluded):  # type: ignore[no-untyped-def]
    """Whether nucleus `j` may own material in convex cell `k`: by the cell's rules, and where it is not excluded."""
    if home[j] == k:
        return True
    for r in range(cx.rule_start[k], cx.rule_start[k + 1]):
        n = cx.rule_normal[r]
        if n[0] * x[j, 0] + n[1] * x[j, 1] + n[2] * x[j, 2] <= cx.rule_offset[r]:
            return False
    return len(excluded) == 0 or not contains(excluded, k * len(x) + j)


@njit(**INNER)
def work_arrays(room):  # type: ignore[no-untyped-def]
    """Corners relative to the nucleus, their squared distances, and what `cut` needs, for so many corners."""
    return (
        np.empty((3, room)), np.empty(room), np.empty(room), np.empty(4 * room, np.int64), np.empty(4 * room, np.int64),
        np.empty(4 * room, np.int64), np.empty(4 * room, np.int64), np.empty((3, room)),
    )  # fmt: skip


@njit(**INNER)
def _wider(array):  # type: ignore[no-untyped-def]
    out = np.empty((3, 2 * array.shape[1]))
    for a in range(3):
        for k in range(array.shape[1]):
            out[a, k] = array[a, k]
    return out


@njit(**INNER)
def _begin(k, origin, start, corner, twins, faces, p, r2, twin, face):  # type: ignore[no-untyped-def]
    """Begin with convex cell `k`, seen from a nucleus; returns its number of corners."""
    first = start[k]
    count = start[k + 1] - first
    for v in range(count):
        r2[v] = 0.0
        for a in range(3):
            p[a, v] = corner[a, first + v] - origin[a]
            r2[v] += p[a, v] ** 2
    for e in range(4 * count):
        twin[e], face[e] = twins[4 * first + e], faces[4 * first + e]
    return count


@njit(**INNER)
def _mirrored(i, j, plane, x, normal, offset):  # type: ignore[no-untyped-def]
    """Whether two nuclei are mirror images in a plane; the same for both of them, and from either side of it."""
    n0, n1, n2 = normal[plane, 0], normal[plane, 1], normal[plane, 2]
    d0, d1, d2 = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
    off = n0 * (0.5 * (x[i, 0] + x[j, 0])) + n1 * (0.5 * (x[i, 1] + x[j, 1])) + n2 * (0.5 * (x[i, 2] + x[j, 2]))
    along = n0 * d0 + n1 * d1 + n2 * d2
    t0, t1, t2 = d0 - along * n0, d1 - along * n1, d2 - along * n2
    least = MIRRORED * np.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
    return abs(off - offset[plane]) < least and t0 * t0 + t1 * t1 + t2 * t2 < least * least


@njit(**INNER)
def _doors(i, k, x, cx, twins, door, door2):  # type: ignore[no-untyped-def]
    """List the open planes of a cell, with the squared distance of the nucleus from its mirror image in each."""
    n = 0
    first = cx.plane_start[k]
    for f in range(first, cx.plane_start[k + 1]):
        twins[f - first] = -1
        if cx.opens[f]:
            h = cx.normal[f, 0] * x[i, 0] + cx.normal[f, 1] * x[i, 1] + cx.normal[f, 2] * x[i, 2] - cx.offset[f]
            door[n], door2[n] = f, 4.0 * h * h
            n += 1
    return n


@njit(**INNER)
def clip_piece(  # type: ignore[no-untyped-def]
    i, k, x, home, cx, excluded, grid, first2, found, near, work, planes, doors, passed
):
    """Clip convex cell `k` by the bisectors of nucleus `i`.

    Bisectors that lie in an open face, as those of mirror images do, do not cut: which of the two owns the cell is
    decided by its side of the face, so that round-off has no say, and ``doors[0]`` names the other nucleus for every
    plane of the cell.

    `found` are number and squared radius of the nuclei in `near`; `first2` is the radius to begin with where there are
    none yet. ``planes[f]`` becomes the nucleus behind facet `f`, or -1 less a plane of the cell. Returns numbers of
    corners, planes, and nuclei in `passed`, which would cut the piece were they admitted; squared radius of the piece
    (four times) and radius within which nuclei matter; and the arrays that may have been given more room.
    """
    p, r2, s, twin, face, edges, gone, new = work
    n, filled2 = found
    d2, number = near
    twins, door, door2 = doors
    normal, offset, extent = cx.normal, cx.offset, cx.extent
    ruled = len(excluded) > 0 or cx.rule_start[k + 1] > cx.rule_start[k]
    origin = x[i]
    count = _begin(k, origin, cx.corner_start, cx.corner, cx.twin, cx.face, p, r2, twin, face)
    n_planes = cx.plane_start[k + 1] - cx.plane_start[k]
    for f in range(n_planes):
        planes[f] = -1 - f
    n_doors = _doors(i, k, x, cx, twins, door, door2)
    limit2 = 4.0 * farthest(r2, count)
    last2, m, n_passed = 0.0, 0, 0
    while True:
        if m == n:
            if filled2 >= limit2:
                break
            outer2 = min(first2, limit2) if filled2 < 0.0 else min(limit2, GROWTH * filled2)
            n, d2, number = found_within(i, x, grid, filled2, outer2, n, d2, number)
            filled2 = outer2
            continue
        if d2[m] > limit2:
            break
        if d2[m] == 0.0:
            raise ValueError("two nuclei coincide")
        j = number[m]
        within, beyond = False, False  # the piece's side of an open face that is a bisector
        for q in range(n_doors):
            if abs(d2[m] - door2[q]) <= 8.0 * MIRRORED * d2[m] and _mirrored(i, j, door[q], x, normal, offset):
                f = door[q]
                h = normal[f, 0] * (x[j, 0] - origin[0]) + normal[f, 1] * (x[j, 1] - origin[1])
                within = h + normal[f, 2] * (x[j, 2] - origin[2]) > 0.0
                beyond = not within
                if within:
                    twins[f - cx.plane_start[k]] = j
                break
        if within:
            last2 = d2[m]
            m += 1
            continue
        if ruled and home[j] != k and not admitted(j, k, x, home, cx, excluded):
            if n_passed == len(passed):
                passed = longer(passed)
            passed[n_passed] = j
            n_passed += 1
            m += 1
            continue
        left = 0
        if not beyond:
            tolerance = np.sqrt(d2[m]) * (0.5 * IN_PIECE * np.sqrt(limit2) + IN_COORDINATES * extent)
            n0, n1, n2 = x[j, 0] - origin[0], x[j, 1] - origin[1], x[j, 2] - origin[2]
            left = cut(p, r2, s, twin, face, count, n0, n1, n2, 0.5 * d2[m], tolerance, n_planes, edges, gone, new)
            if left == TOO_SHORT:
                p, new = _wider(p), _wider(new)
                r2, s = longer(r2), longer(s)
                twin, face, edges, gone = longer(twin), longer(face), longer(edges), longer(gone)
                continue
        last2 = d2[m]
        m += 1
        if left == UNCUT:
            continue
        count = left
        if n_planes == len(planes):
            planes = longer(planes)
        planes[n_planes] = j
        n_planes += 1
        if count == 0:
            limit2 = 0.0
            break
        limit2 = 4.0 * farthest(r2, count)
    work = (p, r2, s, twin, face, edges, gone, new)
    return count, n_planes, n_passed, limit2, max(limit2, last2), (n, filled2), (d2, number), work, planes, passed
