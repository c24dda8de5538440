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

    The six rows of body ``b`` follow each other; each holds the same blocks of six columns, so that entry ``(a, d)`` of
    block ``k`` lies at ``start[b] + a * stride[b] + 6 k + d``.

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
        Entries to which `fixed_values`, the constant part, are added.
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


def pattern(geometry: Kinematics, constant: csr_array) -> Pattern:
    """Pattern for the contacts of a discretization and a constant part.

    Parameters
    ----------
    geometry : Kinematics
        Contacts.
    constant : (6 n, 6 n) sparse array
        Stiffness that never changes, such as that of supports; symmetric.
    """
    n = len(geometry.first) - 1
    i, j = geometry.bodies.T
    extra = constant.tocoo()
    rows = np.concatenate([i, j, np.arange(n), extra.row // 6])
    columns = np.concatenate([j, i, np.arange(n), extra.col // 6])
    keys = np.unique(rows.astype(np.int64) * n + columns)
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
    r, c = extra.row.astype(np.int64), extra.col.astype(np.int64)
    entry = start[r // 6] + (r % 6) * stride[r // 6] + offset(r // 6, c // 6) + c % 6
    fixed, where = np.unique(entry, return_inverse=True)
    return Pattern(
        indptr.astype(np.int32),
        indices.astype(np.int32),
        start,
        stride,
        offset(np.arange(n), np.arange(n)),
        offset(owner, other),
        np.flatnonzero(indices >= of_row),
        fixed,
        np.asarray(np.bincount(where, extra.data, len(fixed)), dtype=np.float64),
    )


@njit(cache=True)
def _assemble(  # type: ignore[no-untyped-def]
    rows, volume, first, adjacent, tangent, start, stride, diagonal, opposite, data
):
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
    """Entries of the stiffness matrix ``sum A L B^T (ds/de) B`` plus the constant part, in the order of the pattern.

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
