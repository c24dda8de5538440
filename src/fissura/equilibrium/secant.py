"""The secant stiffness that is prepared for solution, and how much of it contacts had left then."""

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.contact import AppliedLaw, Kinematics
from fissura.equilibrium.memory import SecantMemory
from fissura.equilibrium.response import Response
from fissura.linear.symmetric import SymmetricSolver


def secant_moduli(moduli: FloatArray, damageable: IntArray, intact: FloatArray) -> FloatArray:
    """Moduli of all contacts (m, 3) [Pa] where `damageable` ones (k,) have shares (k, 3) of their elastic ones left."""
    out = moduli.copy()
    out[damageable] *= intact
    return out


class PreparedSecant:
    """Secant stiffness at one state of damage, kept for later states as a preconditioner.

    Parameters
    ----------
    geometry, moduli : Kinematics, (m, 3) array
        All contacts, and their elastic moduli [Pa].
    damageable, law : (k,) array, AppliedLaw
        Those with damage, and their law.
    load, dead : (6 n,) array, (6 n,) array or None
        Forces per unit of the load factor, and those that are kept; None where there are none of these.
    solver : SymmetricSolver
        Solver for secant matrices of these contacts.

    Attributes
    ----------
    count : int
        Preparations so far.
    intact : (k, 3) array
        Shares of their elastic moduli that contacts with damage had left in the latest one.
    unit : (6 n,) array
        Displacements that the unit load causes with that stiffness, more or less.
    unit_forces : (6 n,) array
        Forces that these need exactly.
    """

    def __init__(
        self,
        geometry: Kinematics,
        moduli: FloatArray,
        damageable: IntArray,
        law: AppliedLaw,
        load: FloatArray,
        dead: FloatArray | None,
        solver: SymmetricSolver,
    ) -> None:
        self._geometry, self._moduli, self._damageable, self._law = geometry, moduli, damageable, law
        self._load, self._dead, self._solver = load, dead, solver
        self.count = 0
        self._matrix = -1  # number of the matrix that it prepared
        self.intact: FloatArray = np.empty((0, 3))
        self.unit: FloatArray = np.empty(0)
        self.unit_forces: FloatArray = np.empty(0)
        self._exact = False

    @property
    def ready(self) -> bool:
        """Whether the solver has been prepared and not been used for another matrix since."""
        return self._matrix == self._solver.matrices

    def is_for(self, history: FloatArray) -> bool:
        """Whether it is prepared for the damage of a history: to prepare again would change nothing."""
        return self.ready and np.array_equal(self._law.intact(history), self.intact)

    def solve(self, history: FloatArray) -> FloatArray:
        """Displacements under the unit load with given damage, (6 n,).

        Raises
        ------
        SingularMatrixError
            The structure is a mechanism.
        """
        self._factor(history)
        if not self._exact:
            self.unit, self.unit_forces, self._exact = self._solver.solve(self._load), self._load, True
        return self.unit

    def dead(self, history: FloatArray) -> FloatArray:
        """Displacements under the forces that are kept with given damage, (6 n,); there must be some.

        Raises
        ------
        SingularMatrixError
            The structure is a mechanism.
        """
        self._factor(history)
        assert self._dead is not None
        return self._solver.solve(self._dead)

    def prepare(self, response: Response, load: float) -> None:
        """Prepare for the damage of a state near equilibrium with a load.

        Damage is such that secant stiffness times displacements are the internal forces: where no other loads act, the
        displacements under the unit load are known without solving.

        Raises
        ------
        SingularMatrixError
            The structure is a mechanism.
        """
        if load == 0.0 or not np.isfinite(load) or self._dead is not None:
            self.solve(response.history)
            return
        self._factor(response.history)
        self.unit, self.unit_forces, self._exact = response.u / load, response.forces / load, False

    def _factor(self, history: FloatArray) -> None:
        """Prepare the solver; does nothing when it is prepared for this damage."""
        if not self.is_for(history):
            self._factor_for(self._law.intact(history))

    def _factor_for(self, intact: FloatArray) -> None:
        """Prepare the solver for what contacts have left, (k, 3)."""
        self._solver.factor_contacts(self._geometry, secant_moduli(self._moduli, self._damageable, intact))
        self._matrix = self._solver.matrices
        self.count += 1
        self.intact, self._exact = intact, False

    @property
    def memory(self) -> SecantMemory | None:
        """What it was prepared for; None where it has to be prepared anew."""
        if not self.ready:
            return None
        return SecantMemory(self.intact, self.unit, self.unit_forces, self._exact, self._solver.took_over)

    def restore(self, memory: SecantMemory) -> None:
        """Prepare as it was when this was its memory."""
        self._factor_for(memory.intact)
        if memory.direct:
            self._solver.take_over("as it did before")
        self.unit, self.unit_forces, self._exact = memory.unit, memory.unit_forces, memory.exact

    def apply(self, right: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Approximate displacements for given forces, and the forces that these need exactly; (6 n,) -> (6 n,) each."""
        return self._solver.apply_with_product(right)
