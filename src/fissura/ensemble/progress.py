"""Live progress over the runs of an ensemble."""

from collections.abc import Mapping
from typing import Any

from fissura.batch.progress import ManyProgress
from fissura.ensemble.plan import Plan
from fissura.progress.live import duration
from fissura.text.quantities import force


class OutcomeProgress(ManyProgress):
    """Shows realisations as they end, whoever asked for them."""

    def outcome(self, summary: Mapping[str, Any]) -> None:
        """Show a realisation that has ended, by its summary."""
        status, about, peak = summary["status"], summary["realisation"], summary.get("peak_load_N")
        self.ended(
            status,
            "" if status == "finished" else f"{about['kind']} {about['number']:04d} {status}: {summary['message']}",
            "" if peak is None else f"last peak {force(peak)} in {duration(summary['wall_s'])}",
        )


class EnsembleProgress(OutcomeProgress):
    """Shows the runs of an ensemble as they end."""

    def start(self, plan: Plan, missing: int, there: int) -> None:
        """Say what is about to run."""
        self.begin(f"{plan.case.name}: {missing + there} runs, companions included", missing, there)
