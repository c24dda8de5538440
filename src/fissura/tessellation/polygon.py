"""Compiled operations on planar convex polygons."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["areas_and_centroids", "clip", "clip_many"]


@njit(cache=True)
def clip(points, count, normal, offset, out):  # type: ignore[no-untyped-def]
    """Keep the part of a polygon with ``normal . x <= offset`` (Sutherland and Hodgman 1974); return its corners."""
    kept = 0
    for k in range(count):
        a = points[k]
        b = points[(k + 1) % count]
        da = normal[0] * a[0] + normal[1] * a[1] + normal[2] * a[2] - offset
        db = normal[0] * b[0] + normal[1] * b[1] + normal[2] * b[2] - offset
        if da <= 0.0:
            out[kept] = a
            kept += 1
        if (da < 0.0 < db) or (db < 0.0 < da):
            t = da / (da - db)
            for i in range(3):
                out[kept, i] = a[i] + t * (b[i] - a[i])
            kept += 1
    return kept if kept >= 3 else 0


@njit(cache=True)
def clip_many(points, offsets, normal, offset):  # type: ignore[no-untyped-def]
    """Keep the parts of many polygons with ``normal . x <= offset``; empty ones have no corners left."""
    q = len(offsets) - 1
    out = np.empty((len(points) + 2 * q, 3))
    new = np.zeros(q + 1, np.int64)
    n = 0
    for k in range(q):
        n += clip(points[offsets[k] : offsets[k + 1]], offsets[k + 1] - offsets[k], normal, offset, out[n:])
        new[k + 1] = n
    return out[:n].copy(), new


@njit(cache=True)
def _areas(points, offsets):  # type: ignore[no-untyped-def]
    q = len(offsets) - 1
    vector = np.zeros((q, 3))
    centroid = np.zeros((q, 3))
    for k in range(q):
        first, last = offsets[k], offsets[k + 1]
        if last - first < 3:
            continue
        origin = points[first]
        for m in range(first + 1, last - 1):
            a, b = points[m] - origin, points[m + 1] - origin
            vector[k, 0] += 0.5 * (a[1] * b[2] - a[2] * b[1])
            vector[k, 1] += 0.5 * (a[2] * b[0] - a[0] * b[2])
            vector[k, 2] += 0.5 * (a[0] * b[1] - a[1] * b[0])
        size = np.sqrt((vector[k] ** 2).sum())
        if size == 0.0:
            centroid[k] = origin
            continue
        for m in range(first + 1, last - 1):
            a, b = points[m] - origin, points[m + 1] - origin
            part = (
                0.5
                * (
                    (a[1] * b[2] - a[2] * b[1]) * vector[k, 0]
                    + (a[2] * b[0] - a[0] * b[2]) * vector[k, 1]
                    + (a[0] * b[1] - a[1] * b[0]) * vector[k, 2]
                )
                / size
            )
            for i in range(3):
                centroid[k, i] += part / size * (a[i] + b[i]) / 3.0
        centroid[k] += origin
    return vector, centroid


def areas_and_centroids(
    points: NDArray[np.float64], offsets: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Area vectors and centroids of planar polygons.

    Parameters
    ----------
    points : (p, 3) array
        Corners [m], polygon after polygon.
    offsets : (q + 1,) array
        First corner of each polygon.

    Returns
    -------
    vector : (q, 3) array
        Area times unit normal [m^2]; its sign follows the order of the corners.
    centroid : (q, 3) array
        Centroids [m].
    """
    vector, centroid = _areas(points, offsets)
    return vector, centroid
