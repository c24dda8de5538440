"""Live progress over the runs of an ensemble: a moving line in a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from types import TracebackType
from typing import Any, Self

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn

from fissura.ensemble.plan import Plan
from fissura.progress import duration
from fissura.results.quantities import force

__all__ = ["EnsembleProgress"]

EVERY_SECONDS = 5.0


class EnsembleProgress:
    """Shows the runs of an ensemble as they end.

    Parameters
    ----------
    console : Console
        Where to write; a moving line if it is a terminal.
    """

    def __init__(self, console: Console) -> None:
        self._console = console
        self._start = self._shown = time.monotonic()
        self._total = self._before = self._done = 0
        self._bad: dict[str, int] = {}
        self._bar: Progress | None = None
        self._task = TaskID(0)
        if console.is_terminal:
            self._bar = Progress(
                BarColumn(20),
                TextColumn("{task.completed:.0f} of {task.total:.0f} runs"),
                TextColumn("{task.description}", markup=False),
                console=console,
                transient=True,
            )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()

    def start(self, plan: Plan, missing: int, there: int) -> None:
        """Say what is about to run."""
        self._start = self._shown = time.monotonic()
        self._total, self._before, self._done = missing + there, there, 0
        known = f", {there} of them there already" if there else ""
        self._print(f"{plan.case.name}: {self._total} runs, companions included{known}")
        if self._bar is not None and missing:
            self._bar.start()
            self._task = self._bar.add_task("starting workers", total=self._total, completed=there)

    def outcome(self, summary: dict[str, Any]) -> None:
        """Show a run that has ended."""
        now = time.monotonic()
        self._done += 1
        status, about = summary["status"], summary["realisation"]
        if status != "finished":
            self._bad[status] = self._bad.get(status, 0) + 1
            self._print(f"{about['kind']} {about['number']:04d} {status}: {summary['message']}")
        parts = [f"{count} {name}" for name, count in self._bad.items()]
        if summary.get("peak_load_N") is not None:
            parts.append(f"last peak {force(summary['peak_load_N'])} in {duration(summary['wall_s'])}")
        parts.append(f"{duration(now - self._start)} elapsed")
        left = self._total - self._before - self._done
        if left:
            parts.append(f"about {duration(left * (now - self._start) / self._done)} left")
        text = ", ".join(parts)
        if self._bar is not None:
            self._bar.update(self._task, completed=self._before + self._done, description=text)
        elif now - self._shown >= EVERY_SECONDS or not left:
            self._shown = now
            self._print(f"{self._before + self._done} of {self._total} runs, {text}")

    def _print(self, text: str) -> None:
        self._console.print(text, markup=False, highlight=False, soft_wrap=True)
