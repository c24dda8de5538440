"""What follows from a case and the state of its run: kept from one step to the next, and made again where it is not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fissura.equilibrium import PathFollower, StepSolver, System
from fissura.structure import Structure

if TYPE_CHECKING:
    from fissura.case import Case
    from fissura.equilibrium import Leading
    from fissura.state import State

__all__ = ["Model"]


class Model:
    """A specimen with its equations and solvers.

    Parameters
    ----------
    case : Case
        What to do.
    structure : Structure
        Its specimen.

    Attributes
    ----------
    case, structure : Case, Structure
        As given.
    solver : StepSolver
        Solves for the equilibrium of a step.
    """

    def __init__(self, case: Case, structure: Structure) -> None:
        self.case, self.structure = case, structure
        self.solver = StepSolver(case.control.tolerance, case.control.max_iterations)
        self._state: State | None = None  # that everything here belongs to

    @property
    def system(self) -> System:
        """Equations of the current discretization."""
        return self.structure.system

    def follower(self, limit: float, memory: Leading | None = None) -> PathFollower:
        """What chooses the next step, from :attr:`Start.limit`, and from what it remembers."""
        energy = self.case.material.G_t * self.structure.domain.smallest_section
        return PathFollower(self.case.control, energy, self.case.quantity, limit, memory)

    def ended(self, state: State) -> bool:
        """Whether the run is over."""
        return self.follower(state.start.limit, state.leading).ended(state.now.value, state.now.load, state.totals.peak)

    def begin(self, state: State) -> None:
        """Make everything as it is in a state, until a step from it has ended."""
        if self._state is not state:
            self.structure.compliance = state.start.compliance
            self.solver.restore(self.structure.at(state.layout), state.solver)
        self._state = None

    def end(self, state: State) -> None:
        """A step has led to this state."""
        self._state = state
