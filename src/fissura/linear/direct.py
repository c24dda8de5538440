"""Direct sparse solvers; the symbolic work is done once per pattern."""

from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import splu

from fissura.arrays import FloatArray
from fissura.kernels import njit
from fissura.linear import limits
from fissura.linear.assembly import Pattern
from fissura.linear.protocol import SingularMatrixError
from fissura.linear.woodbury import LowRankCorrection

try:  # its wheels exist for x86 only
    import pymklpardiso
except ImportError:
    pymklpardiso = None


class _Direct(ABC):
    """What direct solvers have in common."""

    def __init__(self, form: Pattern) -> None:
        self.form = form
        self.factorizations = 0
        self._correction = LowRankCorrection(form) if len(form.low_rank) else None

    def factor(self, data: FloatArray, *, symmetric: bool) -> None:
        """Factorize; symmetric matrices must be positive definite.

        Raises
        ------
        SingularMatrixError
            A matrix that is singular, or symmetric but not positive definite where the library can tell.
        """
        if not np.isfinite(data).all():
            raise SingularMatrixError("the stiffness matrix holds values that are not finite")
        self.factorizations += 1
        correction = self._correction
        try:
            self._factor(data if correction is None else correction.anchored(data), symmetric)
            if correction is not None:
                correction.prepare(data, self._solve)
        except (RuntimeError, ValueError) as error:  # also LinAlgError, and solutions that are not finite
            raise SingularMatrixError(str(error)) from error

    def solve(self, right: FloatArray, tolerance: float | None = None) -> FloatArray:
        """Solve with the latest factorization, exactly; (n,) or (n, k)."""
        return self._solve(right) if self._correction is None else self._correction.solve(right, self._solve)

    def apply(self, right: FloatArray) -> FloatArray:
        """Apply the latest factorization, as a preconditioner of other matrices; (n,) -> (n,)."""
        return self.solve(right)

    @abstractmethod
    def _factor(self, data: FloatArray, symmetric: bool) -> None:
        """Factorize the part of the matrix that has a pattern; RuntimeError where that is impossible."""

    @abstractmethod
    def _solve(self, right: FloatArray) -> FloatArray:
        """Solve with it."""


@njit()
def _upper(indptr, indices, data, out_indptr, out_indices, out):  # type: ignore[no-untyped-def]
    entry = 0
    for row in range(len(indptr) - 1):
        out_indptr[row] = entry
        for k in range(indptr[row], indptr[row + 1]):
            if indices[k] >= row:
                out_indices[entry], out[entry] = indices[k], data[k]
                entry += 1
    out_indptr[-1] = entry


def upper_triangle(form: Pattern, data: FloatArray) -> csr_array:
    """Entries on and above the diagonal of a symmetric matrix."""
    count = (len(data) + form.size) // 2
    indptr, indices = np.empty(form.size + 1, dtype=np.int32), np.empty(count, dtype=np.int32)
    out = np.empty(count)
    _upper(form.indptr, form.indices, data, indptr, indices, out)
    return csr_array((out, indices, indptr), shape=(form.size, form.size))


class MklPardiso(_Direct):
    """PARDISO of the Intel oneAPI Math Kernel Library (Schenk & Gärtner 2004), nested dissection order.

    Parameters
    ----------
    form : Pattern
        Pattern of all matrices to come.
    """

    _ORDERING: ClassVar = {1: 3}  # nested dissection, the faster of its two implementations
    _PLAIN: ClassVar = {**_ORDERING, 9: 13, 10: 0, 12: 0}  # no scaling or matching, which would depend on values

    def __init__(self, form: Pattern) -> None:
        super().__init__(form)
        self._solvers: dict[bool, Any] = {}
        self._current: Any = None

    def _factor(self, data: FloatArray, symmetric: bool) -> None:
        matrix = upper_triangle(self.form, data) if symmetric else self.form.matrix(data)
        solver = self._solvers.pop(symmetric, None)
        if solver is None:
            kind = pymklpardiso.MTYPE_REAL_SYM_POSDEF if symmetric else pymklpardiso.MTYPE_REAL_NONSYM
            solver = pymklpardiso.PardisoSolver(matrix, kind, self._ORDERING if symmetric else self._PLAIN)
        else:
            solver.refactor(matrix.data)
        self._solvers[symmetric] = self._current = solver

    def _solve(self, right: FloatArray) -> FloatArray:
        solution: FloatArray = self._current.solve(np.asfortranarray(right))
        return solution


class SuperLU(_Direct):
    """SuperLU as scipy ships it: slower, but available everywhere."""

    def _factor(self, data: FloatArray, symmetric: bool) -> None:
        self._lu = splu(
            self.form.matrix(data).tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0 if symmetric else limits.PIVOT,
            options={"SymmetricMode": True},
        )

    def _solve(self, right: FloatArray) -> FloatArray:
        solution: FloatArray = self._lu.solve(right)
        return solution


#: Direct solvers by name.
SOLVERS: dict[str, type[MklPardiso] | type[SuperLU]] = {"superlu": SuperLU}
if pymklpardiso is not None:
    SOLVERS["pardiso"] = MklPardiso


def best_solver() -> type[MklPardiso] | type[SuperLU]:
    """The fastest direct solver that is installed."""
    return SOLVERS.get("pardiso", SuperLU)
