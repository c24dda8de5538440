"""Voronoi cells of nuclei in a box, cut off exactly by its faces."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Voronoi

__all__ = ["Cells", "Ragged", "voronoi_cells"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_FIRST_MARGIN = 1.25  # nuclei closer to a face than this many spacings are reflected at the first try


@dataclass(frozen=True)
class Ragged:
    """Polygons with an owner each: the working form of facets while notches cut them.

    Attributes
    ----------
    points : (p, 3) array
        Corners [m].
    offsets : (q + 1,) array
        First corner of each polygon.
    owner : (q,) array
        Facet to which each polygon belongs.
    """

    points: FloatArray
    offsets: IntArray
    owner: IntArray

    def __len__(self) -> int:
        return len(self.owner)

    def take(self, chosen: IntArray) -> Ragged:
        """The chosen polygons, in that order."""
        counts = np.diff(self.offsets)[chosen]
        offsets = np.concatenate([[0], np.cumsum(counts)])
        source = np.repeat(self.offsets[chosen] - offsets[:-1], counts) + np.arange(offsets[-1])
        return Ragged(self.points[source], offsets, self.owner[chosen])

    def joined(self, *others: Ragged) -> Ragged:
        """These polygons and others, sorted by owner; empty ones are dropped."""
        parts = (self, *others)
        counts = np.concatenate([np.diff(p.offsets) for p in parts])
        whole = Ragged(
            np.concatenate([p.points for p in parts]),
            np.concatenate([[0], np.cumsum(counts)]),
            np.concatenate([p.owner for p in parts]),
        )
        order = np.argsort(whole.owner, kind="stable")
        return whole.take(order[counts[order] > 0])

    def extremes(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Smallest and largest of a value given at every corner, for each polygon."""
        start = self.offsets[:-1]
        return np.minimum.reduceat(values, start), np.maximum.reduceat(values, start)


@dataclass(frozen=True)
class Cells:
    """Voronoi cells of a box before any notch is cut.

    Attributes
    ----------
    pairs : (m, 2) array
        Neighbouring cells ``i < j``.
    facets : Ragged
        Their common facets; ``owner`` is the row of `pairs`.
    surface_body, surface_face : (b,) array
        Cell and face (2 axis + side) of every facet on the box's surface.
    surface : Ragged
        These facets; ``owner`` is their row.
    """

    pairs: IntArray
    facets: Ragged
    surface_body: IntArray
    surface_face: IntArray
    surface: Ragged


def _ragged(lists: list[list[int]], vertices: FloatArray) -> Ragged:
    counts = np.fromiter(map(len, lists), np.int64, len(lists))
    flat = np.fromiter(chain.from_iterable(lists), np.int64, int(counts.sum()))
    return Ragged(vertices[flat], np.concatenate([[0], np.cumsum(counts)]), np.arange(len(lists)))


def voronoi_cells(x: FloatArray, size: tuple[float, float, float], spacing: FloatArray) -> Cells:
    """Voronoi cells of nuclei in a box.

    Reflecting the nuclei near a face in that face makes it a boundary of cells. Whether enough were reflected is
    checked, not assumed: no cell may reach beyond the box; where one does, its nucleus is reflected too.

    Parameters
    ----------
    x : (n, 3) array
        Nuclei [m].
    size : tuple of float
        Dimensions of the box [m].
    spacing : (n,) array
        Local spacing [m], to guess which cells reach the surface.
    """
    n = len(x)
    extent = np.asarray(size)
    distance = np.concatenate([x, extent - x], axis=1)  # (n, 6): lower faces, then upper faces
    reflect = distance < _FIRST_MARGIN * spacing[:, None]
    tolerance = 1e-9 * extent.max()
    while True:
        images, sources, faces = [x], [np.arange(n)], [np.full(n, -1)]
        for face in range(6):
            axis, side = face % 3, face // 3
            chosen = np.flatnonzero(reflect[:, face])
            image = x[chosen].copy()
            image[:, axis] = 2.0 * side * size[axis] - image[:, axis]
            images.append(image)
            sources.append(chosen)
            faces.append(np.full(len(chosen), 2 * axis + side))
        source, face_of = np.concatenate(sources), np.concatenate(faces)
        diagram = Voronoi(np.concatenate(images))
        ends = diagram.ridge_points.astype(np.int64)
        own = np.flatnonzero((ends < n).any(axis=1))
        lists = [diagram.ridge_vertices[k] for k in own]
        ends = ends[own]
        ends = np.where((ends[:, 0] < n)[:, None], ends, ends[:, ::-1])
        polygons = _ragged(lists, diagram.vertices)
        corner_cell = np.repeat(ends[:, 0], np.diff(polygons.offsets))
        other = np.repeat(ends[:, 1], np.diff(polygons.offsets))
        unbounded = np.repeat([min(v) < 0 for v in lists], np.diff(polygons.offsets))
        beyond = np.concatenate([polygons.points < -tolerance, polygons.points > extent + tolerance], axis=1)
        beyond |= unbounded[:, None]
        missing = np.zeros_like(reflect)
        for end in (corner_cell, np.where(other < n, other, corner_cell)):
            rows, columns = np.nonzero(beyond)
            missing[end[rows], columns] = True
        missing &= ~reflect
        if not missing.any():
            break
        reflect |= missing

    inner = ends[:, 1] < n
    surface = ~inner & (source[ends[:, 1]] == ends[:, 0])
    pairs = np.sort(ends[inner], axis=1)
    facets = polygons.take(np.flatnonzero(inner))
    outer = polygons.take(np.flatnonzero(surface))
    face = face_of[ends[surface, 1]]
    # Corners on the box's faces sit exactly there.
    points = np.clip(outer.points, 0.0, extent)
    corner_face = np.repeat(face, np.diff(outer.offsets))
    points[np.arange(len(points)), corner_face // 2] = (extent[corner_face // 2]) * (corner_face % 2)
    return Cells(
        pairs,
        Ragged(np.clip(facets.points, 0.0, extent), facets.offsets, np.arange(len(facets))),
        ends[surface, 0],
        face,
        Ragged(points, outer.offsets, np.arange(len(outer))),
    )
