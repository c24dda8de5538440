"""Whole runs against an earlier version: processor time of the beams of 200 and 400 mm, both versions by turns.

--before DIR names a checkout of the earlier version; the page names its commit. Both run the examples of this version,
each run in a process of its own. Another version places other nuclei and may cut notches otherwise, so that the
specimens are not the same: times are told per body and linear iteration, too.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from itertools import product
from pathlib import Path
from statistics import median
from typing import Any

from common import ROOT, Check, Report, main, options, say, table
from whole_runs import run_apart

#: Interleaved repeats, and the most that a run may take over one of the earlier version.
REPEATS, SLOWER = 3, 1.05
#: Steps of a run before, which compiles the kernels of both versions.
FIRST = 12

TEXT = """\
`{case}`, medians of {repeats} runs of each by turns; *earlier* is commit {commit}. Bodies at the end; steps; linear
iterations and corrections of all steps; processor time of the whole process from reading the case on, without
writing files, and its smallest and largest; the same for a body and a linear iteration; peak memory.
"""


def _commit(folder: Path) -> str:
    asked = ["git", "-C", str(folder), "rev-parse", "--short", "HEAD"]
    return subprocess.run(asked, stdout=subprocess.PIPE, check=True, text=True).stdout.strip()


def _row(version: str, runs: list[dict[str, Any]]) -> dict[str, Any]:
    times = [run["cpu_s"] for run in runs]
    first, steps = runs[0], runs[0]["steps"]
    linear = first["linear_iterations_per_step"] * steps
    return first | {
        "version": version,
        "linear": linear,
        "corrections": first["iterations_per_step"] * steps,
        "cpu_s": median(times),
        "least_s": min(times),
        "most_s": max(times),
        "ns": 1e9 * median(times) / (linear * first["bodies"]),
    }


def produce(found: argparse.Namespace) -> Report:
    rows, checks = [], []
    places = {"earlier": found.before, "now": ROOT}
    for name, full in product(found.cases, (False, True)):
        runs: dict[str, list[dict[str, Any]]] = {version: [] for version in places}
        for source in places.values():
            run_apart(name, full=full, steps=FIRST, source=source)
        for _ in range(REPEATS):
            for version, source in places.items():
                say(version)
                runs[version].append(run_apart(name, full=full, source=source))
        then, now = (_row(version, of) for version, of in runs.items())
        rows += [then, now]
        kind = f"{name}, {'full' if full else 'adaptive'}"
        checks.append(Check(f"{kind}: time over that of the earlier version", now["cpu_s"] / then["cpu_s"], SLOWER))
        checks.append(Check(f"{kind}: the same, for a body and a linear iteration", now["ns"] / then["ns"], SLOWER))
    text = TEXT.format(case="`, `".join(found.cases), repeats=REPEATS, commit=_commit(found.before))
    return Report("since", rows, "\n".join(["## Whole runs since version 0.1", text, _table(rows)]), checks)


def _table(rows: list[dict[str, Any]]) -> str:
    heads = ["run", "version", "bodies", "steps", "corrections", "linear iterations", "peak [N]", "CPU [s]"]
    heads += ["least to most", "for a body and an iteration [ns]", "memory [MB]"]
    lines = [
        [
            f"`{row['case']}` {'full' if row['full'] else 'adaptive'}",
            row["version"],
            *(f"{row[key]:.0f}" for key in ("bodies", "steps", "corrections", "linear", "peak_N")),
            f"{row['cpu_s']:.1f}",
            f"{row['least_s']:.1f} to {row['most_s']:.1f}",
            f"{row['ns']:.0f}",
            f"{row['memory_MB']:.0f}",
        ]
        for row in rows
    ]
    return table(heads, lines)


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["beam_d200", "beam_d400"], [1], before=True)))
