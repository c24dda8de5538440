"""How a run enters a leg of its loading programme, and what its legs must be able to do."""

from dataclasses import replace

import numpy as np

from fissura.equilibrium import Leg, System, UnmovedGaugeError, reach_of
from fissura.errors import InputError
from fissura.simulation.legs import peak_so_far
from fissura.simulation.model import Model
from fissura.simulation.state import State


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
    peak = max(peak_so_far(model.legs, state, leg.index), abs(leg.load))
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
