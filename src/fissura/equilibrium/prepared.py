"""The secant stiffness that is prepared for solution, and how much of it contacts had left then."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fissura.equilibrium.symmetric import SymmetricSolver

if TYPE_CHECKING:
    from fissura.equilibrium.system import System

__all__ = ["PreparedSecant"]

FloatArray = NDArray[np.float64]


class PreparedSecant:
    """Secant stiffness at one state of damage, kept for later states as a preconditioner.

    Parameters
    ----------
    system : System
        Equations.
    solver : SymmetricSolver
        Solver for their secant matrices.

    Attributes
    ----------
    count : int
        Preparations so far.
    intact : (k,) array
        ``1 - D`` of the contacts with damage in the latest one.
    unit : (6 n,) array
        Displacements under the unit load with that stiffness.
    """

    def __init__(self, system: System, solver: SymmetricSolver) -> None:
        self._system, self._solver = system, solver
        self.count = 0
        self.intact: FloatArray = np.empty(0)
        self.unit: FloatArray = np.empty(0)

    def prepare(self, history: FloatArray) -> None:
        """Prepare for given damage; does nothing when that is the state of the latest preparation.

        Raises
        ------
        SingularMatrixError
            The structure is a mechanism.
        """
        intact = 1.0 - history[:, 0]
        if self.count > 0 and np.array_equal(intact, self.intact):
            return
        self._solver.factor(self._system.secant(history))
        self.unit = self._solver.solve(self._system.load)
        self.count += 1
        self.intact = intact

    def apply(self, right: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Approximate displacements for given forces, and the forces that these need exactly; (6 n,) -> (6 n,) each."""
        return self._solver.apply_with_product(right)
