"""A state of equilibrium that the criterion leaves as it is: the end of a step."""

from dataclasses import replace

import numpy as np

from fissura.arrays import FloatArray
from fissura.equilibrium import Equilibrium, Goal, System, dissipation, reactions
from fissura.simulation.found import Found, snapshot_of
from fissura.simulation.model import Model
from fissura.simulation.state import Before, Effort, State, Totals
from fissura.simulation.step import Step


def accepted(model: Model, state: State, goal: Goal, found: Found) -> tuple[State, Step]:
    """State and step after an accepted one.

    Parameters
    ----------
    model : Model
        Equations, and what a run is told by.
    state : State
        Where the step began.
    goal : Goal
        What it was to reach.
    found : Found
        Where it ends.
    """
    system, old, new = model.system, state.now, found.equilibrium
    totals, spent = _summed(system, state, new)
    after = replace(
        state,
        now=new,
        number=state.number + 1,
        totals=totals,
        before=Before(old.response.u, old.load, old.value),
        spent=float(spent.sum()),
        in_energy=goal.in_energy,
        effort=Effort(),
        aim=None,
    )
    return after, _step(model, after, state.effort, goal, found, spent)


def _summed(system: System, state: State, new: Equilibrium) -> tuple[Totals, FloatArray]:
    """Sums after a step to a new state, and the energy that each contact dissipated in it (m,) [J]."""
    totals = state.totals
    forces = system.forces(new.load)
    displacements = np.asarray(system.acting.load_rows @ new.response.u)
    spent, stored = dissipation(system, state.now.response, new.response)
    spent = spent[: len(system.tessellation.contacts)]
    more = 0.5 * (totals.forces + forces) @ (displacements - totals.displacements)
    work = totals.work + float(more)
    summed = replace(
        totals,
        forces=forces,
        displacements=displacements,
        dissipated=totals.dissipated + float(spent.sum()),
        dissipated_at=totals.dissipated_at + np.array([spent[own].sum() for own in system.carrying]),
        work=work - float(stored.sum()),
        peak=max(totals.peak, abs(new.load)),
    )
    return summed, spent


def _step(model: Model, after: State, effort: Effort, goal: Goal, found: Found, spent: FloatArray) -> Step:
    """What is told of a step, from the state after it and what it took."""
    system, new, totals = model.system, found.equilibrium, after.totals
    forces, displacements = totals.forces, totals.displacements
    conditions, drive = system.conditions, system.drive
    gauges = np.asarray(system.acting.gauge_rows @ new.response.u)
    if drive.quantity == "gauge" and drive.gauge is not None:
        gauges[drive.gauge] = new.value  # without round-off
    held = reactions(system, new.response, new.load)
    main = conditions.main
    by_displacement = drive.quantity == "displacement" and np.array_equal(drive.ratios, main.ratios)
    displacement = new.value if by_displacement else float(main.ratios @ displacements)
    assert after.leg is not None
    return Step(
        number=after.number,
        gauge=displacement if main.gauge is None else float(gauges[main.gauge]),
        load=float(main.ratios @ forces / (main.ratios @ main.ratios)),
        load_displacement=displacement,
        bodies=len(system.tessellation),
        fine_bodies=int(system.tessellation.fine.sum()),
        refinements=effort.refinements,
        coarsenings=effort.coarsenings,
        iterations=effort.iterations,
        linear_iterations=effort.linear_iterations,
        factorizations=effort.factorizations,
        dissipated=totals.dissipated,
        stored=new.response.stored,
        work=totals.work,
        exchanged=totals.exchanged,
        max_elastic_utilisation=float(found.elastic.utilisation.max(initial=0.0)),
        residual=new.residual,
        snapshot=snapshot_of(system, found),
        control=goal.control,
        quantity=model.case.quantity,
        reactions=held.each,
        rest=held.rest,
        dissipated_at=np.asarray(totals.dissipated_at),
        load_change=effort.load_change,
        spent=spent,
        utilisation=found.elastic.utilisation,
        stage=model.legs[after.leg.index].number,
        done=model.done(after),
        forces=dict(zip(conditions.load_names, forces.tolist(), strict=True)),
        displacements=dict(zip(conditions.load_names, displacements.tolist(), strict=True)),
        held=tuple(one.name for one in conditions.held),
        gauges=dict(zip(conditions.gauge_names, gauges.tolist(), strict=True)),
    )
