"""Compiled sums over polygons, facets and bodies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fissura.kernels import njit
from fissura.tessellation.polygon import areas_and_centroids
from fissura.tessellation.ragged import Ragged

__all__ = ["facet_sums", "lines", "polygon_measures", "volumes"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def polygon_measures(polygons: Ragged) -> tuple[FloatArray, FloatArray]:
    """Areas (q,) and centroids (q, 3) of polygons."""
    vector, centroid = areas_and_centroids(polygons.points, polygons.offsets)
    return np.sqrt(np.einsum("qa,qa->q", vector, vector)), centroid


@njit(cache=True)
def _facet_sums(owner, size, centroid, gone, p_owner, p_size, p_centroid, count, smallest):  # type: ignore[no-untyped-def]
    """Polygons that are left, by owner (pieces are counted on), and sums over them."""
    chosen = np.empty(len(owner) + len(p_owner), np.int64)
    area = np.zeros(count)
    centre = np.zeros((count, 3))
    n, k, m = 0, 0, 0
    while k < len(owner) or m < len(p_owner):
        if m == len(p_owner) or (k < len(owner) and owner[k] <= p_owner[m]):
            if not gone[k] and size[k] > smallest:
                chosen[n] = k
                n += 1
                area[owner[k]] += size[k]
                for a in range(3):
                    centre[owner[k], a] += size[k] * centroid[k, a]
            k += 1
        else:
            if p_size[m] > smallest:
                chosen[n] = len(owner) + m
                n += 1
                area[p_owner[m]] += p_size[m]
                for a in range(3):
                    centre[p_owner[m], a] += p_size[m] * p_centroid[m, a]
            m += 1
    for f in range(count):
        if area[f] > 0.0:
            for a in range(3):
                centre[f, a] /= area[f]
    return chosen[:n], area, centre


def facet_sums(
    polygons: Ragged,
    size: FloatArray,
    centroid: FloatArray,
    gone: NDArray[np.bool_],
    pieces: Ragged,
    count: int,
    smallest: float,
) -> tuple[Ragged, FloatArray, FloatArray]:
    """Facets of which notches left only pieces; those too small are dropped.

    Parameters
    ----------
    polygons : Ragged
        All polygons before notches were cut, sorted by owner.
    size, centroid : (q,), (q, 3) array
        Their areas [m^2] and centroids [m].
    gone : (q,) bool array
        Which of them `pieces` replace.
    pieces : Ragged
        What is left of these, sorted by owner.
    count : int
        Number of owners.
    smallest : float
        Area up to which a polygon exists by round-off only [m^2].

    Returns
    -------
    polygons : Ragged
        The polygons that are left.
    area, centroid : (count,), (count, 3) array
        Areas and centroids of owners, over their polygons.
    """
    if not len(pieces) and not gone.any() and (size > smallest).all():
        return polygons, size, centroid
    of_pieces = (pieces.owner, *polygon_measures(pieces))
    chosen, area, centre = _facet_sums(polygons.owner, size, centroid, gone, *of_pieces, count, smallest)
    return polygons.picked(pieces, chosen), area, centre


@njit(cache=True)
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


@njit(cache=True)
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
