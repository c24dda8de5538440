"""Live progress over the runs of an ensemble."""

from __future__ import annotations

from fissura.batch.progress import ManyProgress
from fissura.ensemble.plan import Plan

__all__ = ["EnsembleProgress"]


class EnsembleProgress(ManyProgress):
    """Shows the runs of an ensemble as they end."""

    def start(self, plan: Plan, missing: int, there: int) -> None:
        """Say what is about to run."""
        self.begin(f"{plan.case.name}: {missing + there} runs, companions included", missing, there)
