"""The one loop over the steps of a run, and those who watch it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fissura.simulation.loop import Simulation
    from fissura.simulation.state import State
    from fissura.simulation.step import Step

Observer = Callable[["State", "Step"], None]
"""Takes the state after each accepted step, and the step."""


def watched(simulation: Simulation, *observers: Observer) -> None:
    """Run a simulation to its end, from where it stands.

    Parameters
    ----------
    simulation : Simulation
        The run.
    *observers : callable
        Called in this order after every accepted step.

    Raises
    ------
    RunStopped, InputError
        As :meth:`Simulation.steps`; and whatever an observer raises.
    """
    for step in simulation.steps():
        state = simulation.state
        for observer in observers:
            observer(state, step)  # type: ignore[arg-type]  # there is one after a step
