"""Solids from conforming tetrahedra."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from fissura.arrays import IntArray
from fissura.specimen.convex import Convex
from fissura.specimen.planes import Face
from fissura.specimen.solid import Cell, Solid

#: Corners of the face opposite to each corner, counterclockwise from outside when the volume is positive.
OPPOSITE = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])


def _tables() -> tuple[IntArray, IntArray]:
    """Half-edges of one tetrahedron: three leave each corner, counterclockwise from outside."""
    left = {}  # the face on the left of an edge
    before = {}  # the corner before an edge, around that face
    for f, loop in enumerate(OPPOSITE.tolist()):
        for k in range(3):
            left[loop[k], loop[(k + 1) % 3]] = f
            before[loop[k], loop[(k + 1) % 3]] = loop[(k + 2) % 3]
    ring = {}
    for v in range(4):
        first = 0 if v != 0 else 1
        second = before[v, first]
        ring[v] = [first, second, 6 - v - first - second]
    twin, face = np.full(16, -1, np.int64), np.full(16, -1, np.int64)
    for v in range(4):
        for k, w in enumerate(ring[v]):
            twin[4 * v + k] = 4 * w + ring[w].index(v)
            face[4 * v + k] = left[v, w]
    return twin, face


_TWIN, _FACE = _tables()


def triangles_of(tetrahedra: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Faces of tetrahedra.

    Parameters
    ----------
    tetrahedra : (K, 4) array
        Numbers of corners.

    Returns
    -------
    triangles : (t, 3) array
        Each triangle once, its corners ascending.
    number : (K, 4) array
        The triangle opposite to each corner.
    count : (t,) array
        How many tetrahedra share it.
    """
    flat = np.sort(tetrahedra[:, OPPOSITE], axis=2).reshape(-1, 3)
    triangles, number, count = np.unique(flat, axis=0, return_inverse=True, return_counts=True)
    return triangles, number.reshape(-1, 4), count


def solid_of_tetrahedra(
    vertices: ArrayLike, tetrahedra: ArrayLike, names: Mapping[tuple[int, int, int], str] | None = None
) -> Solid:
    """A solid of tetrahedra that share whole triangles.

    Parameters
    ----------
    vertices : (v, 3) array
        Corners [m].
    tetrahedra : (K, 4) array
        Numbers of the corners of each; their volumes are not zero.
    names : mapping, optional
        Surface of triangles, by their corners in ascending order.

    Raises
    ------
    ValueError
        A tetrahedron without volume.
    """
    x, tets = np.asarray(vertices, float), np.array(tetrahedra, dtype=np.int64)
    names = {} if names is None else names
    arms = x[tets[:, 1:]] - x[tets[:, :1]]
    turned = np.linalg.det(arms) < 0.0
    tets[turned] = tets[turned][:, [1, 0, 2, 3]]
    solid = Solid(x[tets].min(axis=(0, 1)), x[tets].max(axis=(0, 1)))
    triangles, number, count = triangles_of(tets)
    a, b, c = (x[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    offset = np.einsum("ta,ta->t", normal, (a + b + c) / 3.0)
    # Each triangle is a plane of its own: neighbours share it whole, and no other face lies in it.
    faces = [solid.planes.find(n, d, new=True)[0] for n, d in zip(normal, offset, strict=True)]
    ahead = np.einsum("kfa,kfa->kf", normal[number], x[tets] - a[number])  # of the corner opposite to each face
    sign = np.where(ahead > 0.0, -1, 1)
    outer = {int(t): name for t in np.flatnonzero(count == 1) if (name := names.get(tuple(triangles[t].tolist())))}
    corners = np.ascontiguousarray(x[tets].transpose(0, 2, 1))
    for name in dict.fromkeys(names.values()):
        solid.surfaces.append(name)
    for k in range(len(tets)):
        mine: tuple[Face, ...] = tuple((faces[t], s) for t, s in zip(number[k].tolist(), sign[k].tolist(), strict=True))
        named = {face: outer[t] for face, t in zip(mine, number[k].tolist(), strict=True) if t in outer}
        solid.add_cell(Cell(Convex(mine, corners[k], _TWIN, _FACE), named))
    return solid
