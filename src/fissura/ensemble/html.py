"""What a notebook shows of an ensemble or a parameter study: key numbers, and its curves as a picture in the page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fissura.pictures.attempted import attempted
from fissura.pictures.html import embedded, notebook_html

if TYPE_CHECKING:
    from fissura.ensemble.result import EnsembleResult

__all__ = ["ensemble_html"]

#: Runs that are named one by one, at most.
_TOLD = 10


def ensemble_html(result: EnsembleResult) -> str:
    """HTML of an ensemble; whatever users wrote stands there letter by letter."""
    unfinished = [f"{name} {reason}" for name, reason in result.unfinished()]
    if len(unfinished) > _TOLD:
        unfinished = [*unfinished[:_TOLD], f"{len(unfinished) - _TOLD} more runs did not finish"]
    rows = [*result.table(), ("results", str(result.folder))]
    return notebook_html(rows, unfinished, attempted("the curves", lambda: _picture(result)))


def _picture(result: EnsembleResult) -> str | None:
    from fissura.ensemble.curve_picture import plot_curves
    from fissura.ensemble.study_pictures import plot_study_curves

    figure = (plot_study_curves if result.plan.vary else plot_curves)(result)
    return None if figure is None else embedded(figure, f"curves of {result.plan.case.name}")
