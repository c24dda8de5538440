"""The unloaded structure, from which a run starts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fissura.equilibrium import Equilibrium, SingularMatrixError, UnmovedGaugeError, settle
from fissura.errors import InputError
from fissura.legs import check_drives
from fissura.model import Model
from fissura.specimen import backward_gauge
from fissura.state import Start, State, Totals

if TYPE_CHECKING:
    from fissura.case import Case

__all__ = ["started"]

#: Error of the initial stiffness that is accepted after calibration.
_STIFFNESS_ERROR = 0.02


def _is_to_grow(case: Case) -> bool:
    """Whether the only stage is to make what it controls grow from rest."""
    (first, *others), (target, *_) = case.stages, case.stages[0].targets
    return not others and case.gravity is None and first.quantity != "force" and target.value > 0.0


def started(model: Model, bodies: tuple[int, int]) -> State:
    """Calibrate the start of a run, and find its stiffness.

    Parameters
    ----------
    model : Model
        What is run.
    bodies : (int, int)
        Bodies at the start, and at full resolution.

    Raises
    ------
    InputError
        The load moves nothing that is controlled, the supports hold too little, or the start is too coarse.
    """
    case, structure = model.case, model.structure
    try:
        system = structure.calibrate()
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
    if stiffness < 0.0 and not (structure.compliance or 0.0) > 0.0 and _is_to_grow(case):
        raise backward_gauge(system.conditions, stiffness)
    if structure.compliance is not None:
        off = stiffness * structure.compliance - 1.0
        if abs(off) > _STIFFNESS_ERROR:
            kind = f"is {abs(off):.0%} too {'stiff' if off > 0.0 else 'soft'} against full resolution"
            if stiffness < 0.0:
                kind = f"moves the {case.quantity} the other way than full resolution does"
            raise InputError(
                "discretization.l_c",
                f"{case.discretization.l_c:g} m: the start {kind}, more than calibration can mend (it has"
                f" {bodies[0]} of {bodies[1]} bodies)",
                "a smaller l_c, or a larger adaptivity.r_f (adaptivity.calibrate = false runs it all the same)",
            )
    rest = system.response(np.zeros(system.size), system.virgin())
    used = system.largest_utilisation(unit.response)
    start = Start(stiffness, 1.0 / used if used > 0.0 else np.inf, structure.compliance)
    nothing = np.zeros(len(system.conditions.load_names))
    rested, totals = Equilibrium(rest, 0.0, 0.0), Totals(nothing, nothing)
    state = State(structure.layout, rested, start, totals, solver=model.solver.memory(system))
    model.end(state)
    return state
