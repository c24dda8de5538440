"""Compiled operations on planar convex polygons."""

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import INNER, njit


@njit(**INNER)
def clip(points, count, normal, offset, out):  # type: ignore[no-untyped-def]
    """Keep the part of a polygon with ``normal . x <= offset`` (Sutherland and Hodgman 1974); return its corners."""
    kept = 0
    for k in range(count):
        j = k + 1 if k + 1 < count else 0
        da = normal[0] * points[k, 0] + normal[1] * points[k, 1] + normal[2] * points[k, 2] - offset
        db = normal[0] * points[j, 0] + normal[1] * points[j, 1] + normal[2] * points[j, 2] - offset
        if da <= 0.0:
            for i in range(3):
                out[kept, i] = points[k, i]
            kept += 1
        if (da < 0.0 < db) or (db < 0.0 < da):
            t = da / (da - db)
            for i in range(3):
                out[kept, i] = points[k, i] + t * (points[j, i] - points[k, i])
            kept += 1
    return kept if kept >= 3 else 0


@njit(**INNER)
def area2(points, count):  # type: ignore[no-untyped-def]
    """Squared area of a polygon."""
    o0, o1, o2 = points[0, 0], points[0, 1], points[0, 2]
    v0 = v1 = v2 = 0.0
    a0, a1, a2 = points[1, 0] - o0, points[1, 1] - o1, points[1, 2] - o2
    for m in range(2, count):
        b0, b1, b2 = points[m, 0] - o0, points[m, 1] - o1, points[m, 2] - o2
        v0 += 0.5 * (a1 * b2 - a2 * b1)
        v1 += 0.5 * (a2 * b0 - a0 * b2)
        v2 += 0.5 * (a0 * b1 - a1 * b0)
        a0, a1, a2 = b0, b1, b2
    return v0 * v0 + v1 * v1 + v2 * v2


@njit()
def _areas(points, offsets):  # type: ignore[no-untyped-def]
    q = len(offsets) - 1
    vector = np.zeros((q, 3))
    centroid = np.zeros((q, 3))
    for k in range(q):
        first, last = offsets[k], offsets[k + 1]
        if last - first < 3:
            continue
        o0, o1, o2 = points[first, 0], points[first, 1], points[first, 2]
        v0, v1, v2 = 0.0, 0.0, 0.0
        a0, a1, a2 = points[first + 1, 0] - o0, points[first + 1, 1] - o1, points[first + 1, 2] - o2
        for m in range(first + 2, last):
            b0, b1, b2 = points[m, 0] - o0, points[m, 1] - o1, points[m, 2] - o2
            v0 += 0.5 * (a1 * b2 - a2 * b1)
            v1 += 0.5 * (a2 * b0 - a0 * b2)
            v2 += 0.5 * (a0 * b1 - a1 * b0)
            a0, a1, a2 = b0, b1, b2
        size2 = v0 * v0 + v1 * v1 + v2 * v2
        c0, c1, c2 = 0.0, 0.0, 0.0
        if size2 > 0.0:
            # Triangles count by their part of the area.
            a0, a1, a2 = points[first + 1, 0] - o0, points[first + 1, 1] - o1, points[first + 1, 2] - o2
            for m in range(first + 2, last):
                b0, b1, b2 = points[m, 0] - o0, points[m, 1] - o1, points[m, 2] - o2
                part = 0.5 * ((a1 * b2 - a2 * b1) * v0 + (a2 * b0 - a0 * b2) * v1 + (a0 * b1 - a1 * b0) * v2)
                part /= 3.0 * size2
                c0 += part * (a0 + b0)
                c1 += part * (a1 + b1)
                c2 += part * (a2 + b2)
                a0, a1, a2 = b0, b1, b2
        vector[k, 0], vector[k, 1], vector[k, 2] = v0, v1, v2
        centroid[k, 0], centroid[k, 1], centroid[k, 2] = o0 + c0, o1 + c1, o2 + c2
    return vector, centroid


def areas_and_centroids(points: FloatArray, offsets: IntArray) -> tuple[FloatArray, FloatArray]:
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
