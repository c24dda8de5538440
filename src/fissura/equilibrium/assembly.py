"""Assembly of stiffness matrices into a fixed pattern of 6x6 blocks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.sparse import csr_array

from fissura.contact import Kinematics

__all__ = ["Pattern", "assemble", "pattern"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Pattern:
    """Compressed rows of the stiffness matrix, fixed for one discretization.

    The six rows of body ``b`` follow each other; each holds the same blocks of six columns, so that entry ``(a, d)`` of block ``k``
    lies at ``start[b] + a * stride[b] + 6 k + d``.

    Attributes
    ----------
    indptr, indices : (6 n + 1,), (z,) arrays
        Compressed sparse rows.
    start, stride : (n,) arrays
        Place of each body's first row, and length of its rows.
    diagonal : (n,) array
        Offset ``6 k`` of the diagonal block.
    opposite : (2 m,) array
        Offset ``6 k`` of the block that couples a body with the other body of a contact, in the order of
        ``Kinematics.adjacent``.
    upper : (z',) array
        Entries on and above the diagonal.
    fixed : (y,) array
        Entries to which `fixed_values` are added, from supports.
    fixed_values : (y,) array
        Their values [N/m, N, N m].
    """

    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    start: IntArray
    stride: IntArray
    diagonal: IntArray
    opposite: IntArray
    upper: IntArray
    fixed: IntArray
    fixed_values: FloatArray

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.indptr) - 1

    def matrix(self, data: FloatArray) -> csr_array:
        """The matrix with the given entries, as scipy knows it."""
        return csr_array((data, self.indices, self.indptr), shape=(self.size, self.size))


def pattern(geometry: Kinematics, supports: FloatArray, support_dofs: IntArray, stiffness: float) -> Pattern:
    """Pattern for the contacts of a discretization and its supports.

    Parameters
    ----------
    geometry : Kinematics
        Contacts.
    supports : (s, k) array
        Rows of support functionals, restricted to the columns `support_dofs`.
    support_dofs : (k,) array
        Unknowns that supports touch.
    stiffness : float
        Penalty stiffness of each support [N/m].
    """
    n = len(geometry.first) - 1
    i, j = geometry.bodies.T
    held = [np.unique(support_dofs[row != 0.0] // 6) for row in supports]
    cliques = [np.stack(np.meshgrid(b, b, indexing="ij"), axis=-1).reshape(-1, 2) for b in held]
    rows = np.concatenate([i, j, np.arange(n), *(c[:, 0] for c in cliques)])
    columns = np.concatenate([j, i, np.arange(n), *(c[:, 1] for c in cliques)])
    keys = np.unique(rows * n + columns)
    block_row, block_column = keys // n, keys % n
    first = np.searchsorted(block_row, np.arange(n + 1))
    count = np.diff(first)
    start, stride = 36 * first[:-1], 6 * count
    indptr = np.concatenate([[0], np.cumsum(np.repeat(stride, 6))])
    row_columns = (6 * block_column[:, None] + np.arange(6)).ravel()  # columns of the first row of every body
    lengths = np.repeat(stride, 6)
    source = np.repeat(np.repeat(6 * first[:-1], 6) - indptr[:-1], lengths) + np.arange(indptr[-1])
    indices = row_columns[source]

    def offset(row: IntArray, column: IntArray) -> IntArray:
        return 6 * (np.searchsorted(keys, row * n + column) - first[row])

    contact, side = geometry.adjacent // 2, geometry.adjacent % 2
    owner, other = geometry.bodies[contact, side], geometry.bodies[contact, 1 - side]
    of_row = np.repeat(np.arange(6 * n), lengths)
    upper = np.flatnonzero(indices >= of_row)

    entry, value = [np.empty(0, np.int64)], [np.empty(0)]
    for row in supports:
        touched = support_dofs[row != 0.0]
        a, b = (g.ravel() for g in np.meshgrid(touched, touched, indexing="ij"))
        entry.append(start[a // 6] + (a % 6) * stride[a // 6] + offset(a // 6, b // 6) + b % 6)
        value.append(stiffness * np.outer(row[row != 0.0], row[row != 0.0]).ravel())
    fixed, where = np.unique(np.concatenate(entry), return_inverse=True)
    return Pattern(
        indptr.astype(np.int32),
        indices.astype(np.int32),
        start,
        stride,
        offset(np.arange(n), np.arange(n)),
        offset(owner, other),
        upper,
        fixed,
        np.bincount(where, np.concatenate(value), len(fixed)),
    )


@njit(cache=True)
def _assemble(rows, volume, first, adjacent, tangent, start, stride, diagonal, opposite, data):  # type: ignore[no-untyped-def]
    scaled = np.empty((6, 3))
    for body in range(len(start)):
        own = start[body] + diagonal[body]
        for k in range(first[body], first[body + 1]):
            c, shift = adjacent[k] // 2, 6 * (adjacent[k] % 2)
            for p in range(6):
                for a in range(3):
                    t = 0.0
                    for b in range(3):
                        t += rows[c, b, shift + p] * tangent[c, b, a]
                    scaled[p, a] = t * volume[c]
            other = start[body] + opposite[k]
            for p in range(6):
                here, there = own + p * stride[body], other + p * stride[body]
                for q in range(6):
                    s, o = 0.0, 0.0
                    for a in range(3):
                        s += scaled[p, a] * rows[c, a, shift + q]
                        o += scaled[p, a] * rows[c, a, 6 - shift + q]
                    data[here + q] += s
                    data[there + q] += o


def assemble(geometry: Kinematics, form: Pattern, tangent: FloatArray) -> FloatArray:
    """Entries of the stiffness matrix ``sum A L B^T (ds/de) B`` plus supports, in the order of the pattern.

    Parameters
    ----------
    geometry : Kinematics
        Contacts.
    form : Pattern
        Their pattern.
    tangent : (m, 3, 3) array
        Stiffness ``ds/de`` of every contact [Pa].
    """
    data = np.zeros(len(form.indices))
    _assemble(
        geometry.rows,
        geometry.volume,
        geometry.first,
        geometry.adjacent,
        tangent,
        form.start,
        form.stride,
        form.diagonal,
        form.opposite,
        data,
    )
    data[form.fixed] += form.fixed_values
    return data
