"""Bodies as the kernel clips them, in arrays sorted by body, and with those of another time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.kernels import njit
from fissura.specimen.complex import Complex
from fissura.tessellation.bodies import clip_bodies
from fissura.tessellation.grid import Grid, grid_of
from fissura.tessellation.polygon import areas_and_centroids
from fissura.tessellation.ragged import Ragged

NONE = np.empty(0, np.int64)


@dataclass(frozen=True)
class Facets:
    """Polygons of facets, sorted by body, what lies behind, and plane.

    Attributes
    ----------
    body, other : (q,) array
        The body that they were taken from, and what lies behind them: a body, or -1 less a surface.
    plane : (q,) array
        Key of the plane of those on the surface, see `plane_keys`.
    polygons : Ragged
        Their corners.
    area, centroid : (q,), (q, 3) array
        Their areas [m^2] and centroids [m].
    """

    body: IntArray
    other: IntArray
    plane: IntArray
    polygons: Ragged
    area: FloatArray
    centroid: FloatArray

    def merged(self, stay: BoolArray, number: IntArray, new: Facets) -> Facets:
        """Those of bodies that stay, numbered anew, and new ones of other bodies."""
        ours = (self.body, self.other, self.plane, self.area, self.centroid)
        theirs = (new.body, new.other, new.plane, new.area, new.centroid)
        body, other, plane, area, centroid, chosen = _merged(*ours, stay, number, *theirs)
        return Facets(body, other, plane, self.polygons.picked(new.polygons, chosen), area, centroid)


@njit()
def _merged(  # type: ignore[no-untyped-def]
    body, other, plane, area, centroid, stay, number, new_body, new_other, new_plane, new_area, new_centroid
):
    most = len(body) + len(new_body)
    out_body, out_other, out_plane = np.empty(most, np.int64), np.empty(most, np.int64), np.empty(most, np.int64)
    chosen, out_area, out_centroid = np.empty(most, np.int64), np.empty(most), np.empty((most, 3))
    n, k, m = 0, 0, 0
    while k < len(body) or m < len(new_body):
        if k < len(body) and not stay[body[k]]:
            k += 1
            continue
        if m == len(new_body) or (k < len(body) and number[body[k]] < new_body[m]):
            out_body[n], out_plane[n], out_area[n] = number[body[k]], plane[k], area[k]
            out_other[n] = number[other[k]] if other[k] >= 0 else other[k]
            for a in range(3):
                out_centroid[n, a] = centroid[k, a]
            chosen[n] = k
            k += 1
        else:
            out_body[n], out_other[n], out_plane[n], out_area[n] = new_body[m], new_other[m], new_plane[m], new_area[m]
            for a in range(3):
                out_centroid[n, a] = new_centroid[m, a]
            chosen[n] = len(body) + m
            m += 1
        n += 1
    return out_body[:n], out_other[:n], out_plane[:n], out_area[:n], out_centroid[:n], chosen[:n]


@dataclass(frozen=True)
class Clipped:
    """Bodies, each a function of its own surroundings and of the nuclei that are excluded from cells.

    Attributes
    ----------
    reach2 : (n,) array
        Squared distance [m^2] beyond which nuclei have no influence on a body.
    inner, outer : Facets
        Facets between bodies, of the lower body only, and on the surface.
    pieces : (p, 2) array
        Body and convex cell of every piece, sorted by body.
    seen : (s, 3) array
        A body, a convex cell and a nucleus that cuts the body there although the cell is not its own; sorted by body.
    """

    reach2: FloatArray
    inner: Facets
    outer: Facets
    pieces: IntArray
    seen: IntArray

    def merged(self, stay: BoolArray, number: IntArray, new: Clipped) -> Clipped:
        """Bodies that `stay`, with new numbers, and new ones, which have the other numbers."""
        reach2 = new.reach2.copy()
        reach2[number[stay]] = self.reach2[stay]
        pieces = self.pieces[stay[self.pieces[:, 0]]]
        seen = self.seen[stay[self.seen[:, 0]]]
        pieces = np.stack([number[pieces[:, 0]], pieces[:, 1]], axis=1)
        seen = np.stack([number[seen[:, 0]], seen[:, 1], number[seen[:, 2]]], axis=1)
        return Clipped(
            reach2,
            self.inner.merged(stay, number, new.inner),
            self.outer.merged(stay, number, new.outer),
            _by_body(np.concatenate([pieces, new.pieces])),
            _by_body(np.concatenate([seen, new.seen])),
        )


def _by_body(rows: IntArray) -> IntArray:
    return rows[np.argsort(rows[:, 0], kind="stable")]


class Setting(NamedTuple):
    """What bodies are clipped in.

    Attributes
    ----------
    x : (n, 3) array
        All nuclei [m].
    home : (n,) array
        The convex cell that holds each of them.
    complex : Complex
        The convex cells.
    keys : (P,) array
        Keys of its planes.
    spacing : (n,) array
        A guess of how far neighbours are [m].
    grid : Grid
        The nuclei, sorted.
    ledge : int
        The number of the surface to which ledges belong.
    """

    x: FloatArray
    home: IntArray
    complex: Complex
    keys: IntArray
    spacing: FloatArray
    grid: Grid
    ledge: int

    @classmethod
    def of(
        cls, x: FloatArray, home: IntArray, complex_: Complex, keys: IntArray, spacing: FloatArray, ledge: int
    ) -> Setting:
        """Sort the nuclei."""
        return cls(x, home, complex_, keys, spacing, grid_of(x, float(np.median(spacing))), ledge)


def plane_keys(complex_: Complex) -> IntArray:
    """A number for every plane of every cell: the same for cells on the same side of the same plane; shape (P,).

    It is even for those whose outward normal is that of the first one.
    """
    _, first, plane = np.unique(complex_.plane_id, return_index=True, return_inverse=True)
    first = first[plane.ravel()]
    along = np.einsum("pa,pa->p", complex_.normal, complex_.normal[first])
    out: IntArray = 2 * complex_.plane_id + (along < 0.0)
    return out


@njit()
def _arranged(order, count, facets, inner):  # type: ignore[no-untyped-def]
    """Facets between bodies, or those on the surface, sorted by body, what lies behind, plane, and as they come."""
    first = np.zeros(len(count) + 1, np.int64)
    last = -1
    for b in range(len(order)):
        last = max(last, order[b])
    size = np.zeros(last + 2, np.int64)
    for b in range(len(order)):
        first[b + 1] = first[b] + count[b]
        for q in range(first[b], first[b + 1]):
            if (facets[q, 0] >= 0) == inner:
                size[order[b] + 1] += 1
    for i in range(len(size) - 1):
        size[i + 1] += size[i]
    out, body = np.empty(size[-1], np.int64), np.empty(size[-1], np.int64)
    for b in range(len(order)):
        begin = size[order[b]]
        n = begin
        for q in range(first[b], first[b + 1]):
            if (facets[q, 0] >= 0) != inner:
                continue
            other, plane = facets[q, 0], facets[q, 1]
            m = n
            while m > begin:
                r = out[m - 1]
                if facets[r, 0] < other or (facets[r, 0] == other and facets[r, 1] <= plane):
                    break
                out[m] = r
                m -= 1
            out[m] = q
            body[n] = order[b]
            n += 1
    return out, body


def _sorted_by_body(order: IntArray, count: IntArray, facets: IntArray, polygons: Ragged, inner: bool) -> Facets:
    chosen, body = _arranged(order, count, facets, inner)
    taken = polygons.take(chosen)
    vector, centroid = areas_and_centroids(taken.points, taken.offsets)
    area = np.sqrt(np.einsum("qa,qa->q", vector, vector))
    return Facets(body, facets[chosen, 0], facets[chosen, 1], taken, area, centroid)


def clipped(todo: BoolArray, setting: Setting, excluded: IntArray = NONE, barred: IntArray = NONE) -> Clipped:
    """Clip some bodies.

    Parameters
    ----------
    todo : (n,) bool array
        Which ones.
    setting : Setting
        What they are clipped in.
    excluded, barred : (e,), (b,) array
        Sorted numbers ``k n + j`` of nuclei ``j`` that do not cut convex cell ``k`` although its rules admit them, and
        of those among them that may not enter it either.

    Raises
    ------
    ValueError
        Two nuclei coincide.
    """
    x, home, complex_, keys, spacing, grid, ledge = setting
    order = grid.order[todo[grid.order]]  # neighbours one after another: what they need is still at hand
    points = np.empty((45 * len(order) + 64, 3))  # numpy takes large pages for it, compiled code does not
    rules = (excluded, barred, -1 - ledge)
    table = np.concatenate([complex_.normal, complex_.offset[:, None]], axis=1)
    tables = (keys, table, np.concatenate([complex_.low, complex_.high], axis=1))
    found, n_facets, n_pieces, facets, points, cells, seen = clip_bodies(
        order, x, home, complex_, tables, spacing, grid, rules, points
    )
    offsets = np.concatenate([[0], np.cumsum(facets[:, 2])])
    polygons = Ragged(points, offsets)
    reach2 = np.zeros(len(x))
    reach2[order] = found
    pieces = np.stack([np.repeat(order, n_pieces), cells], axis=1)
    return Clipped(
        reach2,
        _sorted_by_body(order, n_facets, facets, polygons, True),
        _sorted_by_body(order, n_facets, facets, polygons, False),
        _by_body(pieces),
        _by_body(seen),
    )
