"""Ensembles: whether all realisations run to the end, what two workers gain, and adaptive against full resolution.

All three measure `fissura.run_ensemble` itself. An ensemble that was interrupted is gone on with, but times are only
measured of one that ran through: remove the folder (--folder) to measure again.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import time
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from common import ROOT, Check, Report, example, main, options, say, table
from fissura import EnsembleResult, run_ensemble
from fissura.results.compare import compare

#: Largest load difference between adaptive and full resolution of every realisation [per cent of the peak].
LIMITS = {"random_notched": 1.0, "random_unnotched": 2.0}
#: Smallest speed-up from one worker to two.
SPEED_UP = 1.7

TEXT = """\
Realisations have other nuclei and another random field each (mode `both`). *Whole time* is from the start of the worker
processes to the last result; the speed-up is the ratio of its medians, one and two workers in turns. What else the
machine does at the time takes part in it.
"""

AGAINST = """\
The same realisation, its random field included, adaptive and at full resolution: largest difference of the load over
the whole common curve, per cent of the peak at full resolution.
"""


def more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--runs", type=int, default=100, metavar="N", help="realisations of each case: %(default)s")
    parser.add_argument("--short", type=int, default=40, metavar="N", help="realisations to time workers: %(default)s")
    parser.add_argument(
        "--repeats", type=int, default=2, metavar="N", help="of timing one and two workers: %(default)s"
    )
    parser.add_argument("--against", type=int, default=10, metavar="N", help="at full resolution, too: %(default)s")
    parser.add_argument("--workers", type=int, default=2, metavar="N", help="processes for all else: %(default)s")
    parser.add_argument("--folder", type=Path, default=ROOT / "results" / "benchmark_ensemble", metavar="DIR")


def produce(found: argparse.Namespace) -> Report:
    (seed,) = found.seeds
    rows: list[dict[str, Any]] = []
    for name in found.cases:
        say(f"{name}: {found.runs} realisations")
        rows.append({"kind": "whole", "case": name, **whole(found, name, seed)})
    timed = found.cases[0]
    for repeat in range(found.repeats):
        for workers in (1, 2):
            say(f"{timed}: {found.short} realisations with {workers} worker(s), repeat {repeat + 1}")
            rows.append({"kind": "workers", "case": timed, "workers": workers, **time_workers(found, seed, workers)})
    for name in found.cases:
        say(f"{name}: {found.against} realisations at full resolution")
        rows += [{"kind": "against", "case": name, **row} for row in against(found, name, seed)]
    return Report("ensemble", rows, markdown(rows), checks(rows, found))


def timed_ensemble(
    folder: Path, name: str, runs: int, seed: int, workers: int, **options: Any
) -> tuple[EnsembleResult, float]:
    """An ensemble, gone on with if it is there, and the time until its last result [s]; nan if part of it was there."""
    began, ended, there = 0.0, 0.0, 0

    def start(plan: object, missing: int, before: int) -> None:
        nonlocal began, there
        began, there = time.perf_counter(), before

    def note(summary: object) -> None:
        nonlocal ended
        ended = time.perf_counter()

    resume = (folder / "ensemble.json").exists()
    result = run_ensemble(
        example(name, 1),
        runs,
        output=folder,
        seed=seed,
        workers=workers,
        resume=resume,
        on_start=start,
        on_outcome=note,
        **options,
    )
    return result, float("nan") if there else ended - began


def whole(found: argparse.Namespace, name: str, seed: int) -> dict[str, Any]:
    folder = found.folder / name
    result, wall = timed_ensemble(folder, name, found.runs, seed, found.workers)
    note = folder / "wall.json"  # the time is kept for later calls that find the ensemble there
    if np.isfinite(wall):
        note.write_text(json.dumps(wall))
    elif note.exists():
        wall = json.loads(note.read_text())
    rows, peak = result.runs, result.statistics.rows["peak_load_N"]
    return {
        "runs": found.runs,
        "finished": result.count("finished"),
        "unfinished": result.unfinished(),
        "wall_s": wall,
        "cpu_median_s": float(np.nanmedian(rows["cpu_s"])),
        "cpu_s": float(np.nansum(result.rows["cpu_s"])),
        "mean_N": peak["mean"],
        "cov": peak["cov"],
        "workers": found.workers,
    }


def time_workers(found: argparse.Namespace, seed: int, workers: int) -> dict[str, Any]:
    folder = found.folder / f"workers_{workers}"
    shutil.rmtree(folder, ignore_errors=True)
    result, wall = timed_ensemble(folder, found.cases[0], found.short, seed, workers, companions="none")
    return {"wall_s": wall, "finished": result.count("finished"), "cpu_s": float(np.nansum(result.rows["cpu_s"]))}


def against(found: argparse.Namespace, name: str, seed: int) -> list[dict[str, Any]]:
    full, _ = timed_ensemble(
        found.folder / f"{name}_full", name, found.against, seed, found.workers, full=True, companions="none"
    )
    adaptive = EnsembleResult.load(found.folder / name)
    rows = []
    for number in range(1, found.against + 1):
        between = compare(adaptive.place(number), full.place(number))
        rows.append(
            {
                "number": number,
                "load_difference": 100 * between.max_load_difference,
                "peak_difference": 100 * between.peak_difference,
                "energy_difference": 100 * between.energy_difference,
                "bodies_end": between.a.summary["bodies_end"],
                "bodies_full": between.a.summary["bodies_full"],
                "cpu_ratio": between.cpu_ratio,
            }
        )
    return rows


def of_kind(rows: list[dict[str, Any]], kind: str) -> list[dict[str, Any]]:
    return [row for row in rows if row["kind"] == kind]


def speed_up(rows: list[dict[str, Any]]) -> float:
    one, two = ([row["wall_s"] for row in of_kind(rows, "workers") if row["workers"] == n] for n in (1, 2))
    return median(one) / median(two) if one and two else float("nan")


def markdown(rows: list[dict[str, Any]]) -> str:
    heads = [
        "case",
        "runs",
        "finished",
        "whole time [s]",
        "workers",
        "processor time of a run, median [s]",
        "mean peak [N]",
        "CoV [%]",
    ]
    lines = [
        [
            f"`{row['case']}`",
            f"{row['runs']}",
            f"{row['finished']}",
            f"{row['wall_s']:.0f}",
            f"{row['workers']}",
            f"{row['cpu_median_s']:.2f}",
            f"{row['mean_N']:.0f}",
            f"{100 * row['cov']:.1f}",
        ]
        for row in of_kind(rows, "whole")
    ]
    parts = ["## Ensembles", TEXT, table(heads, lines), ""]
    parts += [
        f"* did not finish: `{row['case']}` {name}: {why}"
        for row in of_kind(rows, "whole")
        for name, why in row["unfinished"]
    ]
    workers = of_kind(rows, "workers")
    if workers:
        lines = [[f"{row['workers']}", f"{row['wall_s']:.1f}", f"{row['cpu_s']:.1f}"] for row in workers]
        parts += ["", table(["workers", "whole time [s]", "processor time of all runs [s]"], lines)]
        parts += ["", f"Speed-up from one worker to two, `{workers[0]['case']}`: **{speed_up(rows):.2f}**.", ""]
    parts += ["### Adaptive against full resolution, with random fields\n", AGAINST]
    columns = [
        ("load_difference", "load, largest [%]", ".3f"),
        ("peak_difference", "peak [%]", "+.3f"),
        ("energy_difference", "energy [%]", "+.3f"),
        ("bodies_end", "bodies at end", ".0f"),
        ("bodies_full", "full", ".0f"),
    ]
    lines = [
        [f"`{row['case']}` {row['number']}", *(format(row[key], form) for key, _, form in columns)]
        for row in of_kind(rows, "against")
    ]
    return "\n".join([*parts, table(["realisation", *(head for _, head, _ in columns)], lines)])


def checks(rows: list[dict[str, Any]], found: argparse.Namespace) -> list[Check]:
    out = [Check(f"{row['case']}, runs not finished", len(row["unfinished"]), 0) for row in of_kind(rows, "whole")]
    if found.repeats:
        out.append(Check("speed-up from 1 to 2 workers", speed_up(rows), SPEED_UP, at_least=True))
    for row in of_kind(rows, "against"):
        name = f"{row['case']}, realisation {row['number']}, load_difference [%]"
        out.append(Check(name, row["load_difference"], LIMITS.get(row["case"], 2.0)))
    return out


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["random_unnotched", "random_notched"], [1], more=more)))
