"""Newton's linear equations, solved by GMRES with a secant stiffness as the preconditioner.

The consistent tangent differs from a secant stiffness in the contacts whose damage grows, or has grown since the secant
stiffness was prepared. These are few, and so are the iterations that they cost; a preparation therefore serves many
Newton iterations and steps.
"""

import numpy as np

from fissura.arrays import FloatArray
from fissura.contact import add_stiffness
from fissura.equilibrium import limits
from fissura.equilibrium.constraint import Constraint
from fissura.equilibrium.memory import SolverMemory
from fissura.equilibrium.response import Response
from fissura.equilibrium.system import System
from fissura.equilibrium.with_damage import changes
from fissura.linear.krylov import dot, gmres, norm
from fissura.linear.protocol import SingularMatrixError


class TangentSolver:
    """Solves for Newton corrections of displacements and load.

    Parameters
    ----------
    system : System
        Equations; its prepared secant stiffness is the preconditioner.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self.iterations = 0  # of GMRES, in all
        self._preparation = -1  # for which the following two hold
        self._fresh: int | None = None
        self._excess = 0
        self._usual = 0  # iterations that the last preparation needed when it was fresh

    @property
    def memory(self) -> SolverMemory:
        """What decides the last bits of the next solutions."""
        secant = self.system.prepared
        known = self._preparation == secant.count
        fresh, excess = (self._fresh, self._excess) if known else (None, 0)
        return SolverMemory(secant.memory, fresh, excess, self._usual)

    def restore(self, memory: SolverMemory) -> None:
        """Go on as when this was its memory.

        Raises
        ------
        SingularMatrixError
            The structure is a mechanism.
        """
        if memory.secant is not None:
            self.system.prepared.restore(memory.secant)
        self._preparation = self.system.prepared.count
        self._fresh, self._excess, self._usual = memory.fresh, memory.excess, memory.usual

    def _renew(self, response: Response, load: float) -> None:
        """Prepare the secant stiffness where that has become worth its cost."""
        secant = self.system.prepared
        if not secant.ready or (self._preparation == secant.count and self._excess > limits.PREPARATION):
            secant.prepare(response, load)
        if self._preparation != secant.count:
            self._preparation, self._fresh, self._excess = secant.count, None, 0

    def solve(
        self,
        response: Response,
        stiffness: FloatArray,
        load: float,
        residual: FloatArray,
        constraint: Constraint,
        gap: float,
        tolerance: float,
    ) -> tuple[FloatArray, float]:
        """Correction of displacements and load for a residual of forces and a gap of the constraint.

        Parameters
        ----------
        response : Response
            State to be corrected.
        stiffness : (k, 3, 3) array
            Stiffness ``ds/de`` of the contacts with damage that the correction is to go by [Pa].
        load : float
            Load multiplier of the response.
        residual : (6 n,) array
            Forces out of balance.
        constraint : Constraint
            The equation for the load.
        gap : float
            What is missing there.
        tolerance : float
            Share of the residual that may be left.

        Raises
        ------
        SingularMatrixError
            The equations cannot be solved.
        """
        self._renew(response, load)
        found = self._minimize(stiffness, residual, constraint, gap, tolerance)
        if found is None and not self.system.prepared.is_for(response.history):
            self._excess = limits.PREPARATION + 1
            self._renew(response, load)
            found = self._minimize(stiffness, residual, constraint, gap, tolerance)
        if found is None:
            raise SingularMatrixError("GMRES does not reduce the residual of the tangent equations")
        return found

    def _minimize(
        self,
        stiffness: FloatArray,
        residual: FloatArray,
        constraint: Constraint,
        gap: float,
        tolerance: float,
    ) -> tuple[FloatArray, float] | None:
        system = self.system
        secant, geometry = system.prepared, system.geometry
        unit, weights, load = secant.unit, system.weights, system.load
        chosen, change = changes(
            stiffness, secant.intact, system.moduli, system.damageable, limits.SAME_STIFFNESS * system.stiffest
        )
        a, b = constraint.vector, constraint.load_factor
        # A prescribed load closes its gap alone.
        reach, b = (b, 0.0) if constraint.by_force else (dot(a, unit), b)
        if not np.isfinite(reach) or reach == 0.0:
            raise SingularMatrixError("the load does not move what is controlled")
        off = secant.unit_forces - load
        # The constraint's equation counts as the force that the load would need to close its gap.
        scale = norm(weights * load) / abs(reach)

        def operator(v: FloatArray) -> tuple[FloatArray, FloatArray]:
            z, image = secant.apply(v[:-1] / weights)
            more = (v[-1] / scale - dot(a, z)) / reach
            move, out = np.empty_like(v), np.empty_like(v)
            np.multiply(unit, more, out=move[:-1])
            move[:-1] += z
            move[-1] = more
            image += more * off
            add_stiffness(geometry, chosen, change, move[:-1].reshape(-1, 6), image.reshape(-1, 6))
            np.multiply(weights, image, out=out[:-1])
            out[-1] = v[-1] + scale * b * more
            return move, out

        # The gap is closed first, as far as the load takes no part in the constraint exactly.
        more = gap / reach
        right = residual - more * off
        if gap != 0.0:
            add_stiffness(geometry, chosen, -change, (more * unit).reshape(-1, 6), right.reshape(-1, 6))
        found = gmres(
            operator, np.append(weights * right, -scale * b * more), tolerance, limits.MOST_ITERATIONS, system.threads
        )
        self.iterations += found.iterations
        if self._fresh is None:
            # One that was given up does not tell what a fresh preparation needs: counted as that, no later one would
            # ever exceed it, and the preparation would stay for good.
            self._fresh = found.iterations if found.reduction <= tolerance else self._usual
            self._usual = self._fresh
        self._excess += max(found.iterations - self._fresh, 0)
        if not found.reduction < limits.USELESS or not np.isfinite(found.solution).all():
            return None
        return found.solution[:-1] + more * unit, float(found.solution[-1]) + more
