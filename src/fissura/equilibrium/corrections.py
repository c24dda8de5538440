"""Equations of a step: states on the way to equilibrium, how far they are from it, and corrections of them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fissura.arrays import FloatArray
from fissura.equilibrium import limits
from fissura.equilibrium.constraint import Constraint
from fissura.equilibrium.response import Response
from fissura.equilibrium.system import System
from fissura.equilibrium.tangent import TangentSolver
from fissura.linear.krylov import dot, norm
from fissura.linear.protocol import SingularMatrixError


@dataclass(frozen=True)
class Trial:
    """A state on the way to equilibrium.

    Attributes
    ----------
    response, load : Response, float
        The state.
    residual, size : (6 n,) array, float
        Forces out of balance, and their weighted norm.
    energy : float
        Work of the residual on the correction that led here, over that of the loads; infinite where none did.
    """

    response: Response
    load: float
    residual: FloatArray
    size: float
    energy: float = np.inf


@dataclass(frozen=True)
class StepEquations:
    """Equilibrium from a given history on.

    Attributes
    ----------
    system : System
        Equations of the discretization.
    tangent : TangentSolver
        Solver for corrections of these.
    history : (k, h) array
        Accepted history.
    load_scale : float
        Load below which residuals are no longer measured against the current load [N].
    tolerance : float
        Largest relative force residual and energy error.
    """

    system: System
    tangent: TangentSolver
    history: FloatArray
    load_scale: float
    tolerance: float

    @cached_property
    def _load_size(self) -> float:
        return norm(self.system.weights * self.system.load)

    @cached_property
    def _dead_size(self) -> float:
        return 0.0 if self.system.dead is None else norm(self.system.weights * self.system.dead)

    def reference(self, load: float) -> float:
        """What the size of residuals is measured against under a load."""
        return max(self._load_size * max(abs(load), self.load_scale), self._dead_size)

    def converged(self, trial: Trial, constraint: Constraint) -> bool:
        """Whether force and energy are within tolerance, and the constraint is met."""
        return (
            trial.size <= self.tolerance * self.reference(trial.load)
            and trial.energy <= self.tolerance
            and constraint.met(trial.response.u, trial.load)
        )

    def trial(self, u: FloatArray, load: float, before: Trial | None = None) -> Trial:
        """A state, (6 n,) and a load; with its error of energy if a correction of another one led there."""
        response = self.system.response(u, self.history)
        residual = self.system.external(load) - response.forces
        size = norm(self.system.weights * residual)
        if before is None:
            return Trial(response, load, residual, size)
        return Trial(response, load, residual, size, self._energy(response, load, residual, before))

    def _energy(self, response: Response, load: float, residual: FloatArray, before: Trial) -> float:
        """Work of the residual over that of the loads, and at least that of the least load that counts."""
        system, u = self.system, response.u
        work = abs(load * dot(system.load, u))
        if system.dead is not None:
            work += abs(dot(system.dead, u))
        work = max(work, self.load_scale**2 * abs(dot(system.load, system.prepared.unit)))
        return abs(dot(residual, u - before.response.u)) / max(work, 1e-300)

    def newton(self, trial: Trial, constraint: Constraint) -> Trial:
        """Correction with the tangent stiffness, cut where it does not reduce the residual.

        Raises
        ------
        SingularMatrixError
            Its equations cannot be solved.
        """
        tangent = self.system.law.tangent(trial.response.strain[self.system.damageable], self.history)
        du, more = self._corrected(trial, tangent, constraint)
        best: Trial | None = None
        cut = 1.0
        while cut >= limits.SMALLEST_CUT:
            following = self.trial(trial.response.u + cut * du, trial.load + cut * more, trial)
            if best is None or following.size < best.size:
                best = following
            enough = best.size < (1.0 - limits.LEAST_GAIN * cut) * trial.size
            if enough or not constraint.met(trial.response.u, trial.load):
                break
            cut *= 0.5
        assert best is not None
        return best

    def mixed(self, trial: Trial, constraint: Constraint, share: float) -> Trial:
        """Correction with a share of the tangent stiffness, the rest of it secant stiffness.

        Where the controlled quantity is not prescribed, the share is 0.

        Raises
        ------
        SingularMatrixError
            Its equations cannot be solved.
        """
        system = self.system
        stiffness = np.zeros((len(system.damageable), 3, 3))
        stiffness[:, range(3), range(3)] = system.moduli[system.damageable] * system.law.intact(trial.response.history)
        if constraint.in_energy:
            # Unloading with the secant stiffness dissipates nothing: the displacement is kept instead, so that damage
            # runs away slowly where it localizes; any share of the tangent would make that a leap.
            kept = dot(constraint.vector, trial.response.u)
            constraint = Constraint(constraint.vector, 0.0, kept, 1.0, abs(kept))
        elif share > 0.0:
            tangent = system.law.tangent(trial.response.strain[system.damageable], self.history)
            stiffness += share * (tangent - stiffness)
        du, more = self._corrected(trial, stiffness, constraint)
        return self.trial(trial.response.u + du, trial.load + more, trial)

    def _corrected(self, trial: Trial, stiffness: FloatArray, constraint: Constraint) -> tuple[FloatArray, float]:
        """Correction of displacements and load that goes by a stiffness of the contacts with damage."""
        gap = constraint.gap(trial.response.u, trial.load)
        wanted = self.tolerance * self.reference(trial.load) / max(trial.size, 1e-300)
        least = limits.LEAST_EXACT if constraint.prescribed else limits.MOST_EXACT
        exactness = min(max(limits.EXACTNESS * wanted, limits.MOST_EXACT), least)
        du, more = self.tangent.solve(trial.response, stiffness, trial.load, trial.residual, constraint, gap, exactness)
        if not np.isfinite(du).all():
            raise SingularMatrixError("the stiffness is singular")
        return du, more
