"""Which body owns a point of the specimen."""

from typing import Protocol

import numpy as np
from scipy.spatial import cKDTree

from fissura.arrays import FloatArray, IntArray


class Bodies(Protocol):
    """What has a nucleus for every body: a tessellation, or all nuclei of a specimen."""

    @property
    def x(self) -> FloatArray:
        """Nuclei [m], shape (n, 3)."""

    def inside(self, cell: int) -> IntArray | None:
        """Bodies that may own points in a convex cell of the specimen; None where all may."""

    def __len__(self) -> int: ...


def owners(bodies: Bodies, points: FloatArray, cells: IntArray) -> IntArray:
    """Body that owns each point: of those that may own points in its convex cell, the one with the nearest nucleus.

    Parameters
    ----------
    bodies : Tessellation or Nuclei
        The bodies.
    points : (k, 3) array
        Points of the specimen [m].
    cells : (k,) array
        The convex cell in which each of them lies.

    Returns
    -------
    (k,) array
        Index of the body.
    """
    out = np.empty(len(points), np.int64)
    anyones = np.zeros(len(points), np.bool_)
    for cell in np.unique(cells):
        here, there = cells == cell, bodies.inside(int(cell))
        if there is None:
            anyones |= here
        else:
            out[here] = there[cKDTree(bodies.x[there]).query(points[here])[1]]
    if anyones.any():
        out[anyones] = cKDTree(bodies.x).query(points[anyones])[1]
    return out
