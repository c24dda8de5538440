"""What of the surface of bodies lies under a part of the specimen's surface."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import njit
from fissura.specimen.surface_part import SurfacePart
from fissura.tessellation.limits import NOTHING, SAME_NORMAL, SAME_PLANE
from fissura.tessellation.polygon import areas_and_centroids, clip
from fissura.tessellation.tessellation import SurfaceFacets


@dataclass(frozen=True)
class Footprint:
    """Parts of facets.

    Attributes
    ----------
    facet : (k,) array
        Surface facets, ascending.
    area : (k,) array
        What of each lies under it [m^2].
    centroid : (k, 3) array
        Its centroid [m].
    """

    facet: IntArray
    area: FloatArray
    centroid: FloatArray


@njit()
def _clipped(points, offsets, normal, offset, out, out_offsets):  # type: ignore[no-untyped-def]
    """Polygons cut by half-spaces."""
    room = 0
    for q in range(len(offsets) - 1):
        room = max(room, offsets[q + 1] - offsets[q])
    a, b = np.empty((room + len(offset), 3)), np.empty((room + len(offset), 3))
    n = 0
    for q in range(len(offsets) - 1):
        count = offsets[q + 1] - offsets[q]
        for m in range(count):
            for i in range(3):
                a[m, i] = points[offsets[q] + m, i]
        for e in range(len(offset)):
            count = clip(a, count, normal[e], offset[e], b)
            a, b = b, a
            if count == 0:
                break
        for m in range(count):
            for i in range(3):
                out[n + m, i] = a[m, i]
        n += count
        out_offsets[q + 1] = n
    return n


def _edges(part: SurfacePart) -> tuple[FloatArray, FloatArray]:
    """Half-spaces beside the edges of a part, (e, 3) and (e,)."""
    normal = np.cross(np.roll(part.polygon, -1, axis=0) - part.polygon, part.normal)
    return normal, np.einsum("ea,ea->e", normal, part.polygon)


def footprint(surface: SurfaceFacets, parts: Sequence[SurfacePart]) -> Footprint:
    """Parts of surface facets under flat convex parts of the specimen's surface.

    Parameters
    ----------
    surface : SurfaceFacets
        With their polygons.
    parts : sequence of SurfacePart
        They do not overlap.
    """
    shapes = surface.polygons
    area, moment = np.zeros(len(surface)), np.zeros((len(surface), 3))
    first = shapes.points[shapes.offsets[:-1]]
    for part in parts:
        reach = float(np.linalg.norm(np.ptp(part.polygon, axis=0)))
        flat = surface.normal[shapes.facet] @ part.normal > 1.0 - SAME_NORMAL
        flat &= np.abs((first - part.polygon[0]) @ part.normal) < SAME_PLANE * reach
        chosen = np.flatnonzero(flat)
        if not len(chosen):
            continue
        count = np.diff(shapes.offsets)[chosen]
        offsets = np.concatenate([[0], np.cumsum(count)])
        rows = np.repeat(shapes.offsets[chosen] - offsets[:-1], count) + np.arange(offsets[-1])
        normal, offset = _edges(part)
        out = np.empty((int(offsets[-1]) + len(chosen) * len(offset), 3))
        ends = np.zeros(len(chosen) + 1, dtype=np.int64)
        n = _clipped(shapes.points[rows], offsets, normal, offset, out, ends)
        vector, centroid = areas_and_centroids(out[:n], ends)
        size = np.abs(vector @ part.normal)
        np.add.at(area, shapes.facet[chosen], size)
        np.add.at(moment, shapes.facet[chosen], size[:, None] * centroid)
    facet = np.flatnonzero(area > NOTHING * surface.area)
    return Footprint(facet, area[facet], moment[facet] / area[facet, None])
