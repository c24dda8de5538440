"""A state of equilibrium that the criterion leaves as it is: the end of a step."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fissura.state import Before, Effort, State
from fissura.step import Snapshot, Step

if TYPE_CHECKING:
    from fissura.adaptivity import ElasticState
    from fissura.case import Quantity
    from fissura.equilibrium import Equilibrium, Goal, System

__all__ = ["Found", "accepted"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Found:
    """Where a step ends.

    Attributes
    ----------
    equilibrium : Equilibrium
        Displacements, load and history.
    elastic : ElasticState
        What the criterion looked at.
    criterion : (n,) array
        Its value, 1 at strength; nan for fine bodies.
    """

    equilibrium: Equilibrium
    elastic: ElasticState
    criterion: FloatArray


def accepted(system: System, state: State, goal: Goal, found: Found, quantity: Quantity) -> tuple[State, Step]:
    """State and step after an accepted one.

    Parameters
    ----------
    system : System
        Equations.
    state : State
        Where the step began.
    goal : Goal
        What it was to reach.
    found : Found
        Where it ends.
    quantity : {"gauge", "displacement"}
        What is controlled.
    """
    old, new, totals, effort = state.now, found.equilibrium, state.totals, state.effort
    by_gauge = quantity == "gauge"
    displacement = float(system.load @ new.response.u) if by_gauge else new.value
    gauge = new.value if by_gauge or system.gauge is None else float(system.gauge @ new.response.u)
    spent = system.dissipated(old.response, new.response)
    work = totals.work + 0.5 * (old.load + new.load) * (displacement - totals.displacement)
    totals = replace(
        totals,
        displacement=displacement,
        dissipated=totals.dissipated + float(spent.sum()),
        dissipated_at=totals.dissipated_at + system.carried.sums(spent),
        work=work - float(system.kinks(old.response, new.response).sum()),
        peak=max(totals.peak, abs(new.load)),
    )
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
    reactions = system.reactions(new.response, new.load)
    step = Step(
        number=after.number,
        gauge=gauge,
        load=new.load,
        load_displacement=displacement,
        bodies=len(system.tessellation),
        fine_bodies=int(system.tessellation.fine.sum()),
        refinements=effort.refinements,
        coarsenings=effort.coarsenings,
        iterations=effort.iterations,
        linear_iterations=effort.linear_iterations,
        factorizations=effort.factorizations,
        dissipated=totals.dissipated,
        stored=system.stored(new.response),
        work=totals.work,
        exchanged=totals.exchanged,
        max_elastic_utilisation=float(found.elastic.utilisation.max(initial=0.0)),
        residual=new.norms.force,
        snapshot=_snapshot(system, found),
        control=goal.control,
        quantity=quantity,
        reactions=reactions.each,
        rest=reactions.rest,
        dissipated_at=np.asarray(totals.dissipated_at),
        load_change=effort.load_change,
        spent=spent,
        utilisation=found.elastic.utilisation,
    )
    return after, step


def _snapshot(system: System, found: Found) -> Snapshot:
    response, contacts = found.equilibrium.response, system.tessellation.contacts
    damage = np.zeros(len(contacts))
    damage[system.active] = system.law.damage(response.history)
    return Snapshot(
        tessellation=system.tessellation,
        displacement=response.u.reshape(-1, 6),
        stress=found.elastic.stress,
        criterion=found.criterion,
        strain=response.strain,
        traction=response.traction,
        tangents=system.geometry.frame[:, 1:],
        damage=damage,
        opening=contacts.length * damage * np.maximum(response.strain[:, 0], 0.0),
        body_factor=system.body_factor,
        contact_factor=system.contact_factor,
    )
