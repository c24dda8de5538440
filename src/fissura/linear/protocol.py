"""What linear solvers have in common: preparation for a matrix apart from solution."""

from typing import Protocol

from fissura.arrays import FloatArray


class SingularMatrixError(Exception):
    """The matrix cannot be factorized, or its equations cannot be solved."""


class LinearSolver(Protocol):
    """Solver for matrices of one pattern.

    What depends on the pattern alone is done when it is made, or in the first `factor`. Right-hand sides and solutions
    are in the order of the bodies of the discretization.

    Attributes
    ----------
    factorizations : int
        Calls of `factor`.
    """

    factorizations: int

    def factor(self, data: FloatArray, *, symmetric: bool) -> None:
        """Prepare for the matrix with these entries (all of them, in the order of the pattern).

        Raises
        ------
        SingularMatrixError
            The matrix cannot be factorized.
        """

    def solve(self, right: FloatArray, tolerance: float | None = None) -> FloatArray:
        """Solve for one or more right-hand sides; (6 n,) or (6 n, k).

        Iterative solvers may be given a relative error in the energy norm, other than their own.

        Raises
        ------
        SingularMatrixError
            Their equations cannot be solved.
        """

    def apply(self, right: FloatArray) -> FloatArray:
        """Apply the preconditioner once, for iterations with other matrices; (6 n,) -> (6 n,).

        Of a direct solver this is the solution with the latest factorization.
        """
