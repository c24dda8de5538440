"""Solvers for symmetric positive definite matrices: by name, and the one that suits the size of a structure."""

from __future__ import annotations

import logging
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fissura.equilibrium.amg import SmoothedAggregation
from fissura.equilibrium.assembly import Pattern
from fissura.equilibrium.direct import best_solver
from fissura.equilibrium.linear import LinearSolver, SingularMatrixError
from fissura.equilibrium.two_level import TwoLevel

__all__ = ["LINEAR_SOLVERS", "SymmetricSolver"]

FloatArray = NDArray[np.float64]
_log = logging.getLogger(__name__)

#: From this number of bodies on the two-level solver is faster (`benchmarks/linear_solvers.py`).
_LARGE = 2000

#: Solvers by name, made from a pattern, nuclei (n, 3), and a relative error in the energy norm, which `direct` does not
#: need. `amg` is there for comparison.
LINEAR_SOLVERS: dict[str, Callable[[Pattern, FloatArray, float], LinearSolver]] = {
    "direct": lambda form, x, tolerance: best_solver()(form),
    "two-level": TwoLevel,
    "amg": SmoothedAggregation,
}


class SymmetricSolver:
    """Solves with elastic and secant matrices.

    Where the iterative solver does not converge, the direct one takes over for that matrix.

    Parameters
    ----------
    form : Pattern
        Pattern of all matrices to come.
    x : (n, 3) array
        Nuclei [m].
    direct : LinearSolver
        Direct solver for the same pattern.
    """

    def __init__(self, form: Pattern, x: FloatArray, direct: LinearSolver) -> None:
        self._direct = direct
        self._iterative = TwoLevel(form, x) if len(x) >= _LARGE else None
        self._data: FloatArray | None = None  # of the matrix, while the iterative solver is in charge

    @property
    def preparations(self) -> int:
        """Times that the iterative solver was prepared for a matrix."""
        return 0 if self._iterative is None else self._iterative.factorizations

    def factor(self, data: FloatArray) -> None:
        """Prepare for the matrix with these entries.

        Raises
        ------
        SingularMatrixError
            The matrix is not positive definite.
        """
        self._data = None
        if self._iterative is not None:
            try:
                self._iterative.factor(data, symmetric=True)
                self._data = data
                return
            except SingularMatrixError as error:
                _log.debug("two-level solver: %s", error)
        self._direct.factor(data, symmetric=True)

    def solve(self, right: FloatArray) -> FloatArray:
        """Solve for one or more right-hand sides; (6 n,) or (6 n, k).

        Raises
        ------
        SingularMatrixError
            The matrix is not positive definite.
        """
        if self._iterative is not None and self._data is not None:
            try:
                return self._iterative.solve(right)
            except SingularMatrixError as error:
                _log.debug("two-level solver: %s", error)
                self._direct.factor(self._data, symmetric=True)
                self._data = None
        return self._direct.solve(right)

    def apply(self, right: FloatArray) -> FloatArray:
        """One application of the preconditioner, or of the direct factorization; (6 n,) -> (6 n,)."""
        if self._iterative is not None and self._data is not None:
            return self._iterative.apply(right)
        return self._direct.apply(right)

    def apply_with_product(self, right: FloatArray) -> tuple[FloatArray, FloatArray]:
        """:meth:`apply`, and the matrix times its result, which costs a direct solver nothing."""
        found = self.apply(right)
        if self._iterative is not None and self._data is not None:
            return found, self._iterative.product(found)
        return found, right
