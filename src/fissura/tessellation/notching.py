"""Cutting notches out of Voronoi cells: exact pieces of facets, and the walls of the notch.

A notch removes ``|d| < w/2, h < 0`` (`d` from its mid-plane, `h` above its root), so a convex facet leaves at most
three convex pieces: above the root, and below it on either side. Areas, centroids and volumes stay exact although
bodies at the root need not be convex any more.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.specimen import Notch
from fissura.tessellation.polygon import clip, clip_many
from fissura.tessellation.voronoi import Ragged

__all__ = ["check_not_bridged", "cut_facets", "notch_walls"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_ON_PLANE = 1e-9  # relative to the specimen's size


def _half_space(polygons: Ragged, normal: FloatArray, offset: float) -> Ragged:
    points, offsets = clip_many(polygons.points, polygons.offsets, normal, offset)
    return Ragged(points, offsets, polygons.owner)


def _frame(notch: Notch) -> tuple[FloatArray, FloatArray, float]:
    """Unit vector across the notch, unit vector up from its root, and the root's coordinate along the latter."""
    across, up = np.eye(3)[notch.normal], np.eye(3)[notch.axis] * (1.0 if notch.side == 0 else -1.0)
    return across, up, notch.root * (1.0 if notch.side == 0 else -1.0)


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
    tolerance = _ON_PLANE * max(notch.size)
    d_low, d_high = polygons.extremes(polygons.points[:, notch.normal] - notch.position)
    h_low, _ = polygons.extremes(notch.height(polygons.points))
    below = h_low < -tolerance
    none = Ragged(np.empty((0, 3)), np.zeros(1, np.int64), np.empty(0, np.int64))
    if notch.width == 0.0:
        cut = below & (d_low > -tolerance) & (d_high < tolerance)
        chosen = polygons.take(np.flatnonzero(cut))
        rest = polygons.take(np.flatnonzero(~cut))
        above, under = _half_space(chosen, -up, -root), _half_space(chosen, up, root)
        return rest.joined(above), none.joined(under), np.empty(0, np.int64)
    half = 0.5 * notch.width
    cut = below & (d_low < half) & (d_high > -half)
    chosen = polygons.take(np.flatnonzero(cut))
    rest = polygons.take(np.flatnonzero(~cut))
    above, under = _half_space(chosen, -up, -root), _half_space(chosen, up, root)
    left = _half_space(under, across, notch.position - half)
    right = _half_space(under, -across, -notch.position - half)
    return rest.joined(above, left, right), none, chosen.owner


@njit(cache=True)
def _clip_by_cells(bodies, rectangle, x, first, neighbour):  # type: ignore[no-untyped-def]
    out = np.empty((len(bodies) * 40, 3))
    counts = np.zeros(len(bodies), np.int64)
    a = np.empty((64, 3))
    b = np.empty((64, 3))
    n = 0
    for q in range(len(bodies)):
        i = bodies[q]
        count = len(rectangle)
        a[:count] = rectangle
        for k in range(first[i], first[i + 1]):
            normal = x[neighbour[k]] - x[i]
            offset = 0.0
            for m in range(3):
                offset += 0.5 * normal[m] * (x[neighbour[k], m] + x[i, m])
            count = clip(a, count, normal, offset, b)
            a, b = b, a
            if count == 0:
                break
        out[n : n + count] = a[:count]
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
        Bodies that may reach into it.
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
    ends = np.concatenate([pairs, pairs[:, ::-1]])
    order = np.argsort(ends[:, 0], kind="stable")
    first = np.searchsorted(ends[order, 0], np.arange(len(x) + 1))
    neighbour = ends[order, 1]
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


def check_not_bridged(notch: Notch, count: int, pieces: list[tuple[Ragged, IntArray]]) -> None:
    """No body may have material on both sides of the notch below its root.

    Parameters
    ----------
    notch : Notch
        The notch.
    count : int
        Number of bodies.
    pieces : list of (Ragged, (q,) array)
        Remaining polygons and the body of each.

    Raises
    ------
    InputError
        The discretization is too coarse for the place of the notch.
    """
    tolerance = 1e-6 * max(notch.size)
    sides = np.zeros((2, count), bool)
    for polygons, body in pieces:
        owner = np.repeat(body, np.diff(polygons.offsets))
        d = polygons.points[:, notch.normal] - notch.position
        below = notch.height(polygons.points) < -tolerance
        sides[0, owner[below & (d < -0.5 * notch.width - tolerance)]] = True
        sides[1, owner[below & (d > 0.5 * notch.width + tolerance)]] = True
    bridges = int(sides.all(axis=0).sum())
    if bridges:
        raise InputError(
            "discretization.l_c",
            f"{bridges} bodies would reach across the notch at {notch.position:g} m",
            "a smaller l_c, or a notch farther from the end of the specimen",
        )
