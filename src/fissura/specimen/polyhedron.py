"""Compiled operations on one convex polyhedron with three facets at every corner, cut by half-spaces.

Corner ``v`` has three edges that leave it, ``4 v + k`` with ``k`` = 0, 1, 2 counterclockwise seen from outside.
``twin[e]`` is the same edge seen from its other end and ``face[e]`` the facet on its left. A cut keeps this
structure whatever round-off does to distances: the corners cut off are made one connected piece, and so are those
that stay, so the boundary between them is a single loop of edges and becomes the new facet.
"""

import numpy as np

from fissura.arrays import IntArray
from fissura.kernels import INNER, njit

UNCUT, TOO_SHORT = -1, -2


def _box_tables() -> tuple[IntArray, IntArray]:
    """Edges of a box whose corner ``v`` lies on the upper side of axis ``a`` where bit ``a`` of ``v`` is set."""
    twin, face = np.full(32, -1, np.int64), np.full(32, -1, np.int64)
    axes = [(0, 1, 2) if v.bit_count() % 2 else (0, 2, 1) for v in range(8)]
    for v in range(8):
        for k in range(3):
            other = v ^ (1 << axes[v][k])
            twin[4 * v + k] = 4 * other + axes[other].index(axes[v][k])
            axis = axes[v][(k + 2) % 3]  # the facet between this edge and the next one counterclockwise
            face[4 * v + k] = 2 * axis + ((v >> axis) & 1)
    return twin, face


_TWIN, _FACE = _box_tables()


@njit(inline="always")
def following(edge, twin):  # type: ignore[no-untyped-def]
    """The next edge around the facet on the left."""
    back = twin[edge]
    return back - 1 if back & 3 else back + 2


@njit(**INNER)
def box(low, high, p, r2, twin, face):  # type: ignore[no-untyped-def]
    """Begin with a box whose facet ``2 axis + side`` has that number; return its number of corners."""
    for v in range(8):
        r2[v] = 0.0
        for a in range(3):
            p[a, v] = high[a] if (v >> a) & 1 else low[a]
            r2[v] += p[a, v] ** 2
    for edge in range(32):
        twin[edge], face[edge] = _TWIN[edge], _FACE[edge]
    return len(_TWIN) // 4


@njit(**INNER)
def farthest(r2, count):  # type: ignore[no-untyped-def]
    """Largest squared distance of a corner from the origin."""
    out = 0.0
    for v in range(count):
        if r2[v] > out:
            out = r2[v]
    return out


@njit(**INNER)
def _reached(start, count, s, twin, tolerance, outside, mark, stack):  # type: ignore[no-untyped-def]
    """Mark the corners on one side of the plane that edges connect to `start`."""
    for v in range(count):
        mark[v] = False
    mark[start] = True
    stack[0] = start
    size = 1
    while size > 0:
        size -= 1
        v = stack[size]
        for k in range(3):
            w = twin[4 * v + k] >> 2
            if not mark[w] and (s[w] > tolerance) == outside:
                mark[w] = True
                stack[size] = w
                size += 1


@njit(**INNER)
def _made_single(count, s, twin, tolerance):  # type: ignore[no-untyped-def]
    """Join what is cut off, and what stays, to one piece each: the others lie in the plane but for round-off."""
    mark = np.empty(count, np.bool_)
    stack = np.empty(3 * count, np.int64)
    highest, lowest = 0, 0
    for v in range(count):
        if s[v] > s[highest]:
            highest = v
        if s[v] < s[lowest]:
            lowest = v
    _reached(highest, count, s, twin, tolerance, True, mark, stack)
    for v in range(count):
        if not mark[v] and s[v] > tolerance:
            s[v] = tolerance
    _reached(lowest, count, s, twin, tolerance, False, mark, stack)
    for v in range(count):
        if not mark[v] and s[v] <= tolerance:
            s[v] = 2.0 * tolerance


@njit(**INNER)
def _loop(first, s, twin, tolerance, edges):  # type: ignore[no-untyped-def]
    """List the cut edges around the loop that begins with one of them; return their number."""
    n = 0
    edge = first
    while True:
        edges[n] = edge
        n += 1
        while s[twin[edge] >> 2] > tolerance:
            edge = following(edge, twin)
        edge = twin[edge]
        if edge == first:
            return n


@njit(**INNER)
def _crossing(count, s, twin, tolerance, gone):  # type: ignore[no-untyped-def]
    """Corners cut off, and the edges that lead to them from corners that stay: numbers of both, one such edge."""
    q = 0
    for v in range(count):
        if s[v] > tolerance:
            gone[q] = v
            q += 1
    total, first = 0, -1
    for m in range(q):
        for k in range(3):
            edge = twin[4 * gone[m] + k]
            if s[edge >> 2] <= tolerance:
                total += 1
                first = edge
    return q, total, first


@njit(**INNER)
def cut(  # type: ignore[no-untyped-def]
    p, r2, s, twin, face, count, n0, n1, n2, offset, tolerance, name, edges, gone, new
):
    """Keep the part with ``n . p <= offset``.

    Returns the number of corners that are left; or `UNCUT` where the plane does not reach farther than `tolerance`
    into the polyhedron, `TOO_SHORT` where the arrays are, and the polyhedron stays as it is. The new facet is called
    `name`.
    """
    most = tolerance
    for v in range(count):
        s[v] = n0 * p[0, v] + n1 * p[1, v] + n2 * p[2, v] - offset
    for v in range(count):
        most = max(most, s[v])
    if not most > tolerance:
        return UNCUT
    q, total, first = _crossing(count, s, twin, tolerance, gone)
    if total == 0:
        return 0
    n = _loop(first, s, twin, tolerance, edges)
    if n != total:
        _made_single(count, s, twin, tolerance)
        q, total, first = _crossing(count, s, twin, tolerance, gone)
        n = _loop(first, s, twin, tolerance, edges)
    left = count - q + n
    if max(left, count) > len(r2):
        return TOO_SHORT
    for c in range(n):
        u, w = edges[c] >> 2, twin[edges[c]] >> 2
        t = max(s[u] / (s[u] - s[w]), 0.0)
        for a in range(3):
            new[a, c] = p[a, u] + t * (p[a, w] - p[a, u])
        if c >= q:
            gone[c] = count + c - q
    for c in range(n):
        before = c - 1 if c > 0 else n - 1
        after = c + 1 if c + 1 < n else 0
        v, edge = gone[c], edges[c]
        for a in range(3):
            p[a, v] = new[a, c]
        r2[v] = new[0, c] ** 2 + new[1, c] ** 2 + new[2, c] ** 2
        twin[4 * v] = edge
        twin[edge] = 4 * v
        twin[4 * v + 1] = 4 * gone[before] + 2
        twin[4 * v + 2] = 4 * gone[after] + 1
        face[4 * v] = face[edges[before]]
        face[4 * v + 1] = name
        face[4 * v + 2] = face[edge]
    # Corners from the end fill the places that are left over.
    last, end = count - 1, q - 1
    for m in range(n, q):
        hole = gone[m]
        if hole >= left:
            break
        while end >= n and gone[end] == last:
            last -= 1
            end -= 1
        for a in range(3):
            p[a, hole] = p[a, last]
        r2[hole] = r2[last]
        for k in range(3):
            other = twin[4 * last + k]
            twin[4 * hole + k] = other
            twin[other] = 4 * hole + k
            face[4 * hole + k] = face[4 * last + k]
        last -= 1
    return left
