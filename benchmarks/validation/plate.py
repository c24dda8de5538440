"""Nooru-Mohamed's plate, load paths 4a and 4b and tension alone: cracks and peaks of several seeds, docs/validation.md.

Runs of examples/nooru_mohamed.toml. They are kept in a folder, and what is there is not run again.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from statistics import mean
from typing import Any

import above  # noqa: F401

from common import ROOT, Check, Report, main, options, say, shown, table
from fissura import run_ensemble
from loading import RUNS, angle, case_of

#: Runs of benchmarks/loading.py, by what they are called in the test; the tips of the notches [m].
PATHS = {
    "tension alone": "tension alone",
    "4a, shear of 5 kN": "shear of 5 kN, then tension",
    "4b, shear of 10 kN": "shear of 10 kN, then tension",
}
TIPS = {"left": (0.025, 0.1), "right": (0.175, 0.1)}


def produce(found: argparse.Namespace) -> Report:
    """Run all paths with several structures."""
    rows: list[dict[str, Any]] = []
    for k, name in enumerate(PATHS):
        say(f"{name}: {found.runs} realisations")
        folder = found.keep / f"plate_{k}"
        there = (folder / "ensemble.json").exists()
        case = case_of(*RUNS[PATHS[name]], 1)
        ensemble = run_ensemble(case, found.runs, output=folder, companions="none", keep=True, resume=there, seed=1)
        for j, number in enumerate(ensemble.runs["number"]):
            if ensemble.runs["status"][j] == "failed":
                continue
            last = ensemble.result(int(number)).last
            rows.append(
                {
                    "case": name,
                    "number": int(number),
                    "finished": bool(ensemble.runs["status"][j] == "finished"),
                    "peak_N": float(ensemble.runs["peak_load_N"][j]),
                    **{side: angle(last, tip, 0) for side, tip in TIPS.items()},
                }
            )
    return Report("plate", rows, _markdown(rows), _checks(rows))


def _angles(rows: list[dict[str, Any]], name: str) -> list[float]:
    """Mean inclination of both cracks, by realisation."""
    return [mean(row[side] for side in TIPS) for row in rows if row["case"] == name]


def _markdown(rows: list[dict[str, Any]]) -> str:
    lines = []
    for name in PATHS:
        mine = [row for row in rows if row["case"] == name]
        lines.append(
            [
                name,
                f"{len(mine)}",
                shown((row["peak_N"] / 1e3 for row in mine), 1),
                *(shown((row[side] for row in mine), 0) for side in TIPS),
            ]
        )
    heads = ["load path", "realisations", "largest tension [kN]", "left crack [°]", "right crack [°]"]
    return "\n\n".join(
        [
            "### Plate: what was computed",
            "Means ± standard deviations of single realisations, adaptive. Inclinations are those against the plane of"
            " the notches, within 30 mm of their tips, at the end of the runs.",
            table(heads, lines),
        ]
    )


def _checks(rows: list[dict[str, Any]]) -> list[Check]:
    alone, low, high = (mean(_angles(rows, name)) for name in PATHS)
    return [
        Check("runs that stopped", sum(not row["finished"] for row in rows), 0),
        Check("5 kN over tension alone: steeper by [°]", low - alone, 0.0, at_least=True),
        Check("10 over 5 kN: steeper by [°]", high - low, 0.0, at_least=True),
    ]


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--runs", type=int, default=3, metavar="N", help="realisations of each path")
    parser.add_argument("--keep", type=Path, default=ROOT / "results" / "validation", help="folder for the runs")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["all"], [1], more=_more)))
