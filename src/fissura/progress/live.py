"""Live progress of a run: a moving line in a terminal or a notebook, plain lines elsewhere."""

from __future__ import annotations

import time
from types import TracebackType
from typing import TYPE_CHECKING, Self

from rich.console import Console

from fissura.case import Case
from fissura.progress.lines import line_on
from fissura.progress.time_left import TimeLeft
from fissura.results.done import Done
from fissura.results.names import driven_in
from fissura.simulation.step import Step
from fissura.text.quantities import counted, force, length

if TYPE_CHECKING:
    from fissura.simulation.loop import Simulation

EVERY_SECONDS = 5.0
EVERY_FRACTION = 0.05

ALMOST = 0.1
"""Time left, over that which has gone by, below which a run is almost done: last steps differ too much to say more."""


def duration(seconds: float) -> str:
    """Write a time as ``12 s``, ``3:20 min`` or ``2:03 h``."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60}:{whole % 60:02d} min"
    return f"{whole // 3600}:{whole // 60 % 60:02d} h"


class Live:
    """A moving line where there can be one, and lines that stay.

    Parameters
    ----------
    console : Console
        Where to write; a moving line if it is a terminal or a notebook.
    share : str
        How the line tells how far it is, see `fissura.progress.lines.line_on`.
    """

    def __init__(self, console: Console, share: str) -> None:
        self._console = console
        self._line = line_on(console, share)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._line is not None:
            self._line.end()

    def say(self, text: str) -> None:
        """Write a line that stays; not in notebooks, where many of them would push results away."""
        if not self._console.is_jupyter:
            self._console.print(text, markup=False, highlight=False, soft_wrap=True)


class RunProgress(Live):
    """Shows the steps of a run while it goes on.

    Parameters
    ----------
    console : Console
        Where to write; a moving line if it is a terminal or a notebook.
    case : Case
        What is run: it says how far.
    """

    def __init__(self, console: Console, case: Case) -> None:
        super().__init__(console, "{task.percentage:3.0f} %")
        self._case, self._quantity = case, case.quantity
        self._done = Done(case)
        self._start = time.monotonic()
        self._pace = TimeLeft()
        self._refinements = 0
        self._shown = (self._start, 0.0)

    def __enter__(self) -> Self:
        if self._line is not None:
            self._line.begin(f"{self._case.name}: building the specimen")
        return self

    def start(self, simulation: Simulation) -> None:
        """Say what is about to run."""
        now = time.monotonic()
        kind = "full resolution" if simulation.full else f"adaptive, full resolution has {simulation.told_full}"
        self.say(
            f"{simulation.case.name}: {simulation.bodies_start} bodies ({kind}), built in {duration(now - self._start)}"
        )
        state = simulation.state
        if state is not None:
            self._done.peak = state.totals.peak
            quantity = self._quantity if state.leg is None else state.leg.quantity  # that of the way it is on
            value = f"load {force(state.now.value)}" if quantity == "force" else f"{quantity} {length(state.now.value)}"
            self.say(f"continues after step {state.number}, {value}")
        if self._line is not None:
            self._line.change("first step" if state is None else "next step")

    def step(self, step: Step) -> None:
        """Show an accepted step."""
        now = time.monotonic()
        share = self._done.after(step.done, step.load)
        left = self._pace.after(now, share)
        self._refinements += step.refinements
        text = self._told(step, now, left)
        if self._line is not None:
            self._line.change(text, share)
            if step.refinements:
                self.say(f"step {step.number}: {counted(step.refinements, 'refinement')}, {step.bodies} bodies")
            return
        seconds, more = now - self._shown[0], share - self._shown[1]
        if step.refinements or seconds >= EVERY_SECONDS or more >= EVERY_FRACTION * (1 - 1e-9):
            self._shown = (now, share)
            self.say(f"{100 * share:3.0f} %  {text}")

    def _told(self, step: Step, now: float, left: float | None) -> str:
        name, load = driven_in(self._case, step)
        parts = [
            f"step {step.number}",
            f"{self._quantity} {length(step.controlled)}",
            f"{name} {force(load)}{self._left_of_peak(step)}",
            f"{step.bodies} bodies",
            counted(self._refinements, "refinement"),
            counted(step.iterations, "iteration"),
            f"{duration(now - self._start)} elapsed",
        ]
        if left is not None:
            parts.append("almost done" if left < ALMOST * (now - self._start) else f"about {duration(left)} left")
        return ", ".join(parts)

    def _left_of_peak(self, step: Step) -> str:
        """What is left of the peak load, past it; the controlled quantity says little while energy leads."""
        load, peak = abs(step.load), self._done.peak
        return f" ({100 * load / peak:.0f} % of the peak)" if step.control == "dissipation" and load < peak else ""
