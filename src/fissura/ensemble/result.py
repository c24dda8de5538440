"""An ensemble that has been computed, in memory or reloaded from its folder."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fissura.ensemble.band import Band, band, write_band
from fissura.ensemble.plan import Kind, Plan
from fissura.ensemble.statistics import Statistics, statistics
from fissura.ensemble.table import Table, read_table, select
from fissura.files import write_json
from fissura.results import quantities as text
from fissura.results.curve import COLUMN_OF, read_curve
from fissura.results.path import LoadPath
from fissura.results.result import Result
from fissura.results.summary import read_summary

__all__ = ["EnsembleResult"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, repr=False, eq=False)
class EnsembleResult:
    """Results of an ensemble.

    Attributes
    ----------
    plan : Plan
        What was run.
    rows : dict of str to (n,) array
        The table of all runs and companions (`fissura.ensemble.table.COLUMNS`).
    folder : Path
        Where the files are.
    """

    plan: Plan
    rows: Table
    folder: Path

    @classmethod
    def of(cls, plan: Plan, rows: Table, folder: Path) -> EnsembleResult:
        """Result of a table of runs, in order of their numbers."""
        order = np.lexsort((rows["number"], rows["kind"]))
        return cls(plan, {name: column[order] for name, column in rows.items()}, folder)

    @classmethod
    def load(cls, folder: str | Path) -> EnsembleResult:
        """Read the folder of an ensemble.

        Raises
        ------
        InputError
            There is no ensemble, or a file of it is broken.
        """
        from fissura.case import case_from_dict
        from fissura.case.load import read_json

        folder = Path(folder)
        plan = read_summary(folder / "ensemble.json").get("plan", {})
        data = read_json(folder / "case.json", "the case.json of an ensemble")
        case = case_from_dict(data, folder, files_exist=False)
        named = {name: plan[name] for name in ("runs", "mode", "sampling", "full", "companions", "keep")}
        if plan["leading_modes"] is not None:
            named["leading_modes"] = plan["leading_modes"]
        return cls.of(Plan(case, master=plan["seed"], **named), read_table(folder), folder)

    @cached_property
    def runs(self) -> Table:
        """The runs, in order of their numbers."""
        return select(self.rows, self.rows["kind"] == "run")

    @cached_property
    def companions(self) -> Table:
        """The deterministic runs for comparison."""
        return select(self.rows, self.rows["kind"] == "companion")

    @property
    def peaks(self) -> FloatArray:
        """Magnitudes of the peak loads [N] of the runs that count, in order of number; see `Statistics`."""
        return self.statistics.peaks

    @cached_property
    def statistics(self) -> Statistics:
        """Statistics of the runs."""
        return statistics(self.runs, self.plan.master)

    @cached_property
    def paths(self) -> dict[int, LoadPath]:
        """Curves of all runs that have steps, by number."""
        return self._paths("run")

    @cached_property
    def companion_paths(self) -> dict[int, LoadPath]:
        """Curves of the companions, by number."""
        return self._paths("companion")

    @cached_property
    def band(self) -> Band | None:
        """Mean curve of the runs that finished; None if there are none."""
        finished = self.runs["number"][self.runs["status"] == "finished"]
        return band([self.paths[number] for number in finished.tolist() if number in self.paths])

    def place(self, number: int, kind: Kind = "run") -> Path:
        """Folder of a run or companion."""
        from fissura.ensemble.store import Store

        return Store(self.folder).place(kind, number)

    def result(self, number: int, kind: Kind = "run") -> Result:
        """A run, or a companion, as `Result`.

        Raises
        ------
        InputError
            There is no such run.
        """
        return Result.load(self.place(number, kind))

    def count(self, status: str) -> int:
        """Number of runs, without companions, that ended with a status."""
        return int((self.runs["status"] == status).sum())

    @property
    def complete(self) -> bool:
        """Whether every run and every companion finished."""
        return bool((self.rows["status"] == "finished").all()) and self.count("finished") == self.plan.runs

    def unfinished(self) -> list[tuple[str, str]]:
        """Name and reason of every run or companion that did not finish."""
        bad = select(self.rows, self.rows["status"] != "finished")
        return [
            (f"{kind} {number:04d}", f"{status}: {error}")
            for kind, number, status, error in zip(bad["kind"], bad["number"], bad["status"], bad["error"], strict=True)
        ]

    def write(self) -> None:
        """Write ``statistics.json`` and ``mean_curve.csv``."""
        write_json(self.folder / "statistics.json", self.statistics.as_dict())
        if self.band is not None:
            write_band(self.band, self.folder / "mean_curve.csv")

    def table(self) -> list[tuple[str, str]]:
        """Rows of name and value that describe the ensemble."""
        plan, found = self.plan, self.statistics
        rows = [
            ("case", f"{plan.case.name}, {'full resolution' if plan.full else 'adaptive'}"),
            ("random", f"{_RANDOM[plan.mode]}, {plan.sampling}, seed {plan.master}"),
            ("runs", _counts(self)),
        ]
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
        counted = np.abs(self.companions["peak_load_N"][self.companions["status"] == "finished"])
        if len(counted):
            note = "" if len(counted) == 1 else f" (mean of {len(counted)})"
            rows.append(("deterministic peak", text.force(float(counted.mean())) + note))
        early = int((found.counted & ~self.runs["past_peak"]).sum())
        if early:
            rows.append(("note", f"{early} finished less than 20 % below their largest load: it may not be their peak"))
        times = self.rows["cpu_s"][np.isfinite(self.rows["cpu_s"])]
        rows.append(("processor time", f"{text.seconds(float(times.sum()))} in all"))
        return rows

    def _paths(self, kind: Kind) -> dict[int, LoadPath]:
        of = select(self.rows, (self.rows["kind"] == kind) & (self.rows["steps"] > 0))
        found = {}
        for number in of["number"].tolist():
            curve: dict[str, Any] = read_curve(self.place(number, kind))
            if np.any(curve[COLUMN_OF[self.plan.case.quantity]] > 0):
                found[number] = LoadPath.of(curve, str(self.place(number, kind)), self.plan.case.quantity)
        return found

    def __repr__(self) -> str:
        width = max(len(name) for name, _ in self.table())
        return "\n".join(f"{name:<{width}}  {value}" for name, value in self.table())


_RANDOM = {"geometry": "nuclei", "field": "field", "both": "nuclei and field"}


def _counts(result: EnsembleResult) -> str:
    parts = [f"{result.count('finished')} of {result.plan.runs} finished"]
    parts += [f"{result.count(status)} {status}" for status in ("stopped", "failed") if result.count(status)]
    bad = int((result.companions["status"] != "finished").sum())
    return ", ".join(parts) + (f"; {bad} of the companions did not finish" if bad else "")


def _parameter(key: str, values: tuple[float, float, float]) -> str:
    show = (lambda value: f"{value:.3g}") if key == "shape" else text.force
    return f"{key} {show(values[0])} (90 %: {show(values[1])} to {'∞' if math.isinf(values[2]) else show(values[2])})"
