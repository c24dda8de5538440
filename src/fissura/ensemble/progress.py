"""Live progress over the runs of an ensemble."""

from __future__ import annotations

from typing import Any

from fissura.ensemble.plan import Plan
from fissura.progress.live import ManyProgress, duration
from fissura.text.quantities import force

__all__ = ["EnsembleProgress"]


class EnsembleProgress(ManyProgress):
    """Shows the runs of an ensemble as they end."""

    def start(self, plan: Plan, missing: int, there: int) -> None:
        """Say what is about to run."""
        known = f", {there} of them there already" if there else ""
        self.say(f"{plan.case.name}: {missing + there} runs, companions included{known}")
        self.begin(missing, there, "starting workers")

    def outcome(self, summary: dict[str, Any]) -> None:
        """Show a run that has ended."""
        status, about, peak = summary["status"], summary["realisation"], summary.get("peak_load_N")
        self.ended(
            status,
            "" if status == "finished" else f"{about['kind']} {about['number']:04d} {status}: {summary['message']}",
            "" if peak is None else f"last peak {force(peak)} in {duration(summary['wall_s'])}",
        )
