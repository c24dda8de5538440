"""Rows of name and value that describe a run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fissura.results.names import load_name
from fissura.results.peak import peak_position
from fissura.text import quantities as text

if TYPE_CHECKING:
    from fissura.results.result import Result

__all__ = ["rows_of"]


def rows_of(result: Result) -> list[tuple[str, str]]:
    """Rows of name and value that describe a run."""
    s, number = result.summary, result.number
    kind = "full resolution" if result.full else f"adaptive ({s.get('criterion')})"
    led = f" ({s['steps_led_by_energy']} under dissipation control)" if s.get("steps_led_by_energy") else ""
    coarser = f"{s['coarsenings']} coarsenings, " if s.get("coarsenings") else ""
    at_peak = float(result.controlled[peak_position(result.load_values)]) if result.steps else math.nan
    bodies = " → ".join(text.count(number(key)) for key in ("bodies_start", "bodies_end"))
    return [
        ("case", f"{s.get('case')}, seed {s.get('seed')}, {kind}"),
        ("status", ": ".join(str(s[key]) for key in ("status", "message") if s.get(key))),
        (
            load_name(result.case).replace("load", "peak load"),
            f"{text.force(result.peak_load)} at {text.length(at_peak)}",
        ),
        ("initial stiffness", text.stiffness(result.initial_stiffness)),
        ("dissipated energy", text.energy(result.dissipated_energy)),
        ("energy balance error", text.per_cent(number("energy_balance_error"))),
        ("load and reactions differ by", text.per_cent(number("unbalanced_force"))),
        (
            "largest elastic utilisation",
            text.per_cent(number("max_elastic_utilisation")) + " of the strength, in elastic contacts",
        ),
        *_precision(result),
        ("bodies", f"{bodies} (full: {text.count(number('bodies_full'))})"),
        (
            "steps",
            f"{result.steps}{led} with {s.get('refinements')} refinements, {coarser}{s.get('iterations')} iterations",
        ),
        ("time", f"{text.seconds(number('wall_s'))} (processor time {text.seconds(number('cpu_s'))})"),
        ("memory", f"{number('peak_memory_MB'):.0f} MB"),
    ]


def _precision(result: Result) -> list[tuple[str, str]]:
    """Row about the error of adaptivity; none at full resolution."""
    if result.summary.get("load_error_bound") is None:
        return []
    bound = text.per_cent(result.number("load_error_bound"))
    return [("estimated load error", f"at most {bound} of the peak (holds in 9 of 10 runs)")]
