"""The rows of name and value that describe an ensemble or a parameter study."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fissura.text import quantities as text

if TYPE_CHECKING:
    from fissura.ensemble.result import EnsembleResult

_RANDOM = {"geometry": "nuclei", "field": "field", "both": "nuclei and field"}

#: Points of a study that are told one by one, at most.
_TOLD = 12

Rows = list[tuple[str, str]]


def rows_of(result: EnsembleResult) -> Rows:
    """Rows of name and value that describe the ensemble."""
    plan = result.plan
    seeds = f"seeds {', '.join(map(str, plan.chosen))}" if plan.chosen else f"{plan.sampling}, seed {plan.master}"
    rows = [
        ("case", f"{plan.case.name}, {'full resolution' if plan.full else 'adaptive'}"),
        ("random", f"{_RANDOM[plan.mode]}, {seeds}"),
    ]
    if plan.vary:
        rows.append(("varied", ", ".join(f"{key} ({len(set(values))} values)" for key, values in _given(plan.vary))))
    rows += [("runs", _counts(result)), *(_by_point(result) if plan.vary else _peaks(result))]
    counted = result.statistics.counted
    early = int((counted & ~result.runs["past_peak"]).sum())
    if early:
        rows.append(("note", f"{early} finished less than 20 % below their largest load: it may not be their peak"))
    times = result.rows["cpu_s"][np.isfinite(result.rows["cpu_s"])]
    rows.append(("processor time", f"{text.seconds(float(times.sum()))} in all"))
    return rows


def _given(vary: dict[str, tuple[object, ...]]) -> list[tuple[str, list[str]]]:
    return [(key, [str(value) for value in values]) for key, values in vary.items()]


def _by_point(result: EnsembleResult) -> Rows:
    """The peaks at each point of a study."""
    rows = []
    for point, group in zip(result.plan.points[:_TOLD], result.groups, strict=False):
        peak = group.statistics.rows["peak_load_N"]
        if peak["n"] > 1:
            low, high = group.statistics.convergence.mean[-1, 1:]
            value = f"{text.force(peak['mean'])} (95 %: {text.force(low)} to {text.force(high)})"
            value += f", CoV {text.per_cent(peak['cov'])}"
        else:
            value = text.force(peak["mean"]) if peak["n"] else "-"
        rows.append((f"peak at {point.label}", value))
    if len(result.plan.points) > _TOLD:
        rows.append(("more", f"{len(result.plan.points) - _TOLD} points, in groups.csv"))
    return rows


def _peaks(result: EnsembleResult) -> Rows:
    """Mean, scatter and fits of the peaks of an ensemble."""
    found, rows = result.statistics, []
    peak = found.rows["peak_load_N"]
    if peak["n"] > 1:
        mean, cov = found.convergence.mean[-1], found.convergence.cov[-1]
        rows += [
            ("peak load, mean", f"{text.force(mean[0])} (95 %: {text.force(mean[1])} to {text.force(mean[2])})"),
            (
                "scatter (CoV)",
                f"{text.per_cent(cov[0])} (95 %: {text.per_cent(cov[1])} to {text.per_cent(cov[2])})",
            ),
            ("5 % and 95 % of peaks", f"{text.force(peak['p05'])}, {text.force(peak['p95'])}"),
        ]
        for name, fit in found.fits.items():
            values = ", ".join(_parameter(key, value) for key, value in fit.parameters.items())
            rows.append((f"{name} fit", f"{values}; p = {fit.p_value:.2f}"))
    elif peak["n"] == 1:
        rows.append(("peak load", text.force(peak["mean"])))
    counted = np.abs(result.companions["peak_load_N"][result.companions["status"] == "finished"])
    if len(counted):
        note = "" if len(counted) == 1 else f" (mean of {len(counted)})"
        rows.append(("deterministic peak", text.force(float(counted.mean())) + note))
    return rows


def _counts(result: EnsembleResult) -> str:
    wanted = result.plan.runs * len(result.plan.points)
    parts = [f"{result.count('finished')} of {wanted} finished"]
    parts += [f"{result.count(status)} {status}" for status in ("stopped", "failed") if result.count(status)]
    bad = int((result.companions["status"] != "finished").sum())
    return ", ".join(parts) + (f"; {bad} of the companions did not finish" if bad else "")


def _parameter(key: str, values: tuple[float, float, float]) -> str:
    show = (lambda value: f"{value:.3g}") if key == "shape" else text.force
    return f"{key} {show(values[0])} (90 %: {show(values[1])} to {'∞' if math.isinf(values[2]) else show(values[2])})"
