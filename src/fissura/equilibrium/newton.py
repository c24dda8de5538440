"""Nonlinear solution of one step under indirect control (theory section 7).

Unknowns are the displacements and the load multiplier; a constraint is added to equilibrium. Newton's method with the
consistent tangent goes first; its linear equations are solved only as exactly as the step needs it (Dembo, Eisenstat &
Steihaug 1982). Where it fails, bursts of corrections with a mixture of tangent and secant stiffness alternate with
further attempts.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fissura.contact import contact_strains
from fissura.equilibrium.constraint import Constraint, holding
from fissura.equilibrium.memory import SolverMemory
from fissura.equilibrium.system import Response, System
from fissura.equilibrium.tangent import TangentSolver
from fissura.linear.krylov import dot, norm
from fissura.linear.protocol import SingularMatrixError

__all__ = ["Equilibrium", "Norms", "StepSolver", "reach_of", "settle"]

FloatArray = NDArray[np.float64]
_log = logging.getLogger(__name__)

#: Smallest part of a correction that the line search tries.
_SMALLEST_CUT = 1.0 / 16.0

#: Corrections of Newton that hardly reduce the residual before it is left.
_STALLS = 2

#: What then goes on: a mixture of tangent and secant stiffness, with these shares of the tangent in one burst after
#: another, the last one repeated; a burst takes twice as many corrections as the one before. With much of the tangent
#: most jumps of a crack take few corrections, but some never end; the secant stiffness always comes closer, slowly
#: (`benchmarks/nonlinear.py`).
_SHARES_OF_TANGENT = (0.9, 0.7, 0.5, 0.0)
_FIRST_BURST = 4

#: Share of the residual to which Newton must come for its result to be kept.
_DID_WELL = 0.5

#: Shares of the energy asked for within which a state that was found while contacts were held is taken.
_NEAREST, _FARTHEST = 0.1, 10.0

#: Share of the residual that Newton's linear equations may leave: half of what would be in equilibrium, within limits.
_LEAST_EXACT, _MOST_EXACT = 0.1, 1e-3


class UnmovedGaugeError(SingularMatrixError):
    """The load does not move the controlled quantity."""


@dataclass(frozen=True)
class Norms:
    """Measures of disequilibrium.

    Attributes
    ----------
    force : float
        Norm of the residual over that of the load.
    displacement : float
        Norm of the last correction over that of the displacements.
    energy : float
        Work of the residual on the last correction over that of the load on the displacements.
    """

    force: float = np.inf
    displacement: float = np.inf
    energy: float = np.inf


@dataclass(frozen=True)
class Equilibrium:
    """A state of equilibrium.

    Attributes
    ----------
    response : Response
        Displacements, strains, tractions, history.
    load : float
        Load multiplier [N].
    value : float
        Controlled quantity ``g . u`` [m].
    norms : Norms
        How well it is in equilibrium.
    iterations : int
        Nonlinear iterations it took.
    """

    response: Response
    load: float
    value: float
    norms: Norms = field(default_factory=Norms)
    iterations: int = 0


#: Controlled quantity, over the displacements of which it is the difference, that solutions cannot tell from zero.
_UNMOVED = 1e-9


#: Linear solutions after which contacts that still open and close are left to the next step.
_CLOSINGS = 20


@dataclass
class _Trial:
    """A state on the way to equilibrium."""

    response: Response
    load: float
    residual: FloatArray
    size: float
    displacement: float = np.inf
    energy: float = np.inf


def reach_of(control: FloatArray, unit: FloatArray) -> float:
    """Controlled quantity per unit load, from its coefficients and the displacements under the unit load, (6 n,) each.

    Raises
    ------
    UnmovedGaugeError
        The load does not move it, but for round-off.
    """
    reach = dot(control, unit)
    if not np.isfinite(reach) or abs(reach) <= _UNMOVED * float(np.abs(control * unit).sum()):
        raise UnmovedGaugeError("the load does not move the controlled quantity")
    return reach


def settle(system: System, history: FloatArray, value: float) -> Equilibrium:
    """Solution with the damage that is there: the controlled quantity takes the given value, other loads are kept.

    Used for the first elastic state, and to find the state of the last accepted step on a new discretization. It is
    linear but for contacts that open or close, under laws for which these differ: they are found one linear solution
    after another.

    Raises
    ------
    SingularMatrixError
        The structure is a mechanism.
    UnmovedGaugeError
        The load does not move the controlled quantity, but for round-off.
    """
    for iterations in range(1, _CLOSINGS + 1):
        unit = system.prepared.solve(history)
        dead = None if system.dead is None else system.prepared.dead(history)
        reach, missing = 1.0, value
        if not system.by_force:
            reach = reach_of(system.control, unit)
            missing = value if dead is None else value - dot(system.control, dead)
        load = missing / reach
        u = unit * load if dead is None else unit * load + dead
        strain = contact_strains(system.geometry, u.reshape(-1, 6))
        moved = system.law.unloaded(strain[system.active], history)
        if system.prepared.is_for(moved) or iterations == _CLOSINGS:
            break
        history = moved
    traction = strain * system.moduli
    traction[system.active] *= system.law.intact(history)
    response = Response(u, strain, traction, history, system.internal(traction, u))
    return Equilibrium(response, load, value, iterations=iterations)


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
        self._system, self._history, self._constraint, self._scale = system, history, constraint, load_scale
        counted = tangent.iterations
        found = self._solve(guess, patience)
        self.linear_iterations = tangent.iterations - counted
        return found

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

    def _solve(self, guess: tuple[FloatArray, float], patience: int) -> Equilibrium | None:
        system = self._system
        self._load_size = norm(system.weights * system.load)
        self._dead_size = 0.0 if system.dead is None else norm(system.weights * system.dead)
        self._left = patience * self.max_iterations
        trial = self._try(guess[0].copy(), guess[1])
        asked, bursts = self._constraint, 0
        while self._left > 0:
            after = self._newton_phase(trial)
            if self._converged(after):
                trial = after
                break
            # A stalled Newton iteration may have left the path: go on from where it began unless it did well.
            trial = after if after.size < _DID_WELL * trial.size else trial
            begun = trial
            try:
                trial, bursts = self._burst(trial, bursts)
            except SingularMatrixError as error:
                _log.debug("mixed stiffness: %s", error)
                return None
            if asked.in_energy and not self._converged(trial):
                self._constraint = holding(self._system, begun.response, trial.response) or asked
        if not self._converged(trial) or not self._near(asked, trial) or not self._dissipates(asked, trial):
            return None
        norms = Norms(trial.size / self._reference(trial.load), trial.displacement, trial.energy)
        iterations = patience * self.max_iterations - self._left
        constraint = self._constraint
        value = constraint.value if constraint.prescribed else system.value(trial.response.u, trial.load)
        return Equilibrium(trial.response, trial.load, value, norms, iterations)

    def _burst(self, trial: _Trial, bursts: int) -> tuple[_Trial, int]:
        """Corrections with a mixture of stiffnesses, and how many bursts there have been then.

        A mixture whose equations cannot be solved counts as a burst: the next one has less of the tangent.

        Raises
        ------
        SingularMatrixError
            Not even the equations of the secant stiffness can be solved.
        """
        while True:
            share = _SHARES_OF_TANGENT[min(bursts, len(_SHARES_OF_TANGENT) - 1)]
            share = share if self._constraint.prescribed else 0.0
            bursts += 1
            try:
                for _ in range(_FIRST_BURST * 2 ** (bursts - 1)):
                    if self._left <= 0 or self._converged(trial):
                        break
                    self._left -= 1
                    trial = self._mixed(trial, share)
            except SingularMatrixError as error:
                if share == 0.0:
                    raise
                _log.debug("mixed stiffness, share %g of the tangent: %s", share, error)
                continue
            return trial, bursts

    def _near(self, asked: Constraint, trial: _Trial) -> bool:
        """Whether a state found while contacts were held is about as far as was asked for."""
        if asked is self._constraint:
            return True
        share = 1.0 - asked.gap(trial.response.u, trial.load) / asked.scale
        return _NEAREST <= share <= _FARTHEST

    def _dissipates(self, asked: Constraint, trial: _Trial) -> bool:
        """Whether energy, where it leads, was dissipated, and not only work stored by contacts that closed."""
        if asked.begun is None:
            return True
        spent = float(self._system.dissipated(asked.begun, trial.response).sum())
        return spent >= _NEAREST * asked.scale

    def _newton_phase(self, trial: _Trial) -> _Trial:
        """Newton iterations until they converge or stall."""
        # Against the least residual so far: an iteration that alternates between two states stalls as well.
        stalls, least = 0, trial.size
        while self._left > 0 and not self._converged(trial) and stalls < _STALLS:
            self._left -= 1
            try:
                following = self._newton(trial)
            except SingularMatrixError as error:
                _log.debug("Newton: %s", error)
                return trial
            if following.size <= 0.7 * least:
                stalls = 0
            elif following.size > 0.1 * trial.size:  # a leap that is made up for at once is one stall, not two
                stalls += 1
            least = min(least, following.size)
            if not np.isfinite(following.size) or (following.size > 10.0 * trial.size and stalls > 1):
                return trial
            trial = following
        return trial

    def _reference(self, load: float) -> float:
        return max(self._load_size * max(abs(load), self._scale), self._dead_size)

    def _converged(self, trial: _Trial) -> bool:
        """Force and energy within tolerance, and the constraint met."""
        return (
            trial.size <= self.tolerance * self._reference(trial.load)
            and trial.energy <= self.tolerance
            and self._constraint.met(trial.response.u, trial.load)
        )

    def _try(self, u: FloatArray, load: float) -> _Trial:
        response = self._system.response(u, self._history)
        residual = self._system.external(load) - response.forces
        return _Trial(response, load, residual, norm(self._system.weights * residual))

    def _measured(self, trial: _Trial, before: _Trial) -> _Trial:
        """Fill in the norms that need the correction."""
        step = trial.response.u - before.response.u
        trial.displacement = norm(step) / max(norm(trial.response.u), 1e-300)
        trial.energy = abs(dot(trial.residual, step)) / max(self._work(trial), 1e-300)
        return trial

    def _work(self, trial: _Trial) -> float:
        """Work of the loads on the displacements, and at least that of the least load that counts."""
        system, u = self._system, trial.response.u
        work = abs(trial.load * dot(system.load, u))
        if system.dead is not None:
            work += abs(dot(system.dead, u))
        return max(work, self._scale**2 * abs(dot(system.load, system.prepared.unit)))

    def _corrected(self, trial: _Trial, stiffness: FloatArray, constraint: Constraint) -> tuple[FloatArray, float]:
        """Correction of displacements and load that goes by a stiffness of the contacts with damage."""
        assert self._tangent is not None
        gap = constraint.gap(trial.response.u, trial.load)
        wanted = self.tolerance * self._reference(trial.load) / max(trial.size, 1e-300)
        # Where energy leads, the equations are nearly singular wherever damage localizes.
        least = _LEAST_EXACT if constraint.prescribed else _MOST_EXACT
        exactness = min(max(0.5 * wanted, _MOST_EXACT), least)
        du, more = self._tangent.solve(
            trial.response, stiffness, trial.load, trial.residual, constraint, gap, exactness
        )
        if not np.isfinite(du).all():
            raise SingularMatrixError("the stiffness is singular")
        return du, more

    def _newton(self, trial: _Trial) -> _Trial:
        system, constraint = self._system, self._constraint
        tangent = system.law.tangent(trial.response.strain[system.active], self._history)
        du, more = self._corrected(trial, tangent, constraint)
        best: _Trial | None = None
        cut = 1.0
        while cut >= _SMALLEST_CUT:
            following = self._try(trial.response.u + cut * du, trial.load + cut * more)
            if best is None or following.size < best.size:
                best = following
            if best.size < (1.0 - 0.1 * cut) * trial.size or not constraint.met(trial.response.u, trial.load):
                break
            cut *= 0.5
        assert best is not None
        return self._measured(best, trial)

    def _mixed(self, trial: _Trial, share: float) -> _Trial:
        """Correction with a share of the tangent stiffness, the rest of it secant stiffness.

        Where the controlled quantity is not prescribed, the share is 0.
        """
        system, constraint = self._system, self._constraint
        stiffness = system.secant_stiffness(trial.response.history)[system.active]
        if constraint.in_energy:
            # Unloading with the secant stiffness dissipates nothing: the displacement is kept instead, so that damage
            # runs away slowly where it localizes; any share of the tangent would make that a leap.
            kept = dot(constraint.vector, trial.response.u)
            constraint = Constraint(constraint.vector, 0.0, kept, 1.0, abs(kept))
        elif share > 0.0:
            tangent = system.law.tangent(trial.response.strain[system.active], self._history)
            stiffness += share * (tangent - stiffness)
        du, more = self._corrected(trial, stiffness, constraint)
        return self._measured(self._try(trial.response.u + du, trial.load + more), trial)
