"""Direct solver for the coarse matrices of the two-level solver, whose pattern changes with the clusters."""

from typing import Any

import numpy as np
from scipy.sparse import csc_array, csr_array, triu
from scipy.sparse.linalg import splu

from fissura.arrays import FloatArray

try:  # its wheels exist for x86 only
    import pymklpardiso
except ImportError:
    pymklpardiso = None


class CoarseSolver:
    """Direct solver for coarse matrices; what depends on their pattern alone is kept while it stays the same."""

    def __init__(self) -> None:
        self._matrix: csr_array | None = None
        self._pardiso: Any = None
        self._lu: Any = None

    def factor(self, upper: csr_array) -> None:
        """Factorize a symmetric positive definite matrix, given on and above its diagonal.

        Raises
        ------
        RuntimeError
            It is not positive definite, as far as this can be told.
        """
        before, self._matrix = self._matrix, None
        if pymklpardiso is None:
            full = csc_array(upper + triu(upper, 1).T)
            options = {"SymmetricMode": True}
            self._lu = splu(full, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
        elif (
            before is not None
            and np.array_equal(before.indptr, upper.indptr)
            and np.array_equal(before.indices, upper.indices)
        ):
            self._pardiso.refactor(upper.data)
        else:
            self._pardiso = pymklpardiso.PardisoSolver(upper, pymklpardiso.MTYPE_REAL_SYM_POSDEF, {1: 3})
        self._matrix = upper

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve for a vector per cluster; (clusters, 6) -> (clusters, 6)."""
        flat = right.ravel()
        found = self._lu.solve(flat) if self._pardiso is None else self._pardiso.solve(flat)
        return np.asarray(found, dtype=np.float64).reshape(-1, 6)
