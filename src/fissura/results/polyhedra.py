"""Bodies as polyhedra, gathered from the polygons of their contacts and surface facets."""

from dataclasses import dataclass

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.kernels import INNER, njit
from fissura.tessellation.tessellation import Polygons, Tessellation

MERGE = 1e-6
"""Corners of one body closer than this part of its size (cube root of the volume) are one point."""


@dataclass(frozen=True)
class Polyhedra:
    """Closed polyhedra that share no points with each other.

    Attributes
    ----------
    points : (p, 3) array
        Corners [m], those of one body after those of another.
    point_body : (p,) array
        Body of each corner, ascending.
    corners : (c,) array
        Indices into ``points``: the faces' corners, counter-clockwise as seen from outside.
    face_offsets : (f + 1,) array
        Corners of face ``k`` are ``corners[face_offsets[k]:face_offsets[k + 1]]``.
    face_body : (f,) array
        Body of each face, ascending.
    """

    points: FloatArray
    point_body: IntArray
    corners: IntArray
    face_offsets: IntArray
    face_body: IntArray


def polygon_normals(polygons: Polygons) -> FloatArray:
    """Normals of polygons by Newell's formula, as long as twice the polygon's area.

    Returns
    -------
    (q, 3) array
        Right-handed about the order of the corners [m^2].
    """
    if len(polygons) == 0:
        return np.zeros((0, 3))
    start = polygons.offsets[:-1]
    size = np.diff(polygons.offsets)
    local = polygons.points - np.repeat(polygons.points[start], size, axis=0)
    following = np.arange(len(local)) + 1
    following[polygons.offsets[1:] - 1] = start
    normals: FloatArray = np.add.reduceat(np.cross(local, local[following]), start, axis=0)
    return normals


def polyhedra(tessellation: Tessellation) -> Polyhedra:
    """Polyhedron of every body.

    Faces point outwards whatever the order of the corners in the tessellation. A facet of several
    polygons gives several faces. Nothing is merged between bodies, so that each can move on its own.

    Returns
    -------
    Polyhedra
        Of all ``n`` bodies.
    """
    contacts, surface = tessellation.contacts, tessellation.surface
    inner, outer = contacts.polygons, surface.polygons
    aligned = np.einsum("qc,qc->q", polygon_normals(inner), contacts.normal[inner.facet]) >= 0
    outward = np.einsum("qc,qc->q", polygon_normals(outer), surface.normal[outer.facet]) >= 0
    points = np.concatenate([inner.points, outer.points])
    start = np.concatenate([inner.offsets[:-1], outer.offsets[:-1] + len(inner.points)])
    size = np.concatenate([np.diff(inner.offsets), np.diff(outer.offsets)])

    # Every contact polygon bounds two bodies and is turned round for one of them.
    n_inner, n_outer = len(inner), len(outer)
    polygon = np.concatenate([np.arange(n_inner), np.arange(n_inner), n_inner + np.arange(n_outer)])
    body = np.concatenate([contacts.bodies[inner.facet, 0], contacts.bodies[inner.facet, 1], surface.body[outer.facet]])
    forward = np.concatenate([aligned, ~aligned, outward])
    order = np.argsort(body, kind="stable")
    polygon, body, forward = polygon[order], body[order], forward[order]

    sizes = size[polygon]
    face = np.repeat(np.arange(len(polygon)), sizes)
    rank = np.arange(len(face)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    rank = np.where(forward[face], rank, sizes[face] - 1 - rank)
    corner = start[polygon][face] + rank
    index, first = _merged(points[corner], body[face], tessellation.volume)
    kept = _kept(index, face, len(polygon))
    counts = np.bincount(face[kept], minlength=len(polygon))
    whole = counts > 0
    return Polyhedra(
        points=points[corner][first],
        point_body=body[face][first],
        corners=index[kept],
        face_offsets=np.concatenate([[0], np.cumsum(counts[whole])]),
        face_body=body[whole],
    )


def _merged(points: FloatArray, body: IntArray, volume: FloatArray) -> tuple[IntArray, IntArray]:
    """Index of the merged point of every corner, and one corner of each merged point; bodies ascend.

    Along each axis the coordinates of a body are sorted and cut into groups wherever two successive ones
    are farther apart than the tolerance. Unlike rounding, this never parts two that are almost equal.
    """
    bounds = np.searchsorted(body, np.arange(len(volume) + 1))
    index, first = np.empty(len(points), dtype=np.int64), np.empty(len(points), dtype=np.int64)
    count = _merge(points, bounds, MERGE * np.cbrt(volume), index, first)
    return index, first[:count]


@njit(**INNER)
def _sort(values, n, order):  # type: ignore[no-untyped-def]
    """Order in which `n` values ascend (Shell 1959; there are some dozens)."""
    for k in range(n):
        order[k] = k
    for gap in (701, 301, 132, 57, 23, 10, 4, 1):
        for m in range(gap, n):
            k, q = order[m], m
            while q >= gap and values[order[q - gap]] > values[k]:
                order[q] = order[q - gap]
                q -= gap
            order[q] = k


@njit()
def _merge(points, bounds, tolerance, index, first):  # type: ignore[no-untyped-def]
    most = 0
    for body in range(len(tolerance)):
        most = max(most, bounds[body + 1] - bounds[body])
    label, values, order = np.empty(most), np.empty(most), np.empty(most, dtype=np.int64)
    count = 0
    for body in range(len(tolerance)):
        low, high = bounds[body], bounds[body + 1]
        n = high - low
        for k in range(n):
            label[k] = 0.0
        for axis in range(3):
            for k in range(n):
                values[k] = points[low + k, axis]
            _sort(values, n, order)
            group = 0
            for k in range(n):
                if k > 0 and points[low + order[k], axis] - points[low + order[k - 1], axis] > tolerance[body]:
                    group += 1
                # n groups at most along each axis, so that three of them make one number.
                label[order[k]] += group * n ** (2 - axis)
        _sort(label, n, order)
        for k in range(n):
            corner = low + order[k]
            if k == 0 or label[order[k]] != label[order[k - 1]]:
                first[count] = corner
                count += 1
            elif corner < first[count - 1]:
                first[count - 1] = corner
            index[corner] = count - 1
    return count


def _kept(index: IntArray, face: IntArray, faces: int) -> BoolArray:
    """Corners to keep: no repeated neighbours within a face, no faces of fewer than three corners."""
    size = np.bincount(face, minlength=faces)
    last = np.cumsum(size) - 1
    following = np.arange(len(index)) + 1
    following[last[size > 0]] = (last - size + 1)[size > 0]
    kept = index != index[following]
    enough = np.bincount(face[kept], minlength=faces) >= 3
    keep: BoolArray = kept & enough[face]
    return keep
