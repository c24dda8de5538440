"""Clusters of neighbouring bodies that move as one rigid body: the coarse unknowns of the two-level solver."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.sparse import bsr_array, coo_array, csr_array
from scipy.sparse.csgraph import connected_components

from fissura.equilibrium.block_cholesky import LowerBlocks

__all__ = ["CoarseSpace", "bisected", "connected", "intact"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


def bisected(x: FloatArray, size: int) -> list[IntArray]:
    """Groups of neighbouring points by recursive bisection across their longest extent.

    Counting points instead of measuring distances gives graded discretizations equal groups.

    Parameters
    ----------
    x : (n, 3) array
        Points.
    size : int
        Points in the largest group.

    Returns
    -------
    list of (k,) arrays
        Points of each group; groups that follow each other are neighbours more often than not.
    """
    todo, done = [np.arange(len(x))], []
    while todo:
        points = todo.pop()
        parts = -(-len(points) // size)
        if parts <= 1:
            done.append(points)
            continue
        here = x[points]
        along = here[:, int(np.argmax(np.ptp(here, axis=0)))]
        cut = len(points) * (parts // 2) // parts
        ranked = points[np.argsort(along, kind="stable")]
        todo += [ranked[cut:], ranked[:cut]]
    return done


def intact(row: IntArray, column: IntArray, stiffness: FloatArray, sound: FloatArray | None, share: float) -> BoolArray:
    """Contacts stiff enough to hold bodies together.

    Parameters
    ----------
    row, column : (m,) arrays
        Bodies of each contact.
    stiffness : (m,) array
        Size of each contact's stiffness [N/m].
    sound : (m,) array or None
        The same before any damage; None: compare each contact with the stiffest one of its two bodies.
    share : float
        Smallest share of `sound` to be left.
    """
    if sound is None:
        most = np.zeros(max(row.max(initial=-1), column.max(initial=-1)) + 1)
        np.maximum.at(most, row, stiffness)
        np.maximum.at(most, column, stiffness)
        sound = np.maximum(most[row], most[column])
    return np.asarray(stiffness > share * sound)


def connected(label: IntArray, row: IntArray, column: IntArray) -> IntArray:
    """Split clusters into parts that hold together by the given contacts.

    Parameters
    ----------
    label : (n,) array
        Cluster of each body.
    row, column : (m,) arrays
        Bodies of each contact.

    Returns
    -------
    (n,) array
        Part of each body, numbered 0, 1, ... in the order of their first bodies.
    """
    n = len(label)
    inside = label[row] == label[column]
    links = coo_array((np.ones(int(inside.sum()), dtype=np.int8), (row[inside], column[inside])), shape=(n, n))
    _, part = connected_components(links.tocsr(), directed=False)
    return np.asarray(part, dtype=np.int64)


@njit(cache=True)
def _expand(block, arm, unit, out):  # type: ignore[no-untyped-def]
    """``out += block P`` for the rigid motion P of a body with this arm."""
    for a in range(6):
        f0, f1, f2 = block[a, 0], block[a, 1], block[a, 2]
        out[a, 0] += f0
        out[a, 1] += f1
        out[a, 2] += f2
        # u = theta x r, so that f . u = theta . (r x f)
        out[a, 3] += (block[a, 3] + arm[1] * f2 - arm[2] * f1) * unit
        out[a, 4] += (block[a, 4] + arm[2] * f0 - arm[0] * f2) * unit
        out[a, 5] += (block[a, 5] + arm[0] * f1 - arm[1] * f0) * unit


@njit(cache=True)
def _touched(indptr, indices, label):  # type: ignore[no-untyped-def]
    """Keys ``body * clusters + cluster`` of all nonzero blocks of K P, with repetitions."""
    clusters = label.max() + 1
    keys = np.empty(2 * len(indices), dtype=np.int64)
    for i in range(len(indptr) - 1):
        for k in range(indptr[i], indptr[i + 1]):
            j = indices[k]
            keys[2 * k] = i * clusters + label[j]
            keys[2 * k + 1] = j * clusters + label[i]
    return keys


@njit(cache=True)
def _find(first, cluster, body, wanted):  # type: ignore[no-untyped-def]
    k = first[body]
    while cluster[k] != wanted:
        k += 1
    return k


@njit(cache=True)
def _condense(indptr, indices, blocks, label, arm, unit, first, cluster, out):  # type: ignore[no-untyped-def]
    turned = np.empty((6, 6))
    for i in range(len(indptr) - 1):
        for k in range(indptr[i], indptr[i + 1]):
            j = indices[k]
            _expand(blocks[k], arm[j], unit, out[_find(first, cluster, i, label[j])])
            if j != i:
                turned[:] = blocks[k].T
                _expand(turned, arm[i], unit, out[_find(first, cluster, j, label[i])])


@njit(cache=True)
def _restrict(label, arm, unit, r, out):  # type: ignore[no-untyped-def]
    for i in range(len(label)):
        c, a, f = label[i], arm[i], r[i]
        out[c, 0] += f[0]
        out[c, 1] += f[1]
        out[c, 2] += f[2]
        out[c, 3] += (f[3] + a[1] * f[2] - a[2] * f[1]) * unit
        out[c, 4] += (f[4] + a[2] * f[0] - a[0] * f[2]) * unit
        out[c, 5] += (f[5] + a[0] * f[1] - a[1] * f[0]) * unit


@njit(cache=True)
def _prolong(label, arm, unit, coarse, out):  # type: ignore[no-untyped-def]
    for i in range(len(label)):
        u, r = coarse[label[i]], arm[i]
        t0, t1, t2 = u[3] * unit, u[4] * unit, u[5] * unit
        out[i, 0] += u[0] + t1 * r[2] - t2 * r[1]
        out[i, 1] += u[1] + t2 * r[0] - t0 * r[2]
        out[i, 2] += u[2] + t0 * r[1] - t1 * r[0]
        out[i, 3] += t0
        out[i, 4] += t1
        out[i, 5] += t2


@njit(cache=True)
def _restrict_product(first, cluster, product, z, out):  # type: ignore[no-untyped-def]
    for i in range(len(z)):
        for k in range(first[i], first[i + 1]):
            c = cluster[k]
            for d in range(6):
                s = 0.0
                for a in range(6):
                    s += product[k, a, d] * z[i, a]
                out[c, d] += s


class CoarseSpace:
    """Rigid motions of clusters, ``u_i = u_c + theta_c x (x_i - x_c)`` and ``theta_i = theta_c``, as a matrix P.

    The unknowns of a cluster are ``u_c`` and ``theta_c`` times the typical size of a cluster, lengths both.

    Parameters
    ----------
    form : LowerBlocks
        Lower triangle of the stiffness matrix K.
    blocks : (k, 6, 6) array
        Its blocks.
    x : (n, 3) array
        Nuclei in the order of `form`.
    label : (n,) array
        Cluster of each body, 0, 1, ... without gaps.
    """

    def __init__(self, form: LowerBlocks, blocks: FloatArray, x: FloatArray, label: IntArray) -> None:
        count = np.bincount(label)
        centre = np.stack([np.bincount(label, x[:, a]) for a in range(3)], axis=1) / count[:, None]
        self.clusters = len(count)
        self.label = label
        self.arm: FloatArray = x - centre[label]
        # Bodies of one cluster each have no arm; then any length will do.
        self.unit = 1.0 / (float(np.sqrt((self.arm**2).sum(axis=1).mean())) or 1.0)
        keys = np.unique(_touched(form.indptr, form.indices, label))
        self._first: IntArray = np.searchsorted(keys, np.arange(len(x) + 1) * self.clusters)
        self._cluster: IntArray = keys % self.clusters
        self._product: FloatArray = np.zeros((len(keys), 6, 6))  # K P
        _condense(
            form.indptr, form.indices, blocks, label, self.arm, self.unit, self._first, self._cluster, self._product
        )

    def matrix(self) -> csr_array:
        """The coarse matrix ``P^T K P``, symmetric."""
        n, r = len(self.label), self.arm
        motion = np.zeros((n, 6, 6))
        motion[:, range(3), range(3)] = 1.0
        motion[:, range(3, 6), range(3, 6)] = self.unit
        for p, q, s in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            motion[:, p, 3 + q] = self.unit * r[:, s]
            motion[:, p, 3 + s] = -self.unit * r[:, q]
        shape = (6 * n, 6 * self.clusters)
        rigid = bsr_array((motion, self.label, np.arange(n + 1)), shape=shape)
        product = bsr_array((self._product, self._cluster, self._first), shape=shape)
        coarse = csr_array(rigid.T @ product)
        return csr_array(0.5 * (coarse + coarse.T))

    def restrict(self, r: FloatArray) -> FloatArray:
        """``P^T r``; (n, 6) -> (clusters, 6)."""
        out = np.zeros((self.clusters, 6))
        _restrict(self.label, self.arm, self.unit, r, out)
        return out

    def restrict_product(self, z: FloatArray) -> FloatArray:
        """``P^T K z``; (n, 6) -> (clusters, 6)."""
        out = np.zeros((self.clusters, 6))
        _restrict_product(self._first, self._cluster, self._product, z, out)
        return out

    def add_motion(self, coarse: FloatArray, u: FloatArray) -> None:
        """Add ``P coarse`` to u; shapes (clusters, 6) and (n, 6)."""
        _prolong(self.label, self.arm, self.unit, coarse, u)
