"""The loop over steps: equilibrium, criterion, refinement, the same step again (theory section 5).

It yields accepted steps and knows no files.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fissura.adaptivity import ElasticState, transfer_history
from fissura.equilibrium import (
    Equilibrium,
    Goal,
    PathFollower,
    SingularMatrixError,
    StepSolver,
    System,
    UnmovedGaugeError,
    settle,
)
from fissura.errors import InputError, Notice, RunStopped
from fissura.jumps import Jumps
from fissura.memory import within_memory
from fissura.specimen import backward_gauge
from fissura.step import Snapshot, Step
from fissura.stopping import FAILURES, reason, stopping
from fissura.structure import Structure

if TYPE_CHECKING:
    from fissura.case import Case
    from fissura.material.field import RandomField
    from fissura.specimen import Domain
    from fissura.tessellation import Tessellation

__all__ = ["Simulation"]

FloatArray = NDArray[np.float64]
_log = logging.getLogger(__name__)

#: Refinements of one step before the run is given up; each must add bodies, so this only stops a runaway.
_MOST_REFINEMENTS = 60

#: Error of the initial stiffness that is accepted after calibration.
_STIFFNESS_ERROR = 0.02


#: Extrapolation in steps, at most; where energy leads and there is nothing to extrapolate from, the factor on a state
#: for contacts to go on being damaged, and the largest one that a guess may put on the load.
_FARTHEST, _PAST, _PAST_AIM = 4.0, 1.001, 1.2


@dataclass
class _Path:
    """Where the run stands: the last accepted state on the current discretization, and totals."""

    system: System
    now: Equilibrium
    before: Equilibrium | None = None
    limit: float = np.inf  # controlled quantity at which the first contact of the start came to its strength
    number: int = 0
    displacement: float = 0.0  # of the load
    load: float = 0.0
    dissipated: float = 0.0
    dissipated_at: FloatArray | float = 0.0  # at the load, every support, and all of them
    spent: float = 0.0  # energy dissipated in the last step
    in_energy: bool = False  # whether it led there
    aim: FloatArray | None = None  # history that the step being repeated had found before refinement
    work: float = 0.0
    exchanged: float = 0.0  # energy that changes of the discretization put in
    peak: float = 0.0
    # Since the last accepted step, attempts that failed included:
    iterations: int = 0
    linear_iterations: int = 0
    factorizations: int = 0
    refinements: int = 0
    coarsenings: int = 0
    load_change: float = 0.0

    def position(self) -> tuple[int, float]:
        """Number of the next step, and the value of the controlled quantity where it begins [m]."""
        return self.number + 1, self.now.value


class Simulation:
    """One specimen, broken step by step.

    Parameters
    ----------
    case : Case
        What to do.
    full : bool
        Every nucleus is fine from the start: the reference for the adaptive run of the same case.

    Raises
    ------
    InputError
        Something in the case cannot be built.

    Attributes
    ----------
    case, full : Case, bool
        As given.
    bodies_full, bodies_start : int
        Bodies at full resolution, and at the start of this run.
    nuclei_given : int
        Nuclei that a file gave; full resolution has these, and those added to them.
    initial_stiffness : float
        Load over controlled quantity of the elastic structure at the start [N/m]; nan before the first step.
    cpu_repeated, cpu_refining : float
        Processor time so far of solutions that were given up for a refinement, and of refinements: tessellation,
        equations, and settling on them [s].
    """

    def __init__(self, case: Case, *, full: bool = False) -> None:
        self.wall_start, self.cpu_start = time.perf_counter(), time.process_time()
        self.case, self.full = case, full
        with within_memory("discretization.l_f", "the bodies of the specimen", "a larger spacing"):
            self._structure = Structure(case, full=full)
        self.bodies_full = len(self._structure.nuclei)
        self.nuclei_given = self._structure.nuclei.given
        self.bodies_start = len(self.tessellation)
        self.initial_stiffness = float("nan")
        self._met: list[Notice] = []
        self._jumps = Jumps()
        self.cpu_repeated = self.cpu_refining = 0.0

    @property
    def tessellation(self) -> Tessellation:
        """The current discretization."""
        return self._structure.system.tessellation

    @property
    def domain(self) -> Domain:
        """The specimen."""
        return self._structure.domain

    @property
    def field(self) -> RandomField | None:
        """Relative strength as a function of position; None where it is the same everywhere."""
        return self._structure.field

    @property
    def notices(self) -> tuple[Notice, ...]:
        """What looks wrong in the case, and what a run has met so far."""
        return (*self._structure.notices, *self._met, *self._jumps.notices())

    @property
    def elastic_scale(self) -> float:
        """Factor that calibration put on the stiffness of elastic contacts; 1 without calibration."""
        return self._structure.system.elastic_scale

    def _start(self) -> _Path:
        """The unloaded structure; finds the initial stiffness on the way."""
        structure = self._structure
        try:
            system = structure.calibrate()
            unit = settle(system, system.virgin(), 1.0)
        except UnmovedGaugeError as error:
            raise InputError(
                "gauge" if self.case.quantity == "gauge" else "load",
                f"{error}: nothing changes there however large the load is",
                "places that the load moves apart",
            ) from error
        except SingularMatrixError as error:
            raise InputError(
                "supports", f"the structure is a mechanism ({error})", "supports that hold all of the specimen"
            ) from error
        self.initial_stiffness = unit.load
        if self.initial_stiffness < 0.0 and not (structure.compliance or 0.0) > 0.0:
            raise backward_gauge(system.conditions, self.initial_stiffness)
        if structure.compliance is not None:
            off = self.initial_stiffness * structure.compliance - 1.0
            if abs(off) > _STIFFNESS_ERROR:
                kind = f"is {abs(off):.0%} too {'stiff' if off > 0.0 else 'soft'} against full resolution"
                if self.initial_stiffness < 0.0:
                    kind = f"moves the {self.case.quantity} the other way than full resolution does"
                raise InputError(
                    "discretization.l_c",
                    f"{self.case.discretization.l_c:g} m: the start {kind}, more than calibration can mend (it has"
                    f" {self.bodies_start} of {self.bodies_full} bodies)",
                    "a smaller l_c, or a larger adaptivity.r_f (adaptivity.calibrate = false runs it all the same)",
                )
        rest = system.response(np.zeros(system.size), system.virgin())
        used = system.largest_utilisation(unit.response)
        return _Path(system, Equilibrium(rest, 0.0, 0.0), limit=1.0 / used if used > 0.0 else np.inf)

    def steps(self) -> Iterator[Step]:
        """Accepted steps, until the target is reached.

        Yields
        ------
        Step

        Raises
        ------
        RunStopped
            No equilibrium was found even with the smallest step, or a calculation failed; the steps yielded so far are
            valid.
        InputError
            The case is refused before its first step.
        """
        control = self.case.control
        solver = StepSolver(control.tolerance, control.max_iterations)
        with stopping(lambda: (1, 0.0), refusing=True):
            path = self._start()
        energy = self.case.material.G_t * self.domain.smallest_section
        follower = PathFollower(control, energy, self.case.quantity, path.limit)
        while not follower.ended(path.now.value, path.load, path.peak):
            goal = follower.goal(path.now.value)
            value, dissipated = path.now.value, path.dissipated
            with stopping(path.position):
                attempt = self._attempt(path, solver, follower, goal)
            if attempt is not None:
                step, last = attempt
                self._jumps.accepted(step.number, step.gauge, step.load, last)
                follower.succeeded(goal, last, step.controlled - value, path.dissipated - dissipated, step.controlled)
                yield step
                if not follower.ended(path.now.value, path.load, path.peak):
                    with stopping(path.position):
                        self._coarsen(path)
            elif not follower.failed(unloaded=path.now.load == 0.0):
                raise RunStopped(
                    f"no equilibrium within {control.max_iterations} iterations, even with a step of"
                    f" {follower.length:.3g} m (the smallest one is {follower.smallest:.3g} m, see control.min_step)",
                    path.number + 1,
                    goal.size,
                )

    def _attempt(self, path: _Path, solver: StepSolver, follower: PathFollower, goal: Goal) -> tuple[Step, int] | None:
        """One step with all its refinements; None when no equilibrium was found."""
        refinements = 0
        while True:
            system, began = path.system, time.process_time()
            counted = system.factorizations
            guess = self._guess(path, goal)
            found = solver.solve(
                system,
                path.now.response.history,
                goal.constraint(system, path.now),
                guess,
                0.05 * path.peak,
                patience=goal.patience,
            )
            path.factorizations += system.factorizations - counted
            path.linear_iterations += solver.linear_iterations
            if found is None:
                self._jumps.failed()
                path.iterations += goal.patience * solver.max_iterations
                return None
            path.iterations += found.iterations
            if follower.is_leap(goal, path.now, found, path.peak):
                return None
            if follower.is_jump(goal, abs(path.load) - abs(found.load), path.peak):
                return None
            state, criterion = self._structure.assess(found.response, found.load)
            critical = np.nan_to_num(criterion) > self.case.adaptivity.gamma
            if not critical.any():
                break
            refinements += 1
            path.refinements += 1
            if refinements > _MOST_REFINEMENTS:
                raise RunStopped(f"{refinements - 1} refinements did not satisfy the criterion", *path.position())
            # Bodies that would be critical soon are taken along: re-tessellation costs more than a few bodies.
            soon = np.nan_to_num(criterion) > self.case.adaptivity.ahead * self.case.adaptivity.gamma
            solved = time.process_time()
            try:
                self._refine(path, system.tessellation.x[soon], found.response.history)
            except (InputError, SingularMatrixError) as error:
                raise RunStopped(f"the refined discretization cannot be used: {error}", *path.position()) from error
            path.factorizations += path.system.factorizations
            self.cpu_repeated += solved - began
            self.cpu_refining += time.process_time() - solved
        return self._accept(path, goal, found, criterion, state), found.iterations

    def _guess(self, path: _Path, goal: Goal) -> tuple[FloatArray, float]:
        """Displacements and load with which the iteration begins: extrapolated from the last two states."""
        now, before = path.now, path.before
        growth = 0.0 if before is None else now.value - before.value
        if before is not None and (goal.in_energy or growth > 0.0):
            ratio = goal.size / max(path.spent, 1e-300) if goal.in_energy else (goal.size - now.value) / growth
            ratio = min(ratio, _FARTHEST if goal.in_energy == path.in_energy else 1.0)
            return (
                now.response.u + ratio * (now.response.u - before.response.u),
                now.load + ratio * (now.load - before.load),
            )
        if goal.in_energy:
            return self._aimed(path, goal.size)
        if now.value == 0.0:
            unit = settle(path.system, now.response.history, goal.size)
            return unit.response.u, unit.load
        ratio = goal.size / now.value
        return ratio * now.response.u, ratio * now.load

    def _aimed(self, path: _Path, energy: float) -> tuple[FloatArray, float]:
        """The state with the damage found before refinement, under the load with which it has dissipated an energy."""
        now = path.now
        end = None if path.aim is None else self._settled(path.system, path.aim, now.value)
        if end is not None and end.load != 0.0:
            unit = end.response.u / end.load
            softer = float(path.system.load @ (unit - now.response.u / now.load))
            load = 2.0 * energy / (now.load * softer) if softer != 0.0 else np.inf
            if 1.0 / _PAST_AIM < load / now.load < _PAST_AIM:
                return load * unit, load
        return _PAST * now.response.u, _PAST * now.load

    @staticmethod
    def _settled(system: System, history: FloatArray, value: float) -> Equilibrium | None:
        """What `settle` finds; None where the damage leaves nothing that holds together."""
        try:
            return settle(system, history, value)
        except SingularMatrixError:
            return None

    def _refine(self, path: _Path, centers: FloatArray, reached: FloatArray) -> None:
        """Refine around critical centres and settle the last accepted state on the new discretization."""
        old = path.system
        self._moved(path, self._structure.refine(centers))
        path.aim = transfer_history(old.pairs(), reached, path.system.pairs(), path.system.virgin())
        _log.info("refined to %d bodies at %.4g m", len(self.tessellation), path.now.value)

    def _coarsen(self, path: _Path) -> None:
        """Give up what is fine and not needed any more, where that pays, and settle the last accepted state there."""
        try:
            changed = self._structure.coarsen(path.now.response, partial(self._moved, path))
        except FAILURES as error:
            # The fine structure is as it was, and as good: the run goes on with it.
            self._structure.keep_fine()
            notice = Notice(
                "adaptivity.coarsen",
                f"what had unloaded could not be made coarse again after step {path.number} ({reason(error)}); the run"
                " goes on without",
                "nothing, if it ends in time; coarsen = false does not try",
            )
            self._met.append(notice)
            _log.warning(notice)
            return
        if changed:
            path.coarsenings += 1
            _log.info("coarsened to %d bodies at %.4g m", len(self.tessellation), path.now.value)

    def _moved(self, path: _Path, system: System) -> None:
        """Settle the last accepted state on another discretization; where that fails, nothing has changed.

        The load and the energy stored jump a little. The jump of energy is kept apart, so that the balance of the rest
        can be told.
        """
        old, before = path.system, path.now
        history = transfer_history(old.pairs(), before.response.history, system.pairs(), system.virgin())
        if before.value == 0.0:
            now = Equilibrium(system.response(np.zeros(system.size), history), 0.0, 0.0)
        else:
            now = settle(system, history, before.value)
        path.system, path.before, path.now = system, None, now
        if before.value == 0.0:
            return
        path.exchanged += system.stored(path.now.response) - old.stored(before.response)
        path.load_change += abs(path.now.load - before.load)
        path.load, path.displacement = path.now.load, float(system.load @ path.now.response.u)

    def _accept(
        self,
        path: _Path,
        goal: Goal,
        found: Equilibrium,
        criterion: FloatArray,
        state: ElasticState,
    ) -> Step:
        system = path.system
        by_gauge = self.case.quantity == "gauge"
        displacement = float(system.load @ found.response.u) if by_gauge else found.value
        gauge = found.value if by_gauge or system.gauge is None else float(system.gauge @ found.response.u)
        spent = system.dissipated(path.now.response, found.response)
        path.spent = float(spent.sum())
        path.dissipated += path.spent
        path.dissipated_at = path.dissipated_at + system.carried.sums(spent)
        path.in_energy = goal.in_energy
        path.work += 0.5 * (path.load + found.load) * (displacement - path.displacement)
        path.work -= float(system.kinks(path.now.response, found.response).sum())
        path.before, path.now, path.aim = path.now, found, None
        path.number += 1
        path.displacement, path.load = displacement, found.load
        path.peak = max(path.peak, abs(found.load))
        reactions = system.reactions(found.response, found.load)
        step = Step(
            number=path.number,
            gauge=gauge,
            load=found.load,
            load_displacement=displacement,
            bodies=len(system.tessellation),
            fine_bodies=int(system.tessellation.fine.sum()),
            refinements=path.refinements,
            coarsenings=path.coarsenings,
            iterations=path.iterations,
            linear_iterations=path.linear_iterations,
            factorizations=path.factorizations,
            dissipated=path.dissipated,
            stored=system.stored(found.response),
            work=path.work,
            exchanged=path.exchanged,
            max_elastic_utilisation=float(state.utilisation.max(initial=0.0)),
            residual=found.norms.force,
            snapshot=self._snapshot(system, found, criterion, state.stress),
            control=goal.control,
            quantity=self.case.quantity,
            reactions=reactions.each,
            rest=reactions.rest,
            dissipated_at=path.dissipated_at,
            load_change=path.load_change,
            spent=spent,
            utilisation=state.utilisation,
        )
        path.load_change = 0.0
        path.iterations = path.linear_iterations = path.factorizations = path.refinements = path.coarsenings = 0
        return step

    def _snapshot(self, system: System, found: Equilibrium, criterion: FloatArray, stress: FloatArray) -> Snapshot:
        contacts = system.tessellation.contacts
        damage = np.zeros(len(contacts))
        damage[system.active] = system.law.damage(found.response.history)
        return Snapshot(
            tessellation=system.tessellation,
            displacement=found.response.u.reshape(-1, 6),
            stress=stress,
            criterion=criterion,
            strain=found.response.strain,
            traction=found.response.traction,
            tangents=system.geometry.frame[:, 1:],
            damage=damage,
            opening=contacts.length * damage * np.maximum(found.response.strain[:, 0], 0.0),
            body_factor=system.body_factor,
            contact_factor=system.contact_factor,
        )
