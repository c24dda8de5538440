"""Voronoi cells of nuclei in a box, cut off exactly by its faces; cells that cannot have changed are kept."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fissura.kernels import njit
from fissura.tessellation.cell import clip_cells
from fissura.tessellation.grid import grid_of, within
from fissura.tessellation.measures import polygon_measures
from fissura.tessellation.ragged import Ragged

__all__ = ["Cells", "voronoi_cells"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class Cells:
    """Voronoi cells of a box before any notch is cut.

    Attributes
    ----------
    x : (n, 3) array
        Nuclei [m].
    nucleus : (n,) array
        Identities of the nuclei, ascending.
    size : tuple of float
        Dimensions of the box [m].
    reach2 : (n,) array
        Squared distance [m^2] beyond which nuclei have no influence on a cell.
    pairs : (m, 2) array
        Neighbouring cells ``i < j``, sorted.
    facets : Ragged
        Their common facets; ``owner`` is the row of `pairs`.
    area, centroid : (m,), (m, 3) array
        Their areas [m^2] and centroids [m].
    surface_body, surface_face : (b,) array
        Cell and face (2 axis + side) of every facet on the box's surface, sorted.
    surface : Ragged
        These facets; ``owner`` is their row.
    surface_area, surface_centroid : (b,), (b, 3) array
        Their areas [m^2] and centroids [m].
    """

    x: FloatArray
    nucleus: IntArray
    size: tuple[float, float, float]
    reach2: FloatArray
    pairs: IntArray
    facets: Ragged
    area: FloatArray
    centroid: FloatArray
    surface_body: IntArray
    surface_face: IntArray
    surface: Ragged
    surface_area: FloatArray
    surface_centroid: FloatArray


@dataclass(frozen=True)
class _Facets:
    """Facets with the cell that they were taken from, and what lies behind them: a cell, or a face less 6."""

    cell: IntArray
    other: IntArray
    polygons: Ragged
    area: FloatArray
    centroid: FloatArray

    def take(self, chosen: IntArray) -> _Facets:
        polygons = self.polygons.take(chosen)
        return _Facets(self.cell[chosen], self.other[chosen], polygons, self.area[chosen], self.centroid[chosen])

    def merged(self, stay: BoolArray, number: IntArray, new: _Facets) -> _Facets:
        """Those of cells that stay, numbered anew, and new ones; both are sorted by cell, and so is the result."""
        ours = (self.cell, self.other, self.area, self.centroid)
        cell, other, area, centroid, chosen = _merged(*ours, stay, number, new.cell, new.other, new.area, new.centroid)
        return _Facets(cell, other, self.polygons.picked(new.polygons, chosen), area, centroid)


@njit(cache=True)
def _merged(  # type: ignore[no-untyped-def]
    cell, other, area, centroid, stay, number, new_cell, new_other, new_area, new_centroid
):
    most = len(cell) + len(new_cell)
    out_cell, out_other, chosen = np.empty(most, np.int64), np.empty(most, np.int64), np.empty(most, np.int64)
    out_area, out_centroid = np.empty(most), np.empty((most, 3))
    n, k, m = 0, 0, 0
    while k < len(cell) or m < len(new_cell):
        if k < len(cell) and not stay[cell[k]]:
            k += 1
            continue
        if m == len(new_cell) or (k < len(cell) and number[cell[k]] < new_cell[m]):
            out_cell[n] = number[cell[k]]
            out_other[n] = number[other[k]] if other[k] >= 0 else other[k]
            out_area[n] = area[k]
            for a in range(3):
                out_centroid[n, a] = centroid[k, a]
            chosen[n] = k
            k += 1
        else:
            out_cell[n] = new_cell[m]
            out_other[n] = new_other[m]
            out_area[n] = new_area[m]
            for a in range(3):
                out_centroid[n, a] = new_centroid[m, a]
            chosen[n] = len(cell) + m
            m += 1
        n += 1
    return out_cell[:n], out_other[:n], out_area[:n], out_centroid[:n], chosen[:n]


def _clipped(
    todo: BoolArray, x: FloatArray, size: FloatArray, spacing: FloatArray
) -> tuple[FloatArray, _Facets, _Facets]:
    """Reach and facets of some cells: those between cells, and those on the surface."""
    grid = grid_of(x, float(np.median(spacing)))
    order = grid.order[todo[grid.order]]  # neighbours one after another: what they need is still at hand
    points = np.empty((45 * len(order) + 64, 3))  # numpy takes large pages for it, compiled code does not
    reach2, count, other, corners, points = clip_cells(order, x, size, spacing, grid, points)
    polygons = Ragged(points, np.concatenate([[0], np.cumsum(corners)]), np.arange(len(corners)))
    out = np.empty(len(x))
    out[order] = reach2
    found = _Facets(np.repeat(order, count), other, polygons, *polygon_measures(polygons))
    sorting = np.argsort(found.cell, kind="stable")
    inner = other[sorting] >= 0
    return out, found.take(sorting[inner]), found.take(sorting[~inner])


def _unchanged(x: FloatArray, nucleus: IntArray, previous: Cells) -> tuple[IntArray, BoolArray]:
    """New number of every previous cell, -1 for none, and which of them no change has any influence on."""
    number = np.full(max(nucleus[-1], previous.nucleus[-1]) + 1, -1)
    number[nucleus] = np.arange(len(nucleus))
    number = number[previous.nucleus]
    stay = number >= 0
    assert np.array_equal(x[number[stay]], previous.x[stay])
    came = np.ones(len(x), np.bool_)
    came[number[stay]] = False
    changed = np.concatenate([x[came], previous.x[~stay]])
    if len(changed):
        stay &= ~within(previous.x, previous.reach2, grid_of(changed, 0.0))
    return number, stay


def voronoi_cells(
    x: FloatArray,
    size: tuple[float, float, float],
    spacing: FloatArray,
    nucleus: IntArray | None = None,
    previous: Cells | None = None,
) -> Cells:
    """Voronoi cells of nuclei in a box.

    Parameters
    ----------
    x : (n, 3) array
        Nuclei [m], all different.
    size : tuple of float
        Dimensions of the box [m].
    spacing : (n,) array
        Local spacing [m], a guess of how far neighbours are; it has no influence on the result.
    nucleus : (n,) array, optional
        Identities of the nuclei, ascending; by default their indices.
    previous : Cells, optional
        Cells of other nuclei in the same box, those of the same identity at the same place. The cells on which no
        nucleus that came or went has any influence are taken from there; the result is the same, bit for bit.

    Raises
    ------
    ValueError
        Two nuclei coincide.
    """
    x = np.ascontiguousarray(x)
    nucleus = np.arange(len(x)) if nucleus is None else nucleus
    extent = np.asarray(size, float)
    todo = np.ones(len(x), np.bool_)
    if previous is None:
        reach2, inner, outer = _clipped(todo, x, extent, spacing)
    else:
        assert previous.size == size
        number, stay = _unchanged(x, nucleus, previous)
        todo[number[stay]] = False
        reach2, new_inner, new_outer = _clipped(todo, x, extent, spacing)
        reach2[number[stay]] = previous.reach2[stay]
        old_inner = (previous.pairs[:, 0].copy(), previous.pairs[:, 1].copy(), previous.facets)
        inner = _Facets(*old_inner, previous.area, previous.centroid).merged(stay, number, new_inner)
        old_outer = (previous.surface_body, previous.surface_face - 6, previous.surface)
        outer = _Facets(*old_outer, previous.surface_area, previous.surface_centroid)
        outer = outer.merged(stay, number, new_outer)
    return Cells(
        x,
        nucleus,
        size,
        reach2,
        np.stack([inner.cell, inner.other], axis=1),
        replace(inner.polygons, owner=np.arange(len(inner.cell))),
        inner.area,
        inner.centroid,
        outer.cell,
        outer.other + 6,
        replace(outer.polygons, owner=np.arange(len(outer.cell))),
        outer.area,
        outer.centroid,
    )
