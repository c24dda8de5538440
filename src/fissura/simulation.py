"""The loop over steps: equilibrium, criterion, refinement, the same step again (theory section 5).

It yields accepted steps and knows no files.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fissura.adaptivity import (
    ElasticState,
    RefinedRegion,
    calibrated,
    criterion_named,
    gauge_compliance,
    region_from_case,
    transfer_history,
)
from fissura.contact import law_from_case
from fissura.equilibrium import Equilibrium, SingularMatrixError, StepLength, StepSolver, System, prescribed, settle
from fissura.errors import InputError, RunStopped
from fissura.material import material_from_case
from fissura.specimen import conditions_from_case, specimen_from_case
from fissura.step import Snapshot, Step
from fissura.tessellation import Tessellation, discretize, nuclei_from_case

if TYPE_CHECKING:
    from fissura.case import Case

__all__ = ["Simulation"]

FloatArray = NDArray[np.float64]
_log = logging.getLogger(__name__)

#: Refinements of one step before the run is given up; each must add bodies, so this only stops a runaway.
_MOST_REFINEMENTS = 60

#: Failures in a row after which a step is not only shortened but also given more iterations (a few times only, since
#: that is slow), and how many times more.
_CUTS, _PATIENCE = 1, 15

#: Share of gamma from which bodies are refined along with critical ones.
_AHEAD = 0.85


@dataclass
class _Path:
    """Where the run stands: the last accepted state on the current discretization, and totals."""

    system: System
    now: Equilibrium
    before: Equilibrium | None = None
    number: int = 0
    displacement: float = 0.0  # of the load
    load: float = 0.0
    dissipated: float = 0.0
    work: float = 0.0
    peak: float = 0.0
    # Since the last accepted step, attempts that failed included:
    iterations: int = 0
    factorizations: int = 0
    refinements: int = 0


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
    initial_stiffness : float
        Load over controlled quantity of the elastic structure at the start [N/m]; nan before the first step.
    tessellation : Tessellation
        The current discretization.
    """

    def __init__(self, case: Case, *, full: bool = False) -> None:
        self.wall_start, self.cpu_start = time.perf_counter(), time.process_time()
        self.case, self.full = case, full
        self._criterion = criterion_named(case.adaptivity.criterion)
        self._law = law_from_case(case)
        self._material = material_from_case(case)
        self._box = specimen_from_case(case)
        self._conditions = conditions_from_case(case, self._box)
        self._nuclei = nuclei_from_case(case, self._box)
        self._region = region_from_case(case, self._box, full=full)
        self.tessellation = self._discretize(self._region)
        self._system = self._equations(self.tessellation)
        self._compliance: float | None = None  # at full resolution; known when calibration needs it
        self.bodies_full = len(self._nuclei)
        self.bodies_start = len(self.tessellation)
        self.initial_stiffness = float("nan")

    @property
    def elastic_scale(self) -> float:
        """Factor that calibration put on the stiffness of elastic contacts; 1 without calibration."""
        return self._system.elastic_scale

    def _discretize(self, region: RefinedRegion) -> Tessellation:
        return discretize(self._nuclei, self._box, region.spacing(self._nuclei.x))

    def _equations(self, tessellation: Tessellation) -> System:
        return System(tessellation, self._material, self._law, self._conditions)

    def _calibrated(self, system: System) -> System:
        """The equations of a discretization, their elastic part calibrated when the case asks for that."""
        if self.full or not self.case.adaptivity.calibrate:
            return system
        if self._compliance is None:
            whole = self._discretize(replace(self._region, everywhere=True))
            self._compliance = gauge_compliance(self._equations(whole))
        return calibrated(system, self._compliance)

    def _start(self) -> _Path:
        """The unloaded structure; finds the initial stiffness on the way."""
        try:
            self._system = system = self._calibrated(self._system)
            self.initial_stiffness = settle(system, system.virgin(), 1.0).load
        except SingularMatrixError as error:
            raise InputError(
                "supports", f"the structure is a mechanism ({error})", "supports that hold all of the specimen"
            ) from error
        rest = system.response(np.zeros(system.size), system.virgin())
        return _Path(system, Equilibrium(rest, 0.0, 0.0))

    def steps(self) -> Iterator[Step]:
        """Accepted steps, until the target is reached.

        Yields
        ------
        Step

        Raises
        ------
        RunStopped
            No equilibrium was found even with the smallest step; the steps yielded so far are valid.
        """
        control = self.case.control
        solver = StepSolver(control.tolerance, control.max_iterations)
        path = self._start()
        length = StepLength.starting(control.first_step, control.max_step, control.min_step)
        failures = 0
        while path.now.value < control.target * (1.0 - 1e-9):
            value = length.next_value(path.now.value, control.target)
            patient = _CUTS <= failures < 2 * _CUTS + 2
            attempt = self._attempt(path, solver, value, _PATIENCE if patient else 1)
            if attempt is None:
                failures += 1
                shorter = length.halved()
                if shorter is None and failures <= _CUTS:
                    failures = _CUTS
                    continue
                if shorter is None:
                    raise RunStopped(
                        f"no equilibrium within {control.max_iterations} iterations, even with a step of"
                        f" {length.length:.3g} m (control.min_step is {control.min_step:.3g} m)",
                        path.number + 1,
                        value,
                    )
                length = shorter
                continue
            step, last = attempt
            failures = 0
            length = length.after(last, value)
            yield step

    def _attempt(self, path: _Path, solver: StepSolver, value: float, patience: int) -> tuple[Step, int] | None:
        """One step with all its refinements; None when no equilibrium was found."""
        refinements = 0
        while True:
            system = path.system
            counted = system.factorizations
            try:
                guess = self._guess(path, value)
            except SingularMatrixError as error:
                raise RunStopped(f"the structure has become a mechanism: {error}", path.number + 1, value) from error
            constraint = prescribed(system.control, value)
            found = solver.solve(
                system, path.now.response.history, constraint, guess, 0.05 * path.peak, patience=patience
            )
            path.factorizations += system.factorizations - counted
            if found is None:
                path.iterations += patience * solver.max_iterations
                return None
            path.iterations += found.iterations
            utilisation = system.elastic_utilisation(found.response)
            stress = system.stress(found.response, found.load)
            state = ElasticState(
                system.tessellation,
                stress,
                np.full(len(system.tessellation), self._material.f_t),
                utilisation,
            )
            criterion = np.where(system.tessellation.fine, np.nan, self._criterion(state))
            critical = np.nan_to_num(criterion) > self.case.adaptivity.gamma
            if not critical.any():
                break
            refinements += 1
            path.refinements += 1
            if refinements > _MOST_REFINEMENTS:
                raise RunStopped(f"{refinements - 1} refinements did not satisfy the criterion", path.number + 1, value)
            # Bodies that would be critical soon are taken along: re-tessellation costs more than a few bodies.
            soon = np.nan_to_num(criterion) > _AHEAD * self.case.adaptivity.gamma
            try:
                self._refine(path, system.tessellation.x[soon])
            except (InputError, SingularMatrixError) as error:
                raise RunStopped(
                    f"the refined discretization cannot be used: {error}", path.number + 1, value
                ) from error
            path.factorizations += path.system.factorizations
        return self._accept(path, found, criterion, utilisation, stress), found.iterations

    def _guess(self, path: _Path, value: float) -> tuple[FloatArray, float]:
        """Displacements and load with which the iteration begins: extrapolated from the last two states."""
        now, before = path.now, path.before
        if before is None:
            if now.value == 0.0:
                unit = settle(path.system, now.response.history, value)
                return unit.response.u, unit.load
            ratio = value / now.value
            return ratio * now.response.u, ratio * now.load
        ratio = (value - now.value) / (now.value - before.value)
        return (
            now.response.u + ratio * (now.response.u - before.response.u),
            now.load + ratio * (now.load - before.load),
        )

    def _refine(self, path: _Path, centers: FloatArray) -> None:
        """Refine around critical centres and settle the last accepted state on the new discretization."""
        old = path.system
        history, pairs = path.now.response.history, old.pairs()
        self._region = self._region.grown(centers)
        self.tessellation = self._discretize(self._region)
        self._system = path.system = self._calibrated(self._equations(self.tessellation))
        history = transfer_history(pairs, history, path.system.pairs())
        value = path.now.value
        _log.info("refined to %d bodies at %.4g m", len(self.tessellation), value)
        if value == 0.0:
            rest = path.system.response(np.zeros(path.system.size), history)
            path.now = Equilibrium(rest, 0.0, 0.0)
        else:
            path.now = settle(path.system, history, value)
        path.before = None

    def _accept(
        self,
        path: _Path,
        found: Equilibrium,
        criterion: FloatArray,
        utilisation: FloatArray,
        stress: FloatArray,
    ) -> Step:
        system = path.system
        displacement = float(system.load @ found.response.u)
        path.dissipated += float(system.dissipated(path.now.response, found.response).sum())
        path.work += 0.5 * (path.load + found.load) * (displacement - path.displacement)
        path.before, path.now = path.now, found
        path.number += 1
        path.displacement, path.load = displacement, found.load
        path.peak = max(path.peak, abs(found.load))
        step = Step(
            number=path.number,
            gauge=found.value,
            load=found.load,
            load_displacement=displacement,
            bodies=len(system.tessellation),
            fine_bodies=int(system.tessellation.fine.sum()),
            refinements=path.refinements,
            iterations=path.iterations,
            factorizations=path.factorizations,
            dissipated=path.dissipated,
            stored=system.stored(found.response),
            work=path.work,
            max_elastic_utilisation=float(utilisation.max(initial=0.0)),
            residual=found.norms.force,
            snapshot=self._snapshot(system, found, criterion, stress),
        )
        path.iterations = path.factorizations = path.refinements = 0
        return step

    def _snapshot(self, system: System, found: Equilibrium, criterion: FloatArray, stress: FloatArray) -> Snapshot:
        contacts = system.tessellation.contacts
        damage = np.zeros(len(contacts))
        damage[system.active] = found.response.history[:, 0]
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
        )
