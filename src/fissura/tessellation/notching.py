"""Cutting notches out of Voronoi cells: exact pieces of facets, and the walls of the notch.

A notch removes ``|d| < w/2, h < 0`` (`d` from its mid-plane, `h` above its root), so a convex facet leaves at most
three convex pieces: above the root, and below it on either side. Areas, centroids and volumes stay exact although
bodies at the root need not be convex any more.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.kernels import njit
from fissura.specimen import Notch
from fissura.tessellation.polygon import clip, clip_many
from fissura.tessellation.ragged import Ragged

__all__ = ["check_not_bridged", "cut_facets", "near_notches", "notch_walls"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_ON_PLANE = 1e-9  # relative to the specimen's size


def _tolerance(notch: Notch) -> float:
    return _ON_PLANE * max(notch.size)


def _half_space(polygons: Ragged, normal: FloatArray, offset: float) -> Ragged:
    points, offsets = clip_many(polygons.points, polygons.offsets, normal, offset)
    return Ragged(points, offsets, polygons.owner)


def _frame(notch: Notch) -> tuple[FloatArray, FloatArray, float]:
    """Unit vector across the notch, unit vector up from its root, and the root's coordinate along the latter."""
    across, up = np.eye(3)[notch.normal], np.eye(3)[notch.axis] * (1.0 if notch.side == 0 else -1.0)
    return across, up, notch.root * (1.0 if notch.side == 0 else -1.0)


@njit(cache=True)
def _reach(points, offsets, axis, root, upward, normal, position, half):  # type: ignore[no-untyped-def]
    out = np.zeros(len(offsets) - 1, np.bool_)
    for k in range(len(out)):
        low, high, deep = np.inf, -np.inf, False
        for m in range(offsets[k], offsets[k + 1]):
            d = points[m, normal] - position
            low, high = min(low, d), max(high, d)
            deep |= upward * (points[m, axis] - root) < 0.0
        out[k] = deep and low < half and high > -half
    return out


def _reached(polygons: Ragged, notch: Notch, half: float) -> NDArray[np.bool_]:
    """Polygons with a part less than `half` from the mid-plane and below the root."""
    upward = 1.0 if notch.side == 0 else -1.0
    root = notch.root - upward * _tolerance(notch)
    plane = (notch.normal, notch.position, half)
    return np.asarray(_reach(polygons.points, polygons.offsets, notch.axis, root, upward, *plane))


def near_notches(
    polygons: Ragged, body: IntArray, x: FloatArray, radius: FloatArray, notches: Iterable[Notch]
) -> NDArray[np.bool_]:
    """Polygons that `cut_facets` may change, and perhaps a few more.

    Parameters
    ----------
    polygons : Ragged
        Polygons, one of each owner.
    body : (q,) array
        A body to which each belongs.
    x, radius : (n, 3), (n,) array
        Nuclei, and distances within which their cells lie [m].
    notches : iterable of Notch
        The notches.
    """
    near = np.zeros(len(polygons), np.bool_)
    for notch in notches:
        half = 0.5 * notch.width + 2.0 * _tolerance(notch)
        reaching = (np.abs(x[:, notch.normal] - notch.position) - half < radius) & (notch.height(x) < radius)
        rows = np.flatnonzero(reaching[body])
        near[rows[_reached(polygons.take(rows), notch, half)]] = True
    return near


def cut_facets(polygons: Ragged, notch: Notch) -> tuple[Ragged, Ragged, IntArray]:
    """Cut a notch out of facets.

    Returns
    -------
    kept : Ragged
        What remains of all polygons.
    severed : Ragged
        For a cut of zero width, the pieces that lay in its plane: they become walls on either side.
    touched : (t,) array
        Owners of the polygons that reach into a saw cut.
    """
    across, up, root = _frame(notch)
    tolerance = _tolerance(notch)
    none = Ragged(np.empty((0, 3)), np.zeros(1, np.int64), np.empty(0, np.int64))
    if notch.width == 0.0:
        low, high = polygons.extremes(notch.normal)
        cut = _reached(polygons, notch, tolerance)
        cut &= (low - notch.position > -tolerance) & (high - notch.position < tolerance)
        chosen = polygons.take(np.flatnonzero(cut))
        rest = polygons.take(np.flatnonzero(~cut))
        above, under = _half_space(chosen, -up, -root), _half_space(chosen, up, root)
        return rest.joined(above), none.joined(under), np.empty(0, np.int64)
    half = 0.5 * notch.width
    cut = _reached(polygons, notch, half)
    chosen = polygons.take(np.flatnonzero(cut))
    rest = polygons.take(np.flatnonzero(~cut))
    above, under = _half_space(chosen, -up, -root), _half_space(chosen, up, root)
    left = _half_space(under, across, notch.position - half)
    right = _half_space(under, -across, -notch.position - half)
    return rest.joined(above, left, right), none, chosen.owner


@njit(cache=True)
def _clip_by_cells(bodies, rectangle, x, first, neighbour):  # type: ignore[no-untyped-def]
    out = np.empty((len(bodies) * 8 + 64, 3))
    counts = np.zeros(len(bodies), np.int64)
    most = 0
    for q in range(len(bodies)):
        most = max(most, first[q + 1] - first[q])
    most += len(rectangle)  # each plane adds one corner at most
    a = np.empty((most, 3))
    b = np.empty((most, 3))
    normal = np.empty(3)
    n = 0
    for q in range(len(bodies)):
        i = bodies[q]
        count = len(rectangle)
        for k in range(count):
            for m in range(3):
                a[k, m] = rectangle[k, m]
        for k in range(first[q], first[q + 1]):
            offset = 0.0
            for m in range(3):
                normal[m] = x[neighbour[k], m] - x[i, m]
                offset += 0.5 * normal[m] * (x[neighbour[k], m] + x[i, m])
            count = clip(a, count, normal, offset, b)
            a, b = b, a
            if count == 0:
                break
        if n + count > len(out):
            longer = np.empty((2 * len(out) + most, 3))
            for k in range(n):
                for m in range(3):
                    longer[k, m] = out[k, m]
            out = longer
        for k in range(count):
            for m in range(3):
                out[n + k, m] = a[k, m]
        counts[q] = count
        n += count
    return out[:n].copy(), counts


def notch_walls(notch: Notch, bodies: IntArray, x: FloatArray, pairs: IntArray) -> tuple[Ragged, IntArray, FloatArray]:
    """Walls and root of a saw cut, divided among bodies.

    Parameters
    ----------
    notch : Notch
        A notch of positive width.
    bodies : (k,) array
        Bodies that may reach into it, ascending.
    x : (n, 3) array
        Nuclei [m].
    pairs : (m, 2) array
        Neighbouring cells before the notch was cut.

    Returns
    -------
    polygons : Ragged
        Pieces of the walls; ``owner`` counts them.
    body : (q,) array
        Body behind each piece.
    normal : (q, 3) array
        Outward normal, into the notch.
    """
    across, up, _ = _frame(notch)
    near = np.zeros(len(x), np.bool_)
    near[bodies] = True
    ends = np.concatenate([pairs[near[pairs[:, 0]]], pairs[near[pairs[:, 1]]][:, ::-1]])
    ends = ends[np.argsort(ends[:, 0], kind="stable")]
    first = np.append(np.searchsorted(ends[:, 0], bodies), len(ends))
    neighbour = ends[:, 1]
    low, high = notch.bounds
    walls = [
        (notch.normal, low[notch.normal], across),
        (notch.normal, high[notch.normal], -across),
        (notch.axis, notch.root, -up),
    ]
    points, counts, owners, normals = [], [], [], []
    for axis, coordinate, normal in walls:
        u, v = (k for k in range(3) if k != axis)
        rectangle = np.empty((4, 3))
        rectangle[:, axis] = coordinate
        rectangle[:, u] = [low[u], high[u], high[u], low[u]]
        rectangle[:, v] = [low[v], low[v], high[v], high[v]]
        p, c = _clip_by_cells(bodies, rectangle, x, first, neighbour)
        points.append(p)
        counts.append(c[c > 0])
        owners.append(bodies[c > 0])
        normals.append(np.tile(normal, (int((c > 0).sum()), 1)))
    body = np.concatenate(owners)
    offsets = np.concatenate([[0], np.cumsum(np.concatenate(counts))])
    return Ragged(np.concatenate(points), offsets, np.arange(len(body))), body, np.concatenate(normals)


@njit(cache=True)
def _mark_sides(  # type: ignore[no-untyped-def]
    points, offsets, owner, body, near, normal, position, half, axis, root, upward, tolerance, sides
):
    for k in range(len(owner)):
        i = body[owner[k]]
        if not near[i]:
            continue
        for m in range(offsets[k], offsets[k + 1]):
            if upward * (points[m, axis] - root) < -tolerance:
                d = points[m, normal] - position
                if d < -half:
                    sides[0, i] = True
                elif d > half:
                    sides[1, i] = True


def check_not_bridged(notch: Notch, near: NDArray[np.bool_], pieces: list[tuple[Ragged, IntArray]]) -> None:
    """No body may have material on both sides of the notch below its root.

    Parameters
    ----------
    notch : Notch
        The notch.
    near : (n,) bool array
        Bodies that had a facet near it; the others cannot reach across.
    pieces : list of (Ragged, (m,) array)
        Remaining polygons, and the body of each owner.

    Raises
    ------
    InputError
        The discretization is too coarse for the place of the notch.
    """
    tolerance = 1e-6 * max(notch.size)
    plane = (notch.normal, notch.position, 0.5 * notch.width + tolerance)
    root = (notch.axis, notch.root, 1.0 if notch.side == 0 else -1.0, tolerance)
    sides = np.zeros((2, len(near)), np.bool_)
    for polygons, body in pieces:
        _mark_sides(polygons.points, polygons.offsets, polygons.owner, body, near, *plane, *root, sides)
    bridges = int(sides.all(axis=0).sum())
    if bridges:
        raise InputError(
            "discretization.l_c",
            f"{bridges} {'body' if bridges == 1 else 'bodies'} would reach across the notch at {notch.position:g} m",
            "a smaller l_c, or a notch farther from the end of the specimen",
        )
