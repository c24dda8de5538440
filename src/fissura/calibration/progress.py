"""Live progress over the runs of a calibration."""

from __future__ import annotations

from typing import Any

from fissura.calibration.problem import Problem
from fissura.progress.live import ManyProgress, duration
from fissura.text.quantities import force

__all__ = ["CalibrationProgress"]


class CalibrationProgress(ManyProgress):
    """Shows the rounds of a calibration, and the runs as they end."""

    def start(self, problem: Problem, most: int) -> None:
        """Say what is about to be found."""
        self._problem = problem
        names = ", ".join(unknown.key for unknown in problem.unknowns)
        tests = f"{len(problem.tests)} test" + ("s" if len(problem.tests) > 1 else "")
        self.say(f"{problem.name}: {names} from {tests}, {most} runs at most")
        self.begin(most, 0, "starting workers")

    def round(self, number: int, designs: list[dict[str, float]], seeds: int) -> None:
        """Say what is run next."""
        told = "; ".join(
            ", ".join(f"{unknown.name} {unknown.told(point[unknown.key])}" for unknown in self._problem.unknowns)
            for point in designs
        )
        self.say(f"round {number}, {seeds} seeds each: {told}")

    def outcome(self, summary: dict[str, Any]) -> None:
        """Show a run that has ended."""
        status, about, peak = summary["status"], summary["realisation"], summary.get("peak_load_N")
        self.ended(
            status,
            "" if status == "finished" else f"run {about['number']:04d} {status}: {summary['message']}",
            "" if peak is None else f"last peak {force(peak)} in {duration(summary['wall_s'])}",
        )
