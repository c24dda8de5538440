"""The legs of a loading programme, one after another: gravity first, then every target of every stage."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fissura.arrays import FloatArray
from fissura.case.programme import GRAVITY, StageTarget
from fissura.case.stages import LoadingStage
from fissura.equilibrium import Leg, UnmovedGaugeError, reach_of
from fissura.errors import InputError
from fissura.simulation import limits
from fissura.specimen import Drive

if TYPE_CHECKING:
    from fissura.case import Case
    from fissura.equilibrium import System
    from fissura.simulation.model import Model
    from fissura.simulation.state import State
    from fissura.specimen import Conditions

__all__ = ["Planned", "ahead", "check_drives", "entered", "extended", "planned_legs"]


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


def ahead(model: Model, state: State) -> Leg | None:
    """The next leg that leads anywhere after the current one of a state; None where there is none.

    Parameters
    ----------
    model : Model
        What is run; its equations are those of the state.
    state : State
        The end of a leg, or rest before the first one.

    Returns
    -------
    Leg or None
        Its slope is not known before it has :func:`entered`.
    """
    begun = 0 if state.leg is None else state.leg.index + 1
    for index in range(begun, len(model.legs)):
        leg = _seen(model, state, index)
        if leg.length > limits.NO_WAY * max(abs(leg.begin), abs(leg.end)):
            return leg
    return None


def _seen(model: Model, state: State, index: int) -> Leg:
    """A leg as it begins at a state."""
    planned, forces = model.legs[index], state.totals.forces
    ratios, target = planned.drive.ratios, planned.target
    factor, kept = _shared(ratios, forces)
    if state.leg is not None and np.array_equal(ratios, model.legs[state.leg.index].drive.ratios):
        factor, kept = state.now.load, state.leg.kept
    u, acting = state.now.response.u, model.system.acting
    if planned.drive.quantity == "force":
        value = factor
    elif planned.drive.quantity == "gauge":
        assert planned.drive.gauge is not None
        value = float((acting.gauge_rows[[planned.drive.gauge]] @ u)[0])
    else:
        value = float(ratios @ (acting.load_rows @ u))
    end = target.value
    if target.of:
        base = factor if target.of == "load" else np.copysign(_peak(model, state, index), factor)
        end = target.value * base
    stage, length = planned.stage, abs(end - value)
    longest, first, smallest = stage.max_step, stage.first_step, stage.min_step
    if target.of or not longest:
        unloads = target.of and 0.0 <= end * value <= value**2  # along a line, to the origin
        longest = first = length / (limits.UNLOADING_STEPS if unloads else limits.STEPS)
        smallest = limits.SMALLEST_STEP * first
    way = model.longest_way(planned.number)
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


def _peak(model: Model, state: State, index: int) -> float:
    """Largest size of the load factor so far, of stages that drive the same loads [N]."""
    if state.leg is None:
        return 0.0
    same = np.array_equal(model.legs[state.leg.index].drive.ratios, model.legs[index].drive.ratios)
    return state.totals.peak if same else 0.0


def entered(model: Model, state: State, leg: Leg) -> State:
    """The state where a leg begins.

    Parameters
    ----------
    model : Model
        What is run; it goes over to what is driven then.
    state : State
        Where the leg before has ended.
    leg : Leg
        The leg, as :func:`ahead` sees it.

    Raises
    ------
    SingularMatrixError
        The structure is a mechanism.
    UnmovedGaugeError
        The load does not move what is controlled.
    """
    planned = model.legs[leg.index]
    peak = max(_peak(model, state, leg.index), abs(leg.load))
    if not planned.main:
        model.discretization.drive(planned.drive, leg.kept)
    system = model.system
    if state.leg is None and planned.main:  # known from the start
        slope, limit = np.copysign(1.0, state.start.stiffness), state.start.limit
    else:
        slope, limit = _elastic(system, state)
    state = replace(
        state,
        leg=replace(leg, slope=float(slope)),
        now=replace(state.now, load=leg.load, value=leg.begin, iterations=0),
        before=None,
        in_energy=False,
        aim=None,
        totals=replace(state.totals, peak=peak),
    )
    memory = model.follower(state, limit).memory
    return replace(state, leading=memory, solver=model.solver.memory(system))


def extended(model: Model, state: State) -> State:
    """The state on its way to where the case has its end now, which may be farther than when the way began."""
    if state.leg is None:
        return state
    target = model.legs[state.leg.index].target
    if target.of or target.value == state.leg.end:
        return state
    return replace(state, leg=replace(state.leg, end=target.value))


def _elastic(system: System, state: State) -> tuple[float, float]:
    """Sense in which the load factor goes with the controlled quantity, and that with which the first contact breaks.

    The latter is infinite unless the structure is at rest.
    """
    history = state.now.response.history
    unit = system.prepared.solve(history)
    reach = 1.0 if system.by_force else reach_of(system.control, unit)
    if state.leg is not None or system.dead is not None:
        return np.copysign(1.0, reach), np.inf
    used = system.largest_utilisation(system.response(unit, history))
    return np.copysign(1.0, reach), abs(reach) / used if used > 0.0 else np.inf


def check_drives(model: Model) -> None:
    """Refuse stages whose loads do not move what they control, or in the first one move it away from its target.

    Raises
    ------
    InputError
        There is one; the key is that of its gauge or load.
    """
    system = model.system
    units = {}
    for planned in model.legs:
        drive = planned.drive
        key = tuple(drive.ratios)
        if drive.quantity == "force" or planned.number == 0:
            continue
        if key not in units:
            units[key] = system.symmetric.solve(np.asarray(drive.ratios @ system.acting.load_rows))
        try:
            reach = reach_of(system.driven(drive, np.zeros(len(drive.ratios))).control, units[key])
        except UnmovedGaugeError as error:
            raise InputError(
                f"{planned.stage.key}.{'gauge' if drive.quantity == 'gauge' else 'load'}",
                f"{error}: nothing changes there however large the load is",
                "places that the load moves apart",
            ) from error
        from_rest = planned is model.legs[0] and len(model.case.stages) > 1
        if from_rest and planned.target.value * reach < 0.0 < planned.target.value:
            raise InputError(
                f"{planned.stage.key}.gauge",
                "the gauge gets smaller under the load, so it could only grow to its target under a negative load",
                "a gauge with another direction, or a negative target",
            )
