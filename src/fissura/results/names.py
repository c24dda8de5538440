"""What the loads and gauges of a case are called in pictures, tables and progress."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fissura.case.programme import GRAVITY

if TYPE_CHECKING:
    from fissura.case import Case, Quantity
    from fissura.simulation.step import Step

__all__ = ["driven_in", "load_name", "value_axis"]

#: Names that are told one by one, at most.
_TOLD = 3


def load_name(case: Case, ratios: Sequence[tuple[str, float]] | None = None) -> str:
    """Name of the load of the last stage, or of another one.

    Parameters
    ----------
    case : Case
        What is run.
    ratios : sequence of (str, float), optional
        Loads that a stage drives; those of the last one by default.

    Returns
    -------
    str
        "load" where it needs no name, else the names of all that are driven.
    """
    names = [name for name, _ in (case.main.ratios if ratios is None else ratios)]
    if names == ["load"]:
        return "load"
    told = names if len(names) <= _TOLD else [*names[: _TOLD - 1], "..."]
    return f"load ({', '.join(told)})"


def value_axis(case: Case, quantity: Quantity) -> str:
    """What an axis of the gauge of the last stage, or of the displacement of its load, is called, without its unit."""
    if quantity == "displacement":
        return "displacement of the load"
    gauge = case.main.gauge
    return "gauge opening" if gauge in (None, "gauge") else f"gauge {gauge}"


def driven_in(case: Case, step: Step) -> tuple[str, float]:
    """Name and load factor [N] of what a step drives."""
    ratios = case.stages[step.stage - 1].ratios if step.stage else ((GRAVITY, 1.0),)
    if ratios == case.main.ratios:
        return load_name(case), step.load
    factor = sum(ratio * step.forces[name] for name, ratio in ratios) / sum(ratio**2 for _, ratio in ratios)
    return load_name(case, ratios), factor
