"""Solvers for symmetric positive definite matrices: by name, and the one that suits the size of a structure."""

import logging
from collections.abc import Callable

from fissura.arrays import FloatArray
from fissura.case.registry import SOLVERS
from fissura.contact import Kinematics
from fissura.linear import limits
from fissura.linear.assembly import Pattern, assemble_secant
from fissura.linear.direct import MklPardiso, SuperLU, best_solver
from fissura.linear.protocol import LinearSolver, SingularMatrixError
from fissura.linear.two_level import TwoLevel
from fissura.machine.kernel_threads import SINGLE_THREAD, KernelThreads

_log = logging.getLogger(__name__)


def direct(
    form: Pattern, x: FloatArray, tolerance: float, threads: KernelThreads = SINGLE_THREAD
) -> MklPardiso | SuperLU:
    """The fastest direct solver that is installed; it is exact, whatever the tolerance."""
    return best_solver()(form)


def aggregation(form: Pattern, x: FloatArray, tolerance: float, threads: KernelThreads = SINGLE_THREAD) -> LinearSolver:
    """Smoothed aggregation, for comparison; made here, so that only runs that name it load PyAMG."""
    from fissura.linear.amg import SmoothedAggregation

    return SmoothedAggregation(form, x, tolerance)


class SymmetricSolver:
    """Solves with elastic and secant matrices.

    Where an iterative solver does not converge, the direct one takes over for that matrix.

    Parameters
    ----------
    form : Pattern
        Pattern of all matrices to come.
    x : (n, 3) array
        Nuclei [m].
    linear : str
        Name of a solver, or "auto", which chooses by the number of bodies.
    threads : KernelThreads
        Threads.

    Attributes
    ----------
    matrices : int
        Matrices prepared so far.
    """

    def __init__(
        self, form: Pattern, x: FloatArray, linear: str = "auto", threads: KernelThreads = SINGLE_THREAD
    ) -> None:
        if linear == "auto":
            linear = "two-level" if len(x) >= limits.LARGE else "direct"
        self._form, self._x, self._threads = form, x, threads
        self._chosen: LinearSolver = SOLVERS.named(linear)(form, x, limits.TOLERANCE, threads=threads)
        self._direct: LinearSolver | None = self._chosen if linear == "direct" else None
        self._current: LinearSolver = self._chosen
        self._entries: Callable[[], FloatArray]
        self.matrices = 0

    @property
    def factorizations(self) -> int:
        """Preparations so far, those of the direct solver where it had to take over included."""
        count = self._chosen.factorizations
        return count if self._direct in (None, self._chosen) else count + self._direct.factorizations

    def factor(self, data: FloatArray) -> None:
        """Prepare for the matrix with these entries.

        Raises
        ------
        SingularMatrixError
            The matrix is not positive definite.
        """
        self._begin(lambda: data)
        try:
            self._chosen.factor(data, symmetric=True)
        except SingularMatrixError as error:
            self._take_over(error)

    def factor_contacts(self, geometry: Kinematics, moduli: FloatArray) -> None:
        """Prepare for the matrix of contacts with these moduli [Pa], shape (m, 3), and the constant part.

        The two-level solver needs much less memory than with entries of the whole matrix, and less time.

        Raises
        ------
        SingularMatrixError
            The matrix is not positive definite.
        """
        if not isinstance(self._chosen, TwoLevel):
            self.factor(assemble_secant(geometry, self._form, moduli))
            return
        form = self._form  # a reference to the solver would keep both until the collector comes
        self._begin(lambda: assemble_secant(geometry, form, moduli))
        try:
            self._chosen.factor_contacts(geometry, moduli)
        except SingularMatrixError as error:
            self._take_over(error)

    def _begin(self, entries: Callable[[], FloatArray]) -> None:
        """Another matrix; its entries are asked for where a solver needs them."""
        self._entries, self._current = entries, self._chosen
        self.matrices += 1

    def release(self) -> None:
        """Give back the memory of an iterative solver; whoever has prepared it must do so again."""
        if isinstance(self._chosen, TwoLevel):
            self.matrices += 1
            self._chosen.release()

    @property
    def took_over(self) -> bool:
        """Whether the direct solver has taken over from another one for the current matrix."""
        return self._current is not self._chosen

    def _take_over(self, error: SingularMatrixError) -> None:
        """Let the direct solver take over for the current matrix."""
        if self._current is self._direct:
            raise error
        self.take_over(str(error))

    def take_over(self, why: str) -> None:
        """Let the direct solver take over for the current matrix, unless it has.

        Raises
        ------
        SingularMatrixError
            The matrix is not positive definite.
        """
        if self._current is self._direct:
            return
        _log.debug("direct solver takes over: %s", why)
        if self._direct is None:
            self._direct = direct(self._form, self._x, limits.TOLERANCE, self._threads)
        self._current = self._direct
        self._direct.factor(self._entries(), symmetric=True)

    def solve(self, right: FloatArray, tolerance: float | None = None) -> FloatArray:
        """Solve for one or more right-hand sides; (6 n,) or (6 n, k).

        An iterative solver may be given a relative error in the energy norm, other than its own.

        Raises
        ------
        SingularMatrixError
            The matrix is not positive definite.
        """
        try:
            return self._current.solve(right, tolerance)
        except SingularMatrixError as error:
            self._take_over(error)
        return self._current.solve(right, tolerance)

    def apply_with_product(self, right: FloatArray) -> tuple[FloatArray, FloatArray]:
        """One application of the preconditioner, and the matrix times its result; (6 n,) -> (6 n,) each.

        The second costs a direct solver nothing: it is `right`.
        """
        if isinstance(self._current, TwoLevel):
            return self._current.apply_with_product(right)
        found = self._current.apply(right)
        if self._current is self._direct:
            return found, right
        return found, self._form.product(self._entries(), found)
