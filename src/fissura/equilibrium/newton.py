"""Nonlinear solution of one step under indirect control (theory section 7).

Unknowns are the displacements and the load multiplier; a constraint is added to equilibrium. Newton's method with the
consistent tangent goes first; its linear equations are solved only as exactly as the step needs it (Dembo, Eisenstat &
Steihaug 1982). Where it fails, bursts of corrections with a mixture of tangent and secant stiffness alternate with
further attempts.
"""

import logging
from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray
from fissura.equilibrium import limits
from fissura.equilibrium.constraint import Constraint, holding
from fissura.equilibrium.corrections import StepEquations, Trial
from fissura.equilibrium.memory import SolverMemory
from fissura.equilibrium.response import dissipation
from fissura.equilibrium.settled import Equilibrium
from fissura.equilibrium.system import System
from fissura.equilibrium.tangent import TangentSolver
from fissura.linear.protocol import SingularMatrixError

_log = logging.getLogger(__name__)


class StepSolver:
    """Solves for equilibrium under a constraint.

    Parameters
    ----------
    tolerance : float
        Largest relative force residual and energy error.
    max_iterations : int
        Iterations after which a step is given up.
    """

    def __init__(self, tolerance: float, max_iterations: int) -> None:
        self.tolerance = tolerance
        self.max_iterations = max_iterations
        self.linear_iterations = 0
        self._tangent: TangentSolver | None = None

    def solve(
        self,
        system: System,
        history: FloatArray,
        constraint: Constraint,
        guess: tuple[FloatArray, float],
        load_scale: float,
        *,
        patience: int = 1,
    ) -> Equilibrium | None:
        """Find equilibrium.

        Parameters
        ----------
        system : System
            Equations.
        history : (k, h) array
            Accepted history.
        constraint : Constraint
            How far to go.
        guess : ((6 n,) array, float)
            Displacements and load multiplier to begin with.
        load_scale : float
            Load below which residuals are no longer measured against the current load [N].
        patience : int
            Factor on the largest number of iterations. Where a crack jumps there is no equilibrium nearby; the
            corrections follow the jump, but slowly.

        Returns
        -------
        Equilibrium or None
            None when no equilibrium was found.
        """
        tangent = self._of(system)
        counted = tangent.iterations
        equations = StepEquations(system, tangent, history, load_scale, self.tolerance)
        search = _Search(equations, constraint, patience * self.max_iterations)
        trial = search.found(equations.trial(guess[0].copy(), guess[1]))
        self.linear_iterations = tangent.iterations - counted
        if trial is None:
            return None
        value = search.constraint.value
        if not search.constraint.prescribed:
            value = system.value(trial.response.u, trial.load)
        residual = trial.size / equations.reference(trial.load)
        iterations = patience * self.max_iterations - search.left
        return Equilibrium(trial.response, trial.load, value, residual, trial.energy, iterations)

    def _of(self, system: System) -> TangentSolver:
        if self._tangent is None or self._tangent.system is not system:
            self._tangent = TangentSolver(system)
        return self._tangent

    def memory(self, system: System) -> SolverMemory:
        """What decides the last bits of the next solution for a system."""
        return self._of(system).memory

    def restore(self, system: System, memory: SolverMemory) -> None:
        """Go on with a system as when this was its memory.

        Raises
        ------
        SingularMatrixError
            The structure is a mechanism.
        """
        self._tangent = TangentSolver(system)
        self._tangent.restore(memory)


@dataclass
class _Search:
    """One search for the equilibrium of a step.

    Attributes
    ----------
    equations : StepEquations
        What is to be solved.
    constraint : Constraint
        How far to go: what was asked for, or where energy leads, contacts that are held instead.
    left : int
        Corrections that may still be made.
    """

    equations: StepEquations
    constraint: Constraint
    left: int

    def found(self, trial: Trial) -> Trial | None:
        """Equilibrium from a state on; None where it is not found, or not as far as asked for."""
        asked, bursts = self.constraint, 0
        while self.left > 0:
            after = self._newton_phase(trial)
            if self._converged(after):
                trial = after
                break
            # A stalled Newton iteration may have left the path: go on from where it began unless it did well.
            trial = after if after.size < limits.DID_WELL * trial.size else trial
            begun = trial
            try:
                trial, bursts = self._burst(trial, bursts)
            except SingularMatrixError as error:
                _log.debug("mixed stiffness: %s", error)
                return None
            if asked.in_energy and not self._converged(trial):
                held = holding(self.equations.system, begun.response, trial.response)
                self.constraint = held or asked
        return trial if self._converged(trial) and self._is_as_far_as(asked, trial) else None

    def _converged(self, trial: Trial) -> bool:
        return self.equations.converged(trial, self.constraint)

    def _is_as_far_as(self, asked: Constraint, trial: Trial) -> bool:
        """Whether a state dissipated what was asked for where energy leads, at least about.

        It may have been found while contacts were held, or contacts that closed have only stored work.
        """
        if asked.begun is None:
            return True
        if asked is not self.constraint:
            share = 1.0 - asked.gap(trial.response.u, trial.load) / asked.scale
            if not limits.NEAREST <= share <= limits.FARTHEST:
                return False
        spent, _ = dissipation(self.equations.system, asked.begun, trial.response)
        return float(spent.sum()) >= limits.NEAREST * asked.scale

    def _newton_phase(self, trial: Trial) -> Trial:
        """Newton iterations until they converge or stall."""
        # Against the least residual so far: an iteration that alternates between two states stalls as well.
        stalls, least = 0, trial.size
        while self.left > 0 and not self._converged(trial) and stalls < limits.STALLS:
            self.left -= 1
            try:
                following = self.equations.newton(trial, self.constraint)
            except SingularMatrixError as error:
                _log.debug("Newton: %s", error)
                return trial
            if following.size <= limits.HARDLY * least:
                stalls = 0
            elif following.size > limits.LEAP * trial.size:
                stalls += 1
            least = min(least, following.size)
            if not np.isfinite(following.size) or (following.size > limits.RUNAWAY * trial.size and stalls > 1):
                return trial
            trial = following
        return trial

    def _burst(self, trial: Trial, bursts: int) -> tuple[Trial, int]:
        """Corrections with a mixture of stiffnesses, and how many bursts there have been then.

        A mixture whose equations cannot be solved counts as a burst: the next one has less of the tangent.

        Raises
        ------
        SingularMatrixError
            Not even the equations of the secant stiffness can be solved.
        """
        shares = limits.SHARES_OF_TANGENT
        while True:
            share = shares[min(bursts, len(shares) - 1)] if self.constraint.prescribed else 0.0
            bursts += 1
            try:
                for _ in range(limits.FIRST_BURST * 2 ** (bursts - 1)):
                    if self.left <= 0 or self._converged(trial):
                        break
                    self.left -= 1
                    trial = self.equations.mixed(trial, self.constraint, share)
            except SingularMatrixError as error:
                if share == 0.0:
                    raise
                _log.debug("mixed stiffness, share %g of the tangent: %s", share, error)
                continue
            return trial, bursts
