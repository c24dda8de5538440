"""What follows from a case and the state of its run: kept from one step to the next, and made again where it is not."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fissura.case import Case, LoadingStage
from fissura.equilibrium import Leading, Leg, PathFollower, StepSolver, System
from fissura.simulation.discretization import Discretization
from fissura.simulation.found import Found, snapshot_of
from fissura.simulation.legs import ahead, planned_legs
from fissura.simulation.step import Snapshot

if TYPE_CHECKING:
    from fissura.simulation.state import State


class Model:
    """A specimen with its equations and solvers.

    Parameters
    ----------
    case : Case
        What to do.
    discretization : Discretization
        Its specimen.

    Attributes
    ----------
    case, discretization : Case, Discretization
        As given.
    legs : tuple of Planned
        The loading programme.
    solver : StepSolver
        Solves for the equilibrium of a step.
    """

    def __init__(self, case: Case, discretization: Discretization) -> None:
        self.case, self.discretization = case, discretization
        self.legs = planned_legs(case, discretization.conditions)
        self.solver = StepSolver(case.main.tolerance, case.main.max_iterations)
        self._state: State | None = None  # that everything here belongs to

    @property
    def system(self) -> System:
        """Equations of the current discretization."""
        return self.discretization.system

    def stage(self, state: State) -> LoadingStage:
        """The stage that a state belongs to."""
        return self.legs[0 if state.leg is None else state.leg.index].stage

    def follower(self, state: State, limit: float = math.inf, *, memory: Leading | None = None) -> PathFollower:
        """What chooses the next step of a state's leg.

        Parameters
        ----------
        state : State
            Where the run stands.
        limit : float, optional
            Way at which the first contact comes to its strength.
        memory : Leading, optional
            What it remembers; nothing where the leg begins.
        """
        assert state.leg is not None
        energy = self.case.material.G_t * self.discretization.domain.smallest_section
        stage = self.stage(state)
        self.solver.tolerance, self.solver.max_iterations = stage.tolerance, stage.max_iterations
        return PathFollower(state.leg, stage, energy, limit, memory)

    def ended(self, state: State) -> bool:
        """Whether the run is over: the last leg has ended, or the specimen is broken."""
        if state.leg is None:
            return False
        follower = self.follower(state, memory=state.leading)
        if follower.broken(state.now.load, state.totals.peak):
            return True
        return follower.ended(state.now.value) and self.ahead(state) is None

    def ahead(self, state: State) -> Leg | None:
        """The next leg, where that of a state has ended; None where there is none."""
        self._make(state)
        return ahead(self.legs, self.system, state)

    def done(self, state: State) -> float:
        """Share of the programme that is done, every leg for as much as the others."""
        if state.leg is None:
            return 0.0
        way = state.leg.progress(state.now.value) / state.leg.length
        return (state.leg.index + min(max(way, 0.0), 1.0)) / len(self.legs)

    def at(self, state: State) -> System:
        """The equations of a state."""
        drive, kept = self.discretization.conditions.main, np.zeros_like(state.totals.forces)
        if state.leg is not None and not self.legs[state.leg.index].main:
            drive, kept = self.legs[state.leg.index].drive, state.leg.kept
        self._state = None
        self.discretization.compliance = state.start.compliance
        self.discretization.compliance_error = state.start.compliance_error
        return self.discretization.at(state.layout, drive, kept)

    def snapshot(self, state: State) -> Snapshot:
        """What can be seen in a state, as its step told."""
        system = self.at(state)
        elastic, criterion = self.discretization.assess(state.now.response, state.now.load)
        return snapshot_of(system, Found(state.now, elastic, criterion))

    def begin(self, state: State) -> None:
        """Make everything as it is in a state, until a step from it has ended."""
        self._make(state)
        self._state = None

    def _make(self, state: State) -> None:
        if self._state is state:
            return
        self.solver.restore(self.at(state), state.solver)
        self._state = state

    def end(self, state: State) -> None:
        """A step has led to this state."""
        self._state = state
