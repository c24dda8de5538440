"""Compiled sums over polygons, facets and bodies."""

from typing import NamedTuple

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import njit
from fissura.specimen.complex import Complex
from fissura.specimen.polyhedron import following
from fissura.tessellation.clipped import Facets
from fissura.tessellation.ragged import Ragged


@njit()
def _joined(body, other, plane, size, centroid, smallest):  # type: ignore[no-untyped-def]
    """Polygons that are large enough, the facet of each, the first polygon of each facet, and sums over facets."""
    chosen, facet = np.empty(len(body), np.int64), np.empty(len(body), np.int64)
    first, area, centre = np.empty(len(body), np.int64), np.zeros(len(body)), np.zeros((len(body), 3))
    n, m = 0, -1
    for q in range(len(body)):
        if not size[q] > smallest:
            continue
        if m < 0 or body[q] != body[first[m]] or other[q] != other[first[m]] or plane[q] != plane[first[m]]:
            m += 1
            first[m] = q
        chosen[n], facet[n] = q, m
        n += 1
        area[m] += size[q]
        for a in range(3):
            centre[m, a] += size[q] * centroid[q, a]
    m += 1
    for k in range(m):
        for a in range(3):
            centre[k, a] /= area[k]
    return chosen[:n], facet[:n], first[:m], area[:m], centre[:m]


class Joined(NamedTuple):
    """Facets, each of one or several polygons.

    Attributes
    ----------
    polygons : Ragged
        The polygons that are large enough.
    facet : (q,) array
        The facet of each, ascending.
    first : (m,) array
        The number, among all polygons given, of the first one of each facet.
    area, centroid : (m,), (m, 3) array
        Areas [m^2] and centroids [m] of facets.
    """

    polygons: Ragged
    facet: IntArray
    first: IntArray
    area: FloatArray
    centroid: FloatArray


def joined(facets: Facets, smallest: float) -> Joined:
    """Facets of polygons with the same body, neighbour and plane.

    Parameters
    ----------
    facets : Facets
        The polygons, sorted.
    smallest : float
        Area up to which a polygon exists by round-off only [m^2].
    """
    polygons, size, centroid = facets.polygons, facets.area, facets.centroid
    keys = (facets.body, facets.other, facets.plane)
    chosen, facet, first, area, centre = _joined(*keys, size, centroid, smallest)
    if len(first) == len(polygons):  # as they were
        return Joined(polygons, facet, first, size, centroid)
    if len(chosen) < len(polygons):
        polygons = polygons.take(chosen)
    return Joined(polygons, facet, first, area, centre)


@njit()
def _lines(x, bodies):  # type: ignore[no-untyped-def]
    direction = np.empty((len(bodies), 3))
    length = np.empty(len(bodies))
    for k in range(len(bodies)):
        i, j = bodies[k, 0], bodies[k, 1]
        d0, d1, d2 = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
        length[k] = np.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
        direction[k, 0], direction[k, 1], direction[k, 2] = d0 / length[k], d1 / length[k], d2 / length[k]
    return direction, length


def lines(x: FloatArray, bodies: IntArray) -> tuple[FloatArray, FloatArray]:
    """Unit directions (m, 3) and lengths (m,) of the lines between pairs of nuclei."""
    direction, length = _lines(x, bodies)
    return direction, length


@njit()
def _volumes(x, bodies, area, length, body, skin_area, centroid, normal):  # type: ignore[no-untyped-def]
    out = np.zeros(len(x))
    for k in range(len(bodies)):
        cone = area[k] * length[k] / 6.0
        out[bodies[k, 0]] += cone
        out[bodies[k, 1]] += cone
    for k in range(len(body)):
        height = 0.0
        for a in range(3):
            height += normal[k, a] * (centroid[k, a] - x[body[k], a])
        out[body[k]] += skin_area[k] * height / 3.0
    return out


def volumes(
    x: FloatArray,
    bodies: IntArray,
    area: FloatArray,
    length: FloatArray,
    body: IntArray,
    skin_area: FloatArray,
    centroid: FloatArray,
    normal: FloatArray,
) -> FloatArray:
    """Volumes of bodies as sums of the cones from their nuclei to contacts and to surface facets; shape (n,)."""
    return np.asarray(_volumes(x, bodies, area, length, body, skin_area, centroid, normal))


@njit()
def _volume_of(corner_start, corner, twin, face, plane_start, normal, offset):  # type: ignore[no-untyped-def]
    total = 0.0
    for k in range(len(corner_start) - 1):
        first, count = corner_start[k], corner_start[k + 1] - corner_start[k]
        at = np.full(plane_start[k + 1] - plane_start[k], -1)
        for v in range(count):
            for m in range(3):
                at[face[4 * (first + v) + m]] = 4 * v + m
        for f in range(len(at)):
            if at[f] < 0:
                continue
            n, edge = normal[plane_start[k] + f], at[f]
            height = offset[plane_start[k] + f]
            for a in range(3):
                height -= n[a] * corner[a, first]
            begin = first + (edge >> 2)
            twice = 0.0  # the area
            while True:
                after = following(edge, twin[4 * first : 4 * (first + count)])
                u, w = first + (edge >> 2), first + (after >> 2)
                for a in range(3):
                    b, c = (a + 1) % 3, (a + 2) % 3
                    twice += n[a] * (corner[b, u] - corner[b, begin]) * (corner[c, w] - corner[c, begin])
                    twice -= n[a] * (corner[c, u] - corner[c, begin]) * (corner[b, w] - corner[b, begin])
                edge = after
                if edge == at[f]:
                    break
            total += abs(twice) * height / 6.0
    return total


def volume_of(complex_: Complex) -> float:
    """Volume of a complex [m^3]."""
    c = complex_
    return float(_volume_of(c.corner_start, c.corner, c.twin, c.face, c.plane_start, c.normal, c.offset))
