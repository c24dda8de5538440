"""The legs of a loading programme, one after another: gravity first, then every target of every stage."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fissura.arrays import FloatArray
from fissura.case import Case
from fissura.case.programme import GRAVITY, StageTarget
from fissura.case.stages import LoadingStage
from fissura.equilibrium import Leg, System
from fissura.simulation import limits
from fissura.specimen import Conditions, Drive

if TYPE_CHECKING:
    from fissura.simulation.state import State


@dataclass(frozen=True)
class Planned:
    """A leg as the case has it.

    Attributes
    ----------
    number : int
        Number of its stage: 1, 2, ...; 0 for gravity.
    stage : LoadingStage
        Its stage.
    target : StageTarget
        Where it ends.
    drive : Drive
        What is driven and controlled; the load factor, where the target is a share of a load.
    main : bool
        It and all legs before drive the load of the last stage, as the equations of the start do.
    """

    number: int
    stage: LoadingStage
    target: StageTarget
    drive: Drive
    main: bool


def planned_legs(case: Case, conditions: Conditions) -> tuple[Planned, ...]:
    """All legs of a case.

    Parameters
    ----------
    case : Case
        Its stages.
    conditions : Conditions
        Its loads and gauges.
    """
    legs: list[Planned] = []
    if conditions.weight is not None:
        size, ratios = conditions.weight.size, np.zeros(len(conditions.load_names))
        ratios[-1] = 1.0
        step, target = size / limits.WEIGHT_STEPS, StageTarget(size)
        last = case.main
        stage = LoadingStage(
            GRAVITY, ((GRAVITY, 1.0),), "force", None, False, (target,), size, step, step, limits.SMALLEST_STEP * step,
            last.tolerance, last.max_iterations, switch=False,
        )  # fmt: skip
        legs.append(Planned(0, stage, target, Drive(ratios, "force", None), main=False))
    for number, (stage, drive) in enumerate(zip(case.stages, conditions.drives, strict=True), 1):
        for target in stage.targets:
            way = replace(drive, quantity="force") if target.of else drive
            main = (not legs or legs[-1].main) and _same(way, conditions.main)
            legs.append(Planned(number, stage, target, way, main))
    return tuple(legs)


def _same(one: Drive, other: Drive) -> bool:
    """Whether the same is driven and controlled."""
    same = one.quantity == other.quantity and one.gauge == other.gauge
    return same and np.array_equal(one.ratios, other.ratios)


def ahead(legs: Sequence[Planned], system: System, state: State) -> Leg | None:
    """The next leg that leads anywhere after the current one of a state; None where there is none.

    Parameters
    ----------
    legs : sequence of Planned
        The loading programme.
    system : System
        Equations of the state.
    state : State
        The end of a leg, or rest before the first one.

    Returns
    -------
    Leg or None
        Its slope is not known before it is entered.
    """
    begun = 0 if state.leg is None else state.leg.index + 1
    for index in range(begun, len(legs)):
        leg = _seen(legs, system, state, index)
        if leg.length > limits.NO_WAY * max(abs(leg.begin), abs(leg.end)):
            return leg
    return None


def _seen(legs: Sequence[Planned], system: System, state: State, index: int) -> Leg:
    """A leg as it begins at a state."""
    planned, forces = legs[index], state.totals.forces
    ratios, target = planned.drive.ratios, planned.target
    factor, kept = _shared(ratios, forces)
    if state.leg is not None and np.array_equal(ratios, legs[state.leg.index].drive.ratios):
        factor, kept = state.now.load, state.leg.kept
    u, acting = state.now.response.u, system.acting
    if planned.drive.quantity == "force":
        value = factor
    elif planned.drive.quantity == "gauge":
        assert planned.drive.gauge is not None
        value = float((acting.gauge_rows[[planned.drive.gauge]] @ u)[0])
    else:
        value = float(ratios @ (acting.load_rows @ u))
    end = target.value
    if target.of:
        base = factor if target.of == "load" else np.copysign(peak_so_far(legs, state, index), factor)
        end = target.value * base
    stage, length = planned.stage, abs(end - value)
    longest, first, smallest = stage.max_step, stage.first_step, stage.min_step
    if target.of or not longest:
        unloads = target.of and 0.0 <= end * value <= value**2  # along a line, to the origin
        longest = first = length / (limits.UNLOADING_STEPS if unloads else limits.STEPS)
        smallest = limits.SMALLEST_STEP * first
    way = longest_way(legs, planned.number)
    share = stage.max_step / way if way > 0.0 else 1.0 / limits.STEPS
    share = share if stage.energy_step is None else stage.energy_step
    quantity = planned.drive.quantity
    return Leg(index, quantity, kept, value, end, factor, 1.0, longest, first, smallest, share)


def _shared(ratios: FloatArray, forces: FloatArray) -> tuple[float, FloatArray]:
    """Load factor [N] and other forces (L,) that make up all forces.

    Loads that have these ratios already go on from there; others stay, and the load factor counts from zero.
    """
    factor = float(ratios @ forces / (ratios @ ratios))
    own = ratios != 0.0
    if np.abs(forces - factor * ratios)[own].max() > limits.NO_WAY * max(np.abs(forces).max(), 1e-300):
        return 0.0, forces
    return factor, np.where(own, 0.0, forces)


def peak_so_far(legs: Sequence[Planned], state: State, index: int) -> float:
    """Largest size of the load factor so far, of stages that drive the same loads [N]."""
    if state.leg is None:
        return 0.0
    same = np.array_equal(legs[state.leg.index].drive.ratios, legs[index].drive.ratios)
    return state.totals.peak if same else 0.0


def longest_way(legs: Sequence[Planned], number: int) -> float:
    """The farthest target of a stage [m or N], 0 where all are shares of a load; the weight is stage 0."""
    values = [leg.target.value for leg in legs if leg.number == number and not leg.target.of]
    return max((abs(value) for value in values), default=0.0)
