"""Convex polyhedra with three edges at every corner, bounded by planes that have identities."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import compiled_when_large, njit
from fissura.specimen.limits import IN_PLANE, NO_AREA, SHARP
from fissura.specimen.planes import Face, Planes
from fissura.specimen.polyhedron import TOO_SHORT, box, cut, following


class Degenerate(ValueError):
    """Half-spaces that enclose nothing, or nothing bounded, as far as round-off can tell."""


def area_vector(polygon: FloatArray) -> FloatArray:
    """Area times unit normal of a plane polygon (k, 3), by the order of its corners [m^2]."""
    x, y, z = (polygon[1:] - polygon[0]).T
    return 0.5 * np.array(
        [
            y[:-1] @ z[1:] - z[:-1] @ y[1:],
            z[:-1] @ x[1:] - x[:-1] @ z[1:],
            x[:-1] @ y[1:] - y[:-1] @ x[1:],
        ]
    )


def clipped(polygon: FloatArray, normal: FloatArray, offset: float, tolerance: float = 0.0) -> FloatArray | None:
    """The part of a convex polygon (k, 3) with ``normal @ x <= offset``; None where nothing is left.

    A polygon that reaches no farther than `tolerance` to the other side stays as it is; one that reaches no farther
    than that to this side is gone.
    """
    h = polygon @ normal - offset
    if h.max() <= tolerance:
        return polygon
    if h.min() >= -tolerance:
        return None
    out = []
    for k in range(len(polygon)):
        j = k + 1 if k + 1 < len(polygon) else 0
        if h[k] <= 0.0:
            out.append(polygon[k])
        if (h[k] < 0.0 < h[j]) or (h[j] < 0.0 < h[k]):
            out.append(polygon[k] + h[k] / (h[k] - h[j]) * (polygon[j] - polygon[k]))
    return np.array(out) if len(out) >= 3 else None


def clipped_by(
    polygon: FloatArray, normal: FloatArray, offset: FloatArray, tolerance: float = 0.0
) -> FloatArray | None:
    """The part of a convex polygon (k, 3) in all half-spaces with normals (f, 3) and offsets (f,), as `clipped`."""
    left: FloatArray | None = polygon
    for n, d in zip(normal, offset, strict=True):
        if left is None:
            break
        left = clipped(left, n, float(d), tolerance)
    return left


@compiled_when_large(lambda *given: len(given[3]), 5000)
@njit()
def _intersection(low, high, normal, offset, tolerance):  # type: ignore[no-untyped-def]
    """Cut a box by half-spaces one after another: number of corners, corners, half-edges and planes on their left."""
    room = 64 + 8 * len(offset)
    while True:
        p, new = np.empty((3, room)), np.empty((3, room))
        r2, s = np.empty(room), np.empty(room)
        twin, face = np.full(4 * room, -1, np.int64), np.full(4 * room, -1, np.int64)
        edges, gone = np.empty(4 * room, np.int64), np.empty(4 * room, np.int64)
        count = box(low, high, p, r2, twin, face)
        for e in range(4 * count):
            face[e] = -1 - face[e]
        left = count
        for f in range(len(offset)):
            left = cut(
                p, r2, s, twin, face, count, normal[f, 0], normal[f, 1], normal[f, 2], offset[f], tolerance, f, edges,
                gone, new,
            )  # fmt: skip
            if left == TOO_SHORT:
                break
            if left >= 0:
                count = left
            if count == 0:
                break
        if left != TOO_SHORT:
            return p[:, :count].copy(), twin[: 4 * count].copy(), face[: 4 * count].copy()
        room *= 2


@compiled_when_large(lambda *given: len(given[1]), 10_000)
@njit()
def _settle(corner, face, normal, offset, rank, nearest):  # type: ignore[no-untyped-def]
    """Put corners where their three planes meet, by the same operations in every cell that has these planes.

    Planes come in the order of `rank`; corners of planes that are almost parallel, or that would move farther than
    `nearest`, stay where they are.
    """
    f = np.empty(3, np.int64)
    n, d = np.empty((3, 3)), np.empty(3)
    for v in range(corner.shape[1]):
        for k in range(3):
            q, g = k, face[4 * v + k]
            while q > 0 and rank[f[q - 1]] > rank[g]:
                f[q] = f[q - 1]
                q -= 1
            f[q] = g
        for k in range(3):
            first = 1.0  # planes have two sides, and one of them is as good as the other
            for a in range(3):
                if normal[f[k], a] != 0.0:
                    first = 1.0 if normal[f[k], a] > 0.0 else -1.0
                    break
            for a in range(3):
                n[k, a] = first * normal[f[k], a]
            d[k] = first * offset[f[k]]
        det = 0.0
        place = np.zeros(3)
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            for a in range(3):
                b, c = (a + 1) % 3, (a + 2) % 3
                u = n[i, b] * n[j, c] - n[i, c] * n[j, b]
                place[a] += d[k] * u
                if k == 0:
                    det += n[0, a] * u
        if abs(det) < SHARP:
            continue
        off = 0.0
        for a in range(3):
            place[a] = place[a] / det + 0.0
            off = max(off, abs(place[a] - corner[a, v]))
        if off <= nearest:
            for a in range(3):
                corner[a, v] = place[a]


@compiled_when_large(lambda *given: len(given[1]), 10_000)
@njit()
def loops_of(faces, twin, face):  # type: ignore[no-untyped-def]
    """Corners around each face, counterclockwise from outside, and the face across the edge that leaves each."""
    count = len(twin) // 4
    first = np.full(faces, -1, np.int64)
    for v in range(count):
        for k in range(3):
            first[face[4 * v + k]] = 4 * v + k
    start = np.zeros(faces + 1, np.int64)
    corner, across = np.empty(3 * count, np.int64), np.empty(3 * count, np.int64)
    n = 0
    for f in range(faces):
        edge = first[f]
        while edge >= 0:
            corner[n], across[n] = edge >> 2, face[twin[edge]]
            n += 1
            edge = following(edge, twin)
            if edge == first[f]:
                break
        start[f + 1] = n
    return start, corner[:n].copy(), across[:n].copy()


@dataclass(frozen=True, eq=False)
class Convex:
    """A bounded convex polyhedron.

    Attributes
    ----------
    faces : tuple of Face
        Planes that bound it, and on which side it lies.
    corner : (3, v) array
        Corners [m].
    twin, face : (4 v,) array
        Half-edges as in `fissura.specimen.polyhedron`; `face` counts `faces`.
    """

    faces: tuple[Face, ...]
    corner: FloatArray
    twin: IntArray
    face: IntArray

    @classmethod
    def bounded(cls, faces: tuple[Face, ...], planes: Planes, low: FloatArray, high: FloatArray) -> Convex | None:
        """The intersection of half-spaces, or None where it is empty.

        Parameters
        ----------
        faces : tuple of Face
            Half-spaces; those that bound nothing are dropped.
        planes : Planes
            What their numbers mean.
        low, high : (3,) array
            Corners of a box that holds it with room to spare [m].

        Raises
        ------
        Degenerate
            The intersection reaches out of the box.
        """
        faces = tuple(dict.fromkeys(faces))
        while True:
            normal, offset = planes.half_spaces(faces)
            corner, twin, face = _intersection(low, high, normal, offset, IN_PLANE * planes.extent)
            if corner.shape[1] == 0:
                return None
            if (face.reshape(-1, 4)[:, :3] < 0).any():
                raise Degenerate("the half-spaces enclose no bounded volume")
            rank = np.array([plane for plane, _ in faces])
            _settle(corner, face, normal, offset, rank, planes.tolerance)
            out = cls(faces, corner, twin, face)
            area = np.array([np.linalg.norm(area_vector(p)) if len(p) else 0.0 for p in out.polygons])
            used = np.flatnonzero(area > NO_AREA * planes.extent**2)
            if len(used) == len(faces):
                return out
            if len(used) < 4:
                return None
            faces = tuple(faces[f] for f in used)

    @cached_property
    def loops(self) -> tuple[IntArray, IntArray, IntArray]:
        """Where the corners of each face begin, the corners, and the face across the edge that leaves each of them."""
        start, corner, across = loops_of(len(self.faces), self.twin, self.face)
        return start, corner, across

    @cached_property
    def polygons(self) -> tuple[FloatArray, ...]:
        """Faces as polygons (k, 3), counterclockwise from outside [m]."""
        start, corner, _ = self.loops
        points = self.corner.T[corner]
        return tuple(points[start[f] : start[f + 1]] for f in range(len(self.faces)))

    @cached_property
    def volume(self) -> float:
        """Volume [m^3]."""
        inner = self.corner.mean(axis=1)
        return float(sum(area_vector(p) @ (p[0] - inner) for p in self.polygons) / 3.0)

    def heights(self, normal: FloatArray, offset: float) -> FloatArray:
        """Distances of the corners in front of a plane, shape (v,) [m]."""
        out: FloatArray = normal @ self.corner - offset
        return out
