"""Where the iteration for a step begins."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fissura.arrays import FloatArray
from fissura.equilibrium import Equilibrium, Goal, System, settle
from fissura.linear import SingularMatrixError
from fissura.simulation import limits

if TYPE_CHECKING:
    from fissura.simulation.state import State


def guessed(system: System, state: State, goal: Goal) -> tuple[FloatArray, float]:
    """Displacements (6 n,) and load [N] with which the iteration begins: extrapolated from the last two states."""
    now, before = state.now, state.before
    growth = 0.0 if before is None else now.value - before.value
    forward = state.leg is not None and (state.leg.end - state.leg.begin) * growth > 0.0
    if before is not None and (goal.in_energy or forward):
        ratio = goal.size / max(state.spent, 1e-300) if goal.in_energy else (goal.size - now.value) / growth
        ratio = min(ratio, limits.FARTHEST if goal.in_energy == state.in_energy else 1.0)
        return now.response.u + ratio * (now.response.u - before.u), now.load + ratio * (now.load - before.load)
    if goal.in_energy:
        return _aimed(system, state, goal.size)
    if system.dead is not None or abs(now.value) <= limits.NEAR_REST * abs(goal.size):
        unit = settle(system, now.response.history, goal.size)
        return unit.response.u, unit.load
    ratio = goal.size / now.value
    return ratio * now.response.u, ratio * now.load


def _aimed(system: System, state: State, energy: float) -> tuple[FloatArray, float]:
    """The state with the damage found before refinement, under the load with which it has dissipated an energy."""
    now = state.now
    if system.dead is not None:
        more = (limits.PAST - 1.0) * now.load
        return now.response.u + more * system.prepared.solve(now.response.history), now.load + more
    end = None if state.aim is None else _settled(system, state.aim, now.value)
    if end is not None and end.load != 0.0:
        unit = end.response.u / end.load
        softer = float(system.load @ (unit - now.response.u / now.load))
        load = 2.0 * energy / (now.load * softer) if softer != 0.0 else np.inf
        if 1.0 / limits.PAST_AIM < load / now.load < limits.PAST_AIM:
            return load * unit, load
    return limits.PAST * now.response.u, limits.PAST * now.load


def _settled(system: System, history: FloatArray, value: float) -> Equilibrium | None:
    """What `settle` finds; None where the damage leaves nothing that holds together."""
    try:
        return settle(system, history, value)
    except SingularMatrixError:
        return None
