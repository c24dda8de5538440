"""Compiled kernel that clips bodies: their pieces in convex cells, found breadth first through open faces.

Each body is a function of its own surroundings only. It begins in the convex cell that holds its nucleus; where a
piece reaches an open face, the body goes on in the cell behind.
"""

import numpy as np

from fissura.kernels import INNER, njit
from fissura.specimen.polyhedron import following
from fissura.tessellation.corner import corner_scratch, place_corner
from fissura.tessellation.limits import NO_OPENING
from fissura.tessellation.piece import admitted, clip_piece, work_arrays
from fissura.tessellation.polygon import area2, clip
from fissura.tessellation.search import longer, taller


@njit(**INNER)
def _saw(i, k, j, seen, n):  # type: ignore[no-untyped-def]
    """Note that body `i` is cut by nucleus `j` in a cell that is not the latter's own."""
    if n == len(seen):
        seen = taller(seen)
    seen[n, 0], seen[n, 1], seen[n, 2] = i, k, j
    return seen, n + 1


@njit(**INNER)
def _write(polygon, count, other, plane, facets, points, n, n_points):  # type: ignore[no-untyped-def]
    """Append a polygon, what lies behind it, and its plane on the surface."""
    if n == len(facets):
        facets = taller(facets)
    facets[n, 0], facets[n, 1], facets[n, 2] = other, plane, count
    while n_points + count > len(points):
        points = taller(points)
    for m in range(count):
        for a in range(3):
            points[n_points + m, a] = polygon[m, a]
    return facets, points, n + 1, n_points + count


@njit(**INNER)
def _within_part(part, cx, rooms, which, count):  # type: ignore[no-untyped-def]
    """Clip the polygon in ``rooms[0]`` by the edges of a part of its plane; returns where it is and its corners."""
    for e in range(cx.edge_start[part], cx.edge_start[part + 1]):
        target = 1 if which != 1 else 2
        count = clip(rooms[which], count, cx.edge_normal[e], cx.edge_offset[e], rooms[target])
        which = target
        if count == 0:
            break
    return which, count


@njit(**INNER)
def _bisector(i, j, x, sign, normal):  # type: ignore[no-untyped-def]
    """Half-space nearer to nucleus `i` than to `j`, for a negative sign the other one; returns its offset."""
    offset = 0.0
    for a in range(3):
        normal[a] = sign * (x[j, a] - x[i, a])
        offset += 0.5 * normal[a] * (x[j, a] + x[i, a])
    return offset


@njit(**INNER)
def _area2(first, twin, p):  # type: ignore[no-untyped-def]
    """Squared area of a facet of a piece."""
    o, b = first >> 2, following(first, twin)
    v0 = v1 = v2 = 0.0
    while True:
        a, b = b, following(b, twin)
        if b == first:
            return v0 * v0 + v1 * v1 + v2 * v2
        u, w = a >> 2, b >> 2
        a0, a1, a2 = p[0, u] - p[0, o], p[1, u] - p[1, o], p[2, u] - p[2, o]
        b0, b1, b2 = p[0, w] - p[0, o], p[1, w] - p[1, o], p[2, w] - p[2, o]
        v0 += 0.5 * (a1 * b2 - a2 * b1)
        v1 += 0.5 * (a2 * b0 - a0 * b2)
        v2 += 0.5 * (a0 * b1 - a1 * b0)


@njit(**INNER)
def _entered(to, queue, end, opening2, least2):  # type: ignore[no-untyped-def]
    """Go on in a cell, unless it is known already or the opening is round-off; squared areas."""
    for q in range(end):
        if queue[q] == to:
            return queue, end
    if opening2 > least2:
        if end == len(queue):
            queue = longer(queue)
        queue[end] = to
        end += 1
    return queue, end


@njit(**INNER)
def _surface_facets(i, f, count, x, home, cx, rules, key, passed, twin, least2, rooms, out, numbers):  # type: ignore[no-untyped-def]
    """Facets and openings on plane `f` of a cell, of which ``rooms[0]`` is the body's polygon.

    Nuclei that are not admitted in this cell, those in `passed`, may own what lies behind an open part, and this body
    may not be admitted there: what cannot go on ends in a ledge, which is free surface. `twin` is the mirror image of
    the nucleus in this plane, -1 for none.
    """
    excluded, barred, ledge = rules
    facets, points, queue, seen = out
    n_facets, n_points, end, n_seen = numbers
    normal = np.empty(3)
    for part in range(cx.part_start[f], cx.part_start[f + 1]):
        which, left = _within_part(part, cx, rooms, 0, count)
        if left == 0:
            continue
        to = cx.part_to[part]
        if to < 0:
            facets, points, n_facets, n_points = _write(rooms[which], left, to, key, facets, points, n_facets, n_points)
            continue
        for j in passed:
            if not admitted(j, to, x, home, cx, excluded):
                continue
            offset = _bisector(i, j, x, -1.0, normal)
            beyond = clip(rooms[which], left, normal, offset, rooms[3])
            if beyond == 0 or area2(rooms[3], beyond) <= least2:
                continue
            facets, points, n_facets, n_points = _write(
                rooms[3], beyond, ledge, key, facets, points, n_facets, n_points
            )
            seen, n_seen = _saw(i, to, j, seen, n_seen)
            offset = _bisector(i, j, x, 1.0, normal)
            target = 1 if which != 1 else 2
            left = clip(rooms[which], left, normal, offset, rooms[target])
            which = target
            if left == 0:
                break
        if left == 0:
            continue
        if twin >= 0 and admitted(twin, to, x, home, cx, excluded):
            # The face is the bisector, so what is on it is the contact.
            if home[twin] != to:
                seen, n_seen = _saw(i, to, twin, seen, n_seen)
            if twin > i:
                facets, points, n_facets, n_points = _write(
                    rooms[which], left, twin, 0, facets, points, n_facets, n_points
                )
            continue
        if not admitted(i, to, x, home, cx, barred):
            facets, points, n_facets, n_points = _write(
                rooms[which], left, ledge, key, facets, points, n_facets, n_points
            )
            continue
        queue, end = _entered(to, queue, end, area2(rooms[which], left), least2)
    return (facets, points, queue, seen), (n_facets, n_points, end, n_seen)


@njit()
def clip_bodies(todo, x, home, cx, tables, guess, grid, rules, points):  # type: ignore[no-untyped-def]
    """Clip the bodies of the nuclei `todo`.

    Other parameters are all nuclei `x`, the convex cells `home` that hold them, the complex `cx` with its `tables`, a
    `guess` of each nucleus' distance to its neighbours, the nuclei sorted into a `grid`, the `rules` of admission
    beside those of the complex, and `points` (p, 3), a place for corners. The tables are a number for each plane that
    tells on which side of it the body is, normals and offsets of planes, and bounds of cells. The rules are sorted
    numbers ``k n + j`` of nuclei that do not cut a cell, and of those that may not enter it either, and the number by
    which ledges are called.

    Returns for every body the squared radius within which nuclei matter, its number of facets, and of pieces; then for
    every facet (f, 3) its other nucleus, or -1 less its surface, the key of its plane, and its number of corners;
    these corners; the cells of all pieces; and what bodies see (s, 3): a body, a cell, and a nucleus that cuts the
    body's piece there although that cell is not its own. A facet between two nuclei is given for the lower one only.
    """
    plane_start, part_start, part_to = cx.plane_start, cx.part_start, cx.part_to
    plane_id, (keys, table, bounds) = cx.plane_id, tables
    most_corners, most_planes = 0, 0
    for k in range(len(cx.corner_start) - 1):
        most_corners = max(most_corners, cx.corner_start[k + 1] - cx.corner_start[k])
        most_planes = max(most_planes, cx.plane_start[k + 1] - cx.plane_start[k])
    room = most_corners + 64
    work, (whole, rows) = work_arrays(room), corner_scratch()
    corner, known = np.empty((room, 3)), np.empty(room, np.bool_)
    # A polygon has fewer corners than the piece, and clipping adds one each time, or more where round-off has a say.
    most_edges = 0
    for part in range(len(cx.part_to)):
        most_edges = max(most_edges, cx.edge_start[part + 1] - cx.edge_start[part])
    rooms = np.empty((4, 2 * (room + most_edges + 64), 3))
    near = (np.empty(256), np.empty(256, np.int64))
    planes, at = np.empty(most_planes + 64, np.int64), np.empty(most_planes + 64, np.int64)
    doors = (np.empty(most_planes, np.int64), np.empty(most_planes, np.int64), np.empty(most_planes))
    passed, queue = np.empty(64, np.int64), np.empty(64, np.int64)
    reach2, of_facets, of_pieces = np.empty(len(todo)), np.zeros(len(todo), np.int64), np.empty(len(todo), np.int64)
    facets = np.empty((10 * len(todo) + 64, 3), np.int64)
    pieces, seen = np.empty(2 * len(todo) + 64, np.int64), np.empty((len(todo) + 64, 3), np.int64)
    n_facets, n_points, n_pieces, n_seen, before2 = 0, 0, 0, 0, np.inf
    for body in range(len(todo)):
        i = todo[body]
        first2 = min(before2, max(2.0 * guess[i], grid.side) ** 2)
        found = (0, -1.0)
        queue[0], head, end = home[i], 0, 1
        least2, matters2, facets_before, pieces_before = 0.0, 0.0, n_facets, n_pieces
        while head < end:
            k = queue[head]
            count, n_planes, n_passed, limit2, sought2, found, near, work, planes, passed = clip_piece(
                i, k, x, home, cx, rules[0], grid, first2, found, near, work, planes, doors, passed
            )
            if head == 0:
                least2 = (0.25 * NO_OPENING * limit2) ** 2
                before2 = sought2
            head += 1
            matters2 = max(matters2, sought2)
            if count == 0:
                # Whoever cut it away is answerable for what is there.
                for f in range(plane_start[k + 1] - plane_start[k], n_planes):
                    if home[planes[f]] != k:
                        seen, n_seen = _saw(i, k, planes[f], seen, n_seen)
                continue
            if n_pieces == len(pieces):
                pieces = longer(pieces)
            pieces[n_pieces] = k
            n_pieces += 1
            p, face, twin, radius, first = work[0], work[4], work[3], 0.5 * np.sqrt(limit2), plane_start[k]
            if count > len(known):
                room = len(work[1])
                corner, known = np.empty((room, 3)), np.empty(room, np.bool_)
            if 2 * (count + most_edges + n_passed) > rooms.shape[1]:
                rooms = np.empty((4, 4 * (count + most_edges + n_passed), 3))
            if n_planes > len(at):
                at = np.empty(len(planes), np.int64)
            for f in range(n_planes):
                at[f] = -1
            for v in range(count):
                known[v] = False
                for m in range(3):
                    at[face[4 * v + m]] = 4 * v + m
            for f in range(n_planes):
                if at[f] < 0:
                    continue
                j = planes[f]
                if j >= 0:
                    if home[j] != k:
                        seen, n_seen = _saw(i, k, j, seen, n_seen)
                    if j < i:
                        continue
                plane = first - 1 - j
                single = j < 0 and part_start[plane + 1] == part_start[plane] + 1
                to = part_to[part_start[plane]] if single else -1
                if (
                    to >= 0
                    and n_passed == 0
                    and doors[0][-1 - j] < 0
                    and (home[i] == to or (len(rules[1]) == 0 and cx.rule_start[to] == cx.rule_start[to + 1]))
                ):
                    # The most common case: all of it is open, and no one may end there.
                    queue, end = _entered(to, queue, end, _area2(at[f], twin, p), least2)
                    continue
                while n_points + count > len(points):
                    points = taller(points)
                if n_facets == len(facets):
                    facets = taller(facets)
                edge, size = at[f], 0
                while True:
                    v = edge >> 2
                    if not known[v]:
                        place_corner(
                            i, v, k, first, x, table, bounds, plane_id, p, face, planes, radius, whole, rows, corner
                        )
                        known[v] = True
                    for a in range(3):
                        points[n_points + size, a] = corner[v, a]
                    size += 1
                    edge = following(edge, twin)
                    if edge == at[f]:
                        break
                if j >= 0 or (single and to < 0):
                    facets[n_facets, 0], facets[n_facets, 1], facets[n_facets, 2] = j, 0, size
                    if j < 0:
                        facets[n_facets, 0], facets[n_facets, 1] = to, keys[plane]
                    n_facets += 1
                    n_points += size
                    continue
                for m in range(size):
                    for a in range(3):
                        rooms[0, m, a] = points[n_points + m, a]
                out, numbers = (facets, points, queue, seen), (n_facets, n_points, end, n_seen)
                (facets, points, queue, seen), (n_facets, n_points, end, n_seen) = _surface_facets(
                    i, plane, size, x, home, cx, rules, keys[plane], passed[:n_passed], doors[0][-1 - j], least2,
                    rooms, out, numbers,
                )  # fmt: skip
        reach2[body] = matters2
        of_facets[body], of_pieces[body] = n_facets - facets_before, n_pieces - pieces_before
    return reach2, of_facets, of_pieces, facets[:n_facets], points[:n_points], pieces[:n_pieces], seen[:n_seen]
