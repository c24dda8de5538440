"""The unloaded structure, from which a run starts."""

import logging

import numpy as np

from fissura.case import Case
from fissura.equilibrium import Equilibrium, System, UnmovedGaugeError, settle
from fissura.errors import InputError, Notice
from fissura.linear import SingularMatrixError
from fissura.simulation import limits
from fissura.simulation.entering import check_drives
from fissura.simulation.model import Model
from fissura.simulation.state import Start, State, Totals
from fissura.specimen import backward_gauge

_log = logging.getLogger(__name__)


def _is_to_grow(case: Case) -> bool:
    """Whether the only stage is to make what it controls grow from rest."""
    (first, *others), (target, *_) = case.stages, case.stages[0].targets
    return not others and case.gravity is None and first.quantity != "force" and target.value > 0.0


def started(model: Model, bodies: tuple[int, str]) -> State:
    """Calibrate the start of a run, and find its stiffness.

    Parameters
    ----------
    model : Model
        What is run.
    bodies : (int, str)
        Bodies at the start, and at full resolution as messages tell them.

    Raises
    ------
    InputError
        The load moves nothing that is controlled, the supports hold too little, or the start is too coarse.
    """
    case, discretization = model.case, model.discretization
    try:
        system = discretization.calibrate()
        unit = settle(system, system.virgin(), 1.0)
    except UnmovedGaugeError as error:
        raise InputError(
            "gauge" if case.quantity == "gauge" else "load",
            f"{error}: nothing changes there however large the load is",
            "places that the load moves apart",
        ) from error
    except SingularMatrixError as error:
        raise InputError(
            "supports", f"the structure is a mechanism ({error})", "supports that hold all of the specimen"
        ) from error
    stiffness = unit.load
    if len(model.legs) > 1:
        check_drives(model)
    if stiffness < 0.0 and not (discretization.compliance or 0.0) > 0.0 and _is_to_grow(case):
        raise backward_gauge(system.conditions, stiffness)
    if discretization.compliance is not None:
        off = stiffness * discretization.compliance - 1.0
        if abs(off) > limits.STIFFNESS_ERROR + (discretization.compliance_error or 0.0):
            kind = f"is {abs(off):.0%} too {'stiff' if off > 0.0 else 'soft'} against full resolution"
            if stiffness < 0.0:
                kind = f"moves the {case.quantity} the other way than full resolution does"
            raise InputError(
                "discretization.l_c",
                f"{case.discretization.l_c:g} m: the start {kind}, which calibration cannot correct (the start has"
                f" {bodies[0]} of {bodies[1]} bodies)",
                "a smaller l_c, or a larger adaptivity.r_f (adaptivity.calibrate = false runs it all the same)",
            )
    rest = system.response(np.zeros(system.size), system.virgin())
    used = system.largest_utilisation(unit.response)
    limit = 1.0 / used if used > 0.0 else np.inf
    start = Start(stiffness, limit, discretization.compliance, discretization.compliance_error)
    nothing = np.zeros(len(system.conditions.load_names))
    rested, totals = Equilibrium(rest, 0.0, 0.0), Totals(nothing, nothing)
    met = _sliding(system, unit)
    for notice in met:
        _log.warning(notice)
    state = State(discretization.layout, rested, start, totals, met=met, solver=model.solver.memory(system))
    model.end(state)
    return state


def _sliding(system: System, unit: Equilibrium) -> tuple[Notice, ...]:
    """What to say where the load meets nothing but the trace of friction under platens that have none."""
    response, found = unit.response, []
    each = 0.5 * system.geometry.volume[:, None] * response.traction * response.strain
    for platen, own in zip(system.conditions.platens, system.platens.contacts, strict=True):
        share = float(each[own, 1:].sum()) / float(each.sum())
        if platen.contact == "frictionless" and share > limits.SLIDING:
            found.append(
                Notice(
                    platen.key,
                    f"the specimen slides on it: {share:.0%} of the elastic energy is in the trace of friction that a"
                    " platen without friction has, and next to nothing resists the load",
                    "a glued platen, or another support that the load presses against",
                )
            )
    return tuple(found)
