"""Direct sparse solvers; the symbolic work is done once per pattern."""

from __future__ import annotations

from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.linalg import splu

from fissura.equilibrium.assembly import Pattern

try:  # its wheels exist for x86 only
    import pymklpardiso
except ImportError:
    pymklpardiso = None

__all__ = ["SOLVERS", "DirectSolver", "MklPardiso", "SingularMatrixError", "SuperLU", "best_solver"]

FloatArray = NDArray[np.float64]


class SingularMatrixError(Exception):
    """The matrix cannot be factorized."""


class DirectSolver(Protocol):
    """What the nonlinear solver needs of a linear one."""

    factorizations: int

    def factor(self, data: FloatArray, *, symmetric: bool) -> None:
        """Factorize the matrix with these entries (all of them, in the order of the pattern)."""

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve for one or more right-hand sides; (n,) or (n, k)."""

    def apply(self, right: FloatArray) -> FloatArray:
        """Apply the latest factorization, as a preconditioner of other matrices; (n,) -> (n,)."""


class MklPardiso:
    """PARDISO of the Intel oneAPI Math Kernel Library (Schenk & Gärtner 2004), nested dissection order.

    Parameters
    ----------
    form : Pattern
        Pattern of all matrices to come.
    """

    _ORDERING: ClassVar = {1: 3}  # nested dissection, the faster of its two implementations
    _PLAIN: ClassVar = {**_ORDERING, 9: 13, 10: 0, 12: 0}  # no scaling or matching, which would depend on values

    def __init__(self, form: Pattern) -> None:
        self.form = form
        self.factorizations = 0
        self._solvers: dict[bool, object] = {}
        self._current: object | None = None

    def _upper(self, data: FloatArray) -> csr_array:
        row = np.repeat(np.arange(self.form.size), np.diff(self.form.indptr))[self.form.upper]
        counts = np.bincount(row, minlength=self.form.size)
        indptr = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
        return csr_array(
            (data[self.form.upper], self.form.indices[self.form.upper], indptr),
            shape=(self.form.size, self.form.size),
        )

    def factor(self, data: FloatArray, *, symmetric: bool) -> None:
        """Factorize; symmetric matrices must be positive definite.

        Raises
        ------
        SingularMatrixError
            A symmetric matrix that is not positive definite, or a zero pivot.
        """
        if not np.isfinite(data).all():
            raise SingularMatrixError("the stiffness matrix holds values that are not finite")
        self.factorizations += 1
        solver = self._solvers.get(symmetric)
        try:
            if solver is None:
                matrix = self._upper(data) if symmetric else self.form.matrix(data)
                kind = pymklpardiso.MTYPE_REAL_SYM_POSDEF if symmetric else pymklpardiso.MTYPE_REAL_NONSYM
                solver = pymklpardiso.PardisoSolver(matrix, kind, self._ORDERING if symmetric else self._PLAIN)
                self._solvers[symmetric] = solver
            else:
                solver.refactor(data[self.form.upper] if symmetric else data)  # type: ignore[attr-defined]
        except RuntimeError as error:
            self._solvers.pop(symmetric, None)
            raise SingularMatrixError(str(error)) from error
        self._current = solver

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve with the latest factorization."""
        assert self._current is not None
        solution: FloatArray = self._current.solve(np.asfortranarray(right))  # type: ignore[attr-defined]
        return solution

    def apply(self, right: FloatArray) -> FloatArray:
        """Apply the latest factorization, as a preconditioner of other matrices; (n,) -> (n,)."""
        return self.solve(right)


class SuperLU:
    """SuperLU as scipy ships it: slower, but available everywhere."""

    def __init__(self, form: Pattern) -> None:
        self.form = form
        self.factorizations = 0

    def factor(self, data: FloatArray, *, symmetric: bool) -> None:
        """Factorize.

        Raises
        ------
        SingularMatrixError
            The matrix is singular.
        """
        if not np.isfinite(data).all():
            raise SingularMatrixError("the stiffness matrix holds values that are not finite")
        self.factorizations += 1
        matrix = self.form.matrix(data).tocsc()
        options = {"SymmetricMode": True}
        try:
            self._lu = splu(
                matrix,
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0 if symmetric else 0.01,
                options=options,
            )
        except RuntimeError as error:
            raise SingularMatrixError(str(error)) from error

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve with the latest factorization."""
        solution: FloatArray = self._lu.solve(right)
        return solution

    def apply(self, right: FloatArray) -> FloatArray:
        """Apply the latest factorization, as a preconditioner of other matrices; (n,) -> (n,)."""
        return self.solve(right)


#: Direct solvers by name.
SOLVERS: dict[str, type[MklPardiso] | type[SuperLU]] = {"superlu": SuperLU}
if pymklpardiso is not None:
    SOLVERS["pardiso"] = MklPardiso


def best_solver() -> type[MklPardiso] | type[SuperLU]:
    """The fastest direct solver that is installed."""
    return SOLVERS.get("pardiso", SuperLU)
