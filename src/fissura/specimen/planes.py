"""Planes by identity: two that differ by round-off only are one."""

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from fissura.arrays import FloatArray
from fissura.specimen.limits import CLEAN, SAME

#: A plane and the side of it, +1 or -1, to which the outward normal of a face in it points.
Face: TypeAlias = tuple[int, int]


def opposite(face: Face) -> Face:
    """The same plane, seen from the other side."""
    return face[0], -face[1]


def unit(vector: ArrayLike) -> FloatArray:
    """Unit vector of a direction, shape (3,); components that are round-off are zero.

    Raises
    ------
    ValueError
        The vector has no length.
    """
    out = np.asarray(vector, float)
    largest = np.abs(out).max()
    if not 0.0 < largest < np.inf:
        raise ValueError("a direction has no length")
    out = out / largest
    out = out / np.linalg.norm(out)
    out[np.abs(out) < CLEAN] = 0.0
    cleaned: FloatArray = out / np.linalg.norm(out)
    return cleaned


class Planes:
    """Planes, each known by a number.

    Parameters
    ----------
    centre : (3,) array
        A point in the middle, from which round-off is judged [m].
    extent : float
        Largest dimension of the whole [m].
    """

    def __init__(self, centre: ArrayLike, extent: float) -> None:
        self.centre = np.asarray(centre, float)
        self.extent = float(extent)
        self._normal = np.empty((16, 3))
        self._offset = np.empty(16)
        self._central = np.empty(16)
        self._count = 0

    def __len__(self) -> int:
        return self._count

    @property
    def tolerance(self) -> float:
        """Length that is round-off [m]."""
        return SAME * self.extent

    def find(self, normal: ArrayLike, offset: float, *, new: bool = False) -> Face:
        """The face of the half-space ``normal @ x <= offset``.

        Parameters
        ----------
        normal : (3,) array
            Outward normal, of any length.
        offset : float
            Its product with a point of the plane.
        new : bool, optional
            Take the plane as another one without looking for it.

        Raises
        ------
        ValueError
            The normal has no length.
        """
        n = unit(normal)
        d = offset / float(np.linalg.norm(np.asarray(normal, float)))
        central = d - n @ self.centre
        if not new:
            known, at = self._normal[: self._count], self._central[: self._count]
            aligned = known @ n
            sign = np.where(aligned < 0.0, -1.0, 1.0)
            same = np.abs(known - sign[:, None] * n).max(axis=1, initial=0.0) < SAME
            same &= np.abs(at - sign * central) < self.tolerance
            found = np.flatnonzero(same)
            if len(found):
                plane = int(found[0])
                return plane, int(sign[plane])
        if self._count == len(self._offset):
            self._normal = np.concatenate([self._normal, np.empty_like(self._normal)])
            self._offset = np.concatenate([self._offset, np.empty_like(self._offset)])
            self._central = np.concatenate([self._central, np.empty_like(self._central)])
        self._normal[self._count], self._offset[self._count], self._central[self._count] = n, d, central
        self._count += 1
        return self._count - 1, 1

    def normal(self, face: Face) -> FloatArray:
        """Outward unit normal of a face, shape (3,)."""
        out: FloatArray = face[1] * self._normal[face[0]] + 0.0
        return out

    def offset(self, face: Face) -> float:
        """Product of the outward normal with any point of the face [m]."""
        return float(face[1] * self._offset[face[0]]) + 0.0

    def half_spaces(self, faces: tuple[Face, ...]) -> tuple[FloatArray, FloatArray]:
        """Normals (f, 3) and offsets (f,) of half-spaces ``normal @ x <= offset``."""
        plane, sign = np.array(faces, dtype=np.int64).reshape(-1, 2).T
        return sign[:, None] * self._normal[plane] + 0.0, sign * self._offset[plane] + 0.0  # no zeros with a sign
