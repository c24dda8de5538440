"""Convex polygons in one plane, whose edges lie on lines that have identities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np

from fissura.arrays import FloatArray

#: A line, and the side of it, +1 or -1, to which the outward normal points.
Edge: TypeAlias = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Flat:
    """Coordinates in a plane.

    Attributes
    ----------
    origin : (3,) array
        A point of the plane [m].
    axes : (2, 3) array
        Unit vectors in it, counterclockwise seen from where its normal points.
    """

    origin: FloatArray
    axes: FloatArray

    @classmethod
    def of(cls, normal: FloatArray, points: FloatArray) -> Flat:
        """The plane with the given unit normal, near points (k, 3)."""
        first = np.eye(3)[int(np.argmin(np.abs(normal)))]
        u = first - (first @ normal) * normal
        u /= np.linalg.norm(u)
        return cls(points.mean(axis=0), np.array([u, np.cross(normal, u)]))

    def inside(self, points: FloatArray) -> FloatArray:
        """Coordinates in the plane, (k, 3) -> (k, 2)."""
        out: FloatArray = (points - self.origin) @ self.axes.T
        return out

    def outside(self, points: FloatArray) -> FloatArray:
        """Points in space, (k, 2) -> (k, 3)."""
        out: FloatArray = self.origin + points @ self.axes
        return out

    def half_space(self, normal: FloatArray, offset: float) -> tuple[FloatArray, float]:
        """The half-space that meets the plane in the half-plane ``normal @ x <= offset``."""
        out = normal @ self.axes
        return out, offset + float(out @ self.origin)


@dataclass(frozen=True, eq=False)
class Piece:
    """A convex polygon, counterclockwise.

    Attributes
    ----------
    corners : (k, 2) array
        Corners [m].
    edges : tuple of Edge
        The line from each corner to the next.
    """

    corners: FloatArray
    edges: tuple[Edge, ...]

    @cached_property
    def bounds(self) -> FloatArray:
        """Lowest and highest coordinates, shape (4,) [m]."""
        return np.concatenate([self.corners.min(axis=0), self.corners.max(axis=0)])

    def among(self, bounds: FloatArray, tolerance: float) -> list[int]:
        """Which rectangles (k, 4) overlap that around the polygon by more than a length."""
        low = np.maximum(bounds[:, :2], self.bounds[:2])
        high = np.minimum(bounds[:, 2:], self.bounds[2:])
        return [int(k) for k in np.flatnonzero((high - low > tolerance).all(axis=1))]


class Lines:
    """Lines in a plane, each known by a number.

    Parameters
    ----------
    tolerance : float
        Length that is round-off [m].
    """

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self._normal: list[FloatArray] = []
        self._offset: list[float] = []

    def line(self, number: int) -> tuple[FloatArray, float]:
        """Unit normal, and its product with any point of the line [m]."""
        return self._normal[number], self._offset[number]

    def pieces(self, polygons: Sequence[FloatArray]) -> list[Piece]:
        """Polygons (k, 2) with their edges on lines; those that go clockwise are turned round."""
        turned = [p if area_of(p) > 0.0 else p[::-1] for p in polygons]
        loops = [self._without_short(p) for p in turned]
        spans = [
            (k, m, float(np.linalg.norm(p[(m + 1) % len(p)] - p[m])))
            for k, p in enumerate(loops)
            for m in range(len(p))
        ]
        edges = [[(0, 0)] * len(p) for p in loops]
        for k, m, length in sorted(spans, key=lambda span: -span[2]):  # long edges tell most precisely where a line is
            a, b = loops[k][m], loops[k][(m + 1) % len(loops[k])]
            edges[k][m] = self._find(a, b, length)
        return [Piece(p, tuple(e)) for p, e in zip(loops, edges, strict=True)]

    def divided(self, pieces: Sequence[Piece], by: Piece) -> tuple[list[Piece], list[Piece]]:
        """Parts of polygons inside another one, and outside of it."""
        inside: list[Piece] = []
        outside: list[Piece] = []
        for piece in pieces:
            rest: Piece | None = piece
            beyond: list[Piece] = []
            if by.among(piece.bounds[None, :], self.tolerance):
                for edge in by.edges:
                    assert rest is not None
                    rest, out = self._cut(rest, edge)
                    if out is not None:
                        beyond.append(out)
                    if rest is None:
                        break
            else:
                rest = None
            if rest is None:
                outside.append(piece)
            else:
                inside.append(rest)
                outside += beyond
        return inside, outside

    def common(self, piece: Piece, by: Piece) -> Piece | None:
        """What two polygons have in common, or None."""
        rest: Piece | None = piece
        for edge in by.edges:
            if rest is None:
                return None
            rest, _ = self._cut(rest, edge)
        return rest

    def _find(self, a: FloatArray, b: FloatArray, length: float) -> Edge:
        """The line through two corners of a polygon that lies to their left."""
        along = (b - a) / length
        normal = np.array([along[1], -along[0]])
        for k, (n, o) in enumerate(zip(self._normal, self._offset, strict=True)):
            if abs(n @ a - o) < self.tolerance and abs(n @ b - o) < self.tolerance:
                return k, 1 if n @ normal > 0.0 else -1
        self._normal.append(normal)
        self._offset.append(float(normal @ (0.5 * (a + b))))
        return len(self._offset) - 1, 1

    def _without_short(self, corners: FloatArray) -> FloatArray:
        """A polygon without edges that are round-off."""
        kept = [
            p for p, q in zip(corners, np.roll(corners, 1, axis=0), strict=True) if np.abs(p - q).max() > self.tolerance
        ]
        return np.array(kept)

    def _cut(self, piece: Piece, edge: Edge) -> tuple[Piece | None, Piece | None]:
        """Parts of a polygon behind a line and in front of it."""
        if edge in piece.edges:
            return piece, None
        if (edge[0], -edge[1]) in piece.edges:
            return None, piece
        h = edge[1] * (piece.corners @ self._normal[edge[0]] - self._offset[edge[0]])
        if h.max() <= self.tolerance:
            return piece, None
        if h.min() >= -self.tolerance:
            return None, piece
        return _kept(piece, h, edge), _kept(piece, -h, (edge[0], -edge[1]))


def area_of(corners: FloatArray) -> float:
    """Area of a polygon (k, 2), negative when it goes clockwise [m^2]."""
    x, y = (corners - corners[0]).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def _kept(piece: Piece, h: FloatArray, edge: Edge) -> Piece:
    """The part of a polygon where `h`, the height of its corners, is not positive."""
    corners: list[FloatArray] = []
    edges: list[Edge] = []
    for k in range(len(h)):
        j = k + 1 if k + 1 < len(h) else 0
        if h[k] <= 0.0:
            corners.append(piece.corners[k])
            edges.append(piece.edges[k] if h[k] < 0.0 or h[j] <= 0.0 else edge)
        if h[k] < 0.0 < h[j]:
            corners.append(piece.corners[k] + h[k] / (h[k] - h[j]) * (piece.corners[j] - piece.corners[k]))
            edges.append(edge)
        elif h[j] < 0.0 < h[k]:
            corners.append(piece.corners[k] + h[k] / (h[k] - h[j]) * (piece.corners[j] - piece.corners[k]))
            edges.append(piece.edges[k])
    return Piece(np.array(corners), tuple(edges))
