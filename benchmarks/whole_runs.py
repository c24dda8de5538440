"""Whole runs: time, memory and iterations of large specimens, a published beam, and an earlier version.

Every run is a process of its own, so that its memory is its own. Parts:
  peer     examples/beam_350.toml, for which another code's times were measured on a machine of this kind
  large    examples/beam_d400.toml at full resolution, and its first ten steps with the direct solver
  bar      examples/notched_bar.toml with 100 000 bodies, to its peak and beyond
  before   examples/beam_d100.toml at full resolution, against a checkout of an earlier version given by --before
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from typing import Any

from common import ROOT, Check, Report, main, options, say, table
from fissura import RunStopped, Simulation, load_case
from fissura.results.summary import peak_memory

#: Processor seconds of the OAS code for the beam of 350 mm on a machine of this kind, full and adaptive (least).
PEER = {True: 330.0, False: 25.0}
#: How many times less is wanted.
PEER_FACTOR, BEFORE_FACTOR = 8.0, 3.0
#: Largest memory of the 400 mm beam [MB].
MEMORY = 2000.0
#: Spacing at which the bars have 100 000 bodies [m].
FINE_BAR = 3.13e-3
#: Share of its peak load at which the run of the bar ends.
LEFT = 0.75
#: Processor seconds after which a run is ended and what there is of it reported.
LIMIT = 3600.0
#: Interleaved repeats of short runs.
REPEATS = 3


def child(name: str, full: bool, steps: int, changes: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """Run a case of the examples, as far as a number of steps, and report what it took."""
    cpu, wall = time.process_time(), time.perf_counter()
    case = load_case(ROOT / "examples" / f"{name}.toml")
    update = {key: getattr(case, key).model_copy(update=value) for key, value in changes.items()}
    simulation = Simulation(case.model_copy(update=update), full=full)
    rows: list[dict[str, float]] = []
    start, finished = time.process_time() - cpu, True
    try:
        for step in simulation.steps():
            names = ("gauge", "load", "residual", "bodies", "iterations", "factorizations", "linear_iterations")
            rows.append({key: float(getattr(step, key, 0.0)) for key in names})
            if len(rows) == steps or time.process_time() - cpu > LIMIT:
                finished = len(rows) == steps
                break
    except RunStopped as error:
        print(error, file=sys.stderr)
        finished = False
    load = [row["load"] for row in rows]
    total = {key: sum(row[key] for row in rows) for key in ("iterations", "factorizations", "linear_iterations")}
    return {
        "case": name,
        "full": full,
        "finished": finished,
        "bodies": int(rows[-1]["bodies"]),
        "bodies_start": int(rows[0]["bodies"]),
        "steps": len(rows),
        "peak_N": max(load, key=abs),
        "last_N": load[-1],
        "residual": max(row["residual"] for row in rows),
        "most": max(row["iterations"] for row in rows),
        "cpu_s": time.process_time() - cpu,
        "cpu_start_s": start,
        "wall_s": time.perf_counter() - wall,
        "memory_MB": peak_memory() / 1e6,
        **{f"{key}_per_step": value / len(rows) for key, value in total.items()},
    }


def run_apart(
    name: str, *, full: bool, steps: int = 0, source: Path = ROOT, **changes: dict[str, Any]
) -> dict[str, Any]:
    """The same in a process of its own, with the package of a checkout."""
    script = Path(__file__).resolve()
    order = json.dumps({"name": name, "full": full, "steps": steps, "changes": changes})
    environment = {**os.environ, "PYTHONPATH": str(source / "src")}
    done = subprocess.run(
        [sys.executable, str(script), "--child", order], env=environment, stdout=subprocess.PIPE, check=True, text=True
    )
    row: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    say(f"  {name}, {'full' if full else 'adaptive'}: {row['cpu_s']:.1f} s, {row['memory_MB']:.0f} MB")
    return row


def produce(found: argparse.Namespace) -> Report:
    rows: list[dict[str, Any]] = []
    checks: list[Check] = []
    for part in found.cases:
        say(part)
        more, verdicts = PARTS[part](found)
        rows += [{"part": part} | row for row in more]
        checks += verdicts
    return Report("whole_runs", rows, _markdown(rows), checks)


def _peer(found: argparse.Namespace) -> tuple[list[dict[str, Any]], list[Check]]:
    rows, checks = [], []
    for full, theirs in PEER.items():
        runs = [run_apart("beam_350", full=full) for _ in range(REPEATS)]
        row = runs[0] | {"cpu_s": median(run["cpu_s"] for run in runs), "note": f"other code {theirs:g} s"}
        kind = "full" if full else "adaptive"
        rows.append(row)
        checks.append(
            Check(f"beam_350 {kind}: other code's time over ours", theirs / row["cpu_s"], PEER_FACTOR, at_least=True)
        )
        checks.append(Check(f"beam_350 {kind}: largest residual", row["residual"], 1e-4))
    here = [row["peak_N"] for row in rows]
    checks.append(Check("beam_350: peak, adaptive against full [%]", abs(here[1] / here[0] - 1) * 100, 1.0))
    return rows, checks


def _large(found: argparse.Namespace) -> tuple[list[dict[str, Any]], list[Check]]:
    whole = run_apart("beam_d400", full=True)
    ten = run_apart("beam_d400", full=True, steps=10) | {"note": "first ten steps"}
    direct = run_apart("beam_d400", full=True, steps=10, solver={"linear": "direct"})
    direct |= {"note": "first ten steps, direct solver"}
    checks = [
        Check("beam_d400: runs that did not finish", float(not whole["finished"]), 0),
        Check("beam_d400: memory [MB]", whole["memory_MB"], MEMORY),
    ]
    return [whole, ten, direct], checks


def _bar(found: argparse.Namespace) -> tuple[list[dict[str, Any]], list[Check]]:
    row = run_apart(
        "notched_bar",
        full=True,
        discretization={"l_f": FINE_BAR, "l_c": 4 * FINE_BAR},
        control={"stop_load": LEFT},
    )
    checks = [
        Check("notched_bar: runs that did not finish", float(not row["finished"]), 0),
        Check("notched_bar: bodies", row["bodies"], 95_000, at_least=True),
        Check("notched_bar: last load over peak", row["last_N"] / row["peak_N"], LEFT),
        Check("notched_bar: largest residual", row["residual"], 1e-4),
    ]
    return [row], checks


def _before(found: argparse.Namespace) -> tuple[list[dict[str, Any]], list[Check]]:
    if found.before is None:
        say("  left out: no --before")
        return [], []
    runs: list[tuple[dict[str, Any], dict[str, Any]]] = []
    for _ in range(REPEATS):
        runs.append((run_apart("beam_d100", full=True, source=found.before), run_apart("beam_d100", full=True)))
    before, now = (median(pair[k]["cpu_s"] for pair in runs) for k in (0, 1))
    rows = [runs[0][0] | {"cpu_s": before, "note": "earlier version"}, runs[0][1] | {"cpu_s": now}]
    return rows, [
        Check("beam_d100 full: time of the earlier version over this one's", before / now, BEFORE_FACTOR, True)
    ]


PARTS = {"peer": _peer, "large": _large, "bar": _bar, "before": _before}

TEXT = """\
Bodies at the end; Newton or secant corrections, preconditioner iterations and factorizations for each accepted step;
processor time of the whole process from reading the case on, without writing files; peak memory of the process.
"""

COLUMNS = [
    ("bodies", "bodies", ".0f"),
    ("steps", "steps", ".0f"),
    ("iterations_per_step", "corrections", ".1f"),
    ("linear_iterations_per_step", "iterations", ".1f"),
    ("factorizations_per_step", "factorizations", ".2f"),
    ("residual", "largest residual", ".1e"),
    ("peak_N", "peak [N]", ".0f"),
    ("last_N", "last load [N]", ".0f"),
    ("cpu_s", "CPU [s]", ".1f"),
    ("wall_s", "wall [s]", ".1f"),
    ("memory_MB", "memory [MB]", ".0f"),
]


def _markdown(rows: list[dict[str, Any]]) -> str:
    heads = ["run", *(head for _, head, _ in COLUMNS), "note"]
    lines = []
    for row in rows:
        kind = "full" if row["full"] else "adaptive"
        note = row.get("note", "") + ("" if row["finished"] else " (stopped early)")
        lines.append([f"`{row['case']}` {kind}", *(f"{row[key]:{form}}" for key, _, form in COLUMNS), note])
    return "\n".join(["## Whole runs", TEXT, table(heads, lines)])


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "--child":
        print(json.dumps(child(**json.loads(sys.argv[2]))))
        sys.exit(0)
    sys.exit(main(produce, options(__doc__, list(PARTS), [1], before=True)))
