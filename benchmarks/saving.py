"""What adaptivity saves: processor time and memory against full resolution, and growth with the specimen.

Both runs of a specimen follow each other in one process, so that a busy machine slows both; memory is that of processes
of their own. Each run uses the solver that suits it (`solver.linear = "auto"`). Specimens:
  beam_d100, beam_d200, beam_d400   examples, half-notched, as deep as the name says in mm, the same l_f
  unnotched_d200                    the specimen of benchmarks/study.toml
"""

from __future__ import annotations

import argparse
import sys
from statistics import median
from typing import Any

from common import ROOT, Check, Report, changed, difference, example, main, measured, options, say, table
from fissura import Case
from fissura.study.definition import load_study
from whole_runs import run_apart

#: Specimens and their seeds: large ones take minutes.
SEEDS = {"beam_d100": [1, 2, 3], "beam_d200": [1, 2, 3], "beam_d400": [1], "unnotched_d200": [1, 2, 4]}
#: Wanted saving of processor time.
FASTER = {"beam_d200": 6.0, "beam_d400": 20.0, "unnotched_d200": 3.0}
#: Wanted growth of an adaptive run from the first to the second specimen, at most.
GROWTH = ("beam_d100", "beam_d400", 6.0)
#: Specimens whose memory is measured, and the wanted saving.
MEMORY = {"beam_d200": 0.0, "beam_d400": 6.0}

TEXT = """\
Medians over {seeds} seeds (`beam_d400`: one). *Saving* is the time at full resolution over that of the adaptive run;
*bodies* compares full resolution with the mean over the linear iterations of the adaptive run, which is the most that
a solver of linear cost can save; *iterations* are linear ones.
"""


def case_of(name: str, seed: int) -> Case:
    """A specimen by its name."""
    if (ROOT / "examples" / f"{name}.toml").exists():
        return example(name, seed)
    case = load_study(ROOT / "benchmarks" / "study.toml").cases[name, "default"]
    return changed(case, seed=seed, output={"vtk": 0, "measured": None})


def produce(found: argparse.Namespace) -> Report:
    rows: list[dict[str, Any]] = []
    for name in found.cases:
        for seed in SEEDS[name]:
            case = case_of(name, seed)
            say(f"{name}, seed {seed}: adaptive")
            adaptive = measured(case)
            say(f"  {adaptive.cpu_s:.1f} s; full")
            full = measured(case, full=True)
            row = {"case": name, "seed": seed, **difference(adaptive, full)}
            for kind, run in (("adaptive", adaptive), ("full", full)):
                row[f"iterations_{kind}"] = float(run.result.curve["linear_iterations"].sum())
                work = run.result.curve["linear_iterations"] * run.result.curve["bodies"]
                row[f"bodies_{kind}"] = float(work.sum()) / row[f"iterations_{kind}"]
            rows.append(row)
            say(f"  {full.cpu_s:.1f} s; {row['cpu_ratio']:.1f} times less")
    memory = {name: _memory(name) for name in MEMORY if name in found.cases}
    return Report(
        "saving", rows + [{"case": n, **m} for n, m in memory.items()], _markdown(rows, memory), _checks(rows, memory)
    )


def _memory(name: str) -> dict[str, float]:
    """Peak memory of processes that run a case [MB]: both resolutions, and what libraries alone take."""
    runs = {"adaptive": run_apart(name, full=False), "full": run_apart(name, full=True)}
    bare = run_apart("beam_d100", full=False, steps=1)
    return {"libraries": bare["memory_MB"]} | {kind: run["memory_MB"] for kind, run in runs.items()}


def _of(rows: list[dict[str, Any]], name: str, key: str) -> float:
    return median(row[key] for row in rows if row["case"] == name)


def _markdown(rows: list[dict[str, Any]], memory: dict[str, dict[str, float]]) -> str:
    heads = [
        "specimen",
        "load, largest [%]",
        "adaptive [s]",
        "full [s]",
        "saving",
        "bodies",
        "iterations, full over adaptive",
    ]
    lines = []
    for name in dict.fromkeys(row["case"] for row in rows):
        bodies = _of(rows, name, "bodies_full") / _of(rows, name, "bodies_adaptive")
        iterations = _of(rows, name, "iterations_full") / _of(rows, name, "iterations_adaptive")
        lines.append(
            [
                name,
                f"{_of(rows, name, 'load_difference'):.2f}",
                f"{_of(rows, name, 'cpu_adaptive_s'):.1f}",
                f"{_of(rows, name, 'cpu_full_s'):.1f}",
                f"{_of(rows, name, 'cpu_ratio'):.1f}",
                f"{bodies:.1f}",
                f"{iterations:.2f}",
            ]
        )
    parts = ["## What it saves", TEXT.format(seeds=len(SEEDS["beam_d200"])), table(heads, lines)]
    if memory:
        heads = ["specimen", "libraries alone [MB]", "adaptive [MB]", "full [MB]"]
        keys = ("libraries", "adaptive", "full")
        parts += ["", table(heads, [[name, *(f"{sizes[key]:.0f}" for key in keys)] for name, sizes in memory.items()])]
    names = {row["case"] for row in rows}
    if {*GROWTH[:2]} <= names:
        small, large = (_of(rows, name, "cpu_adaptive_s") for name in GROWTH[:2])
        parts += ["", f"From `{GROWTH[0]}` to `{GROWTH[1]}` an adaptive run takes {large / small:.1f} times as long."]
    return "\n".join(parts)


def _checks(rows: list[dict[str, Any]], memory: dict[str, dict[str, float]]) -> list[Check]:
    names = {row["case"] for row in rows}
    checks = [
        Check(f"{name}: saving of processor time", _of(rows, name, "cpu_ratio"), wanted, at_least=True)
        for name, wanted in FASTER.items()
        if name in names
    ]
    first, second, limit = GROWTH
    if {first, second} <= names:
        growth = _of(rows, second, "cpu_adaptive_s") / _of(rows, first, "cpu_adaptive_s")
        checks.append(Check(f"{first} to {second}: growth of processor time", growth, limit))
    for name, sizes in memory.items():
        if MEMORY[name]:
            ratio = sizes["full"] / sizes["adaptive"]
            checks.append(Check(f"{name}: saving of memory", ratio, MEMORY[name], at_least=True))
    return checks


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, list(SEEDS), [])))
