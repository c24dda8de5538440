"""Stiffness of low rank: supports that hold many bodies at once, kept as the few rows that they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from fissura.arrays import FloatArray, IntArray
from fissura.kernels import njit


# Compiled, since threads of numpy's library would cost more than they save.
@njit()
def _values(bodies, rows, u, out):  # type: ignore[no-untyped-def]
    for r in range(len(rows)):
        for h in range(len(bodies)):
            for d in range(6):
                out[r] += rows[r, h, d] * u[bodies[h], d]


@njit()
def _add_rows(bodies, rows, forces, out):  # type: ignore[no-untyped-def]
    for r in range(len(rows)):
        for h in range(len(bodies)):
            for d in range(6):
                out[bodies[h], d] += rows[r, h, d] * forces[r]


@dataclass(frozen=True)
class LowRank:
    """The matrix ``stiffness R^T R`` with few rows R.

    As entries of a matrix, a support that holds h bodies would be a dense block of ``(6 h)^2``.

    Attributes
    ----------
    bodies : (h,) array
        Bodies on which rows have coefficients, ascending.
    rows : (k, h, 6) array
        Coefficients on their displacements and rotations; k may be 0.
    stiffness : float
        Factor [N/m].
    """

    bodies: IntArray
    rows: FloatArray
    stiffness: float

    @classmethod
    def none(cls) -> LowRank:
        """No stiffness at all."""
        return cls(np.empty(0, dtype=np.int64), np.empty((0, 0, 6)), 0.0)

    @classmethod
    def of(cls, rows: csr_array, stiffness: float) -> LowRank:
        """From rows over all unknowns; (k, 6 n) sparse array."""
        used = rows.tocoo()
        bodies = np.unique(used.col // 6).astype(np.int64)
        out = np.zeros((rows.shape[0], len(bodies), 6))
        np.add.at(out, (used.row, np.searchsorted(bodies, used.col // 6), used.col % 6), used.data)
        return cls(bodies, out, stiffness)

    def __len__(self) -> int:
        return len(self.rows)

    def values(self, u: FloatArray) -> FloatArray:
        """``R u``; (n, 6) -> (k,)."""
        out = np.zeros(len(self))
        _values(self.bodies, self.rows, u, out)
        return out

    def add_product(self, u: FloatArray, out: FloatArray) -> None:
        """Add ``stiffness R^T R u`` to `out`; both (n, 6)."""
        _add_rows(self.bodies, self.rows, self.stiffness * self.values(u), out)

    def add_sizes(self, u: FloatArray, out: FloatArray) -> None:
        """Add the sum of the sizes of all terms of :meth:`add_product` to `out`; both (n, 6)."""
        LowRank(self.bodies, np.abs(self.rows), self.stiffness).add_product(np.abs(u), out)
