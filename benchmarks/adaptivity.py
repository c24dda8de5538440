"""How far adaptive runs are from full resolution, and what they save: the study of docs/study.md.

Runs benchmarks/study.toml, or what is left of it to do, and writes its tables and pictures. It may be interrupted; the
same command goes on from there.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from common import ROOT, Check, Report, main, options, say, table
from fissura.study.definition import load_study
from fissura.study.measures import Measures
from fissura.study.report import COLUMNS, summary_rows
from fissura.study.result import StudyResult
from fissura.study.runner import run_study, write_result
from fissura.study.statistics import correlations, fails, localisation

PICTURES = ("tradeoff", "errors", "indicators", "places")

#: Share of the runs that must keep a tolerance, or a bound of the error.
WANTED = 0.95

#: Variations that stand for a tolerance of the load; the default is 1 per cent.
TOLERANCES = {"tolerance 0.5 %": 0.005, "default": 0.01, "tolerance 5 %": 0.05}

TEXT = """\
{runs} adaptive runs against {full} at full resolution. Rows have the median over seeds and in brackets the worst.
Differences are per cent of the value at full resolution, of the load those of its peak. *Effort* is bodies times linear
iterations, full over adaptive, which does not depend on the machine; *ratio* is that of processor times, measured while
other processes ran.
"""

VARIED = """\
Each variation against the default in the same specimens and seeds. *Load* and *energy*: median and worst, per cent of
full resolution. *Right*: runs within the limits of their specimen. *Bodies*: at the end, over those of the default.
*Effort*: of the default over that of the variation; above 1 it is cheaper.
"""


def more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--study", type=Path, default=ROOT / "benchmarks" / "study.toml", metavar="FILE")
    parser.add_argument("--folder", type=Path, default=ROOT / "results" / "study", metavar="DIR")
    parser.add_argument("--images", type=Path, default=ROOT / "docs" / "images", metavar="DIR")
    parser.add_argument("--workers", type=int, default=2, metavar="N", help="processes: %(default)s")
    parser.add_argument("--report", action="store_true", help="run nothing, only compare what is there")


def produce(found: argparse.Namespace) -> Report:
    def told(task: object, record: Any, left: int) -> None:
        say(f"{task}: {record.status}; {left} left")

    result = run_study(load_study(found.study), found.folder, workers=found.workers, run=not found.report, on_done=told)
    write_result(result, found.folder)
    for name in PICTURES:
        picture = found.folder / f"{name}.png"
        if picture.exists():
            shutil.copyfile(picture, found.images / f"adaptivity_{name}.png")
    return Report("adaptivity", [m.row() for m in result.found], _markdown(result), _checks(result))


def _markdown(result: StudyResult) -> str:
    default = summary_rows(result, result.of(variation="default"))
    shown = [(key, head) for key, (head, _) in COLUMNS.items() if key not in ("stiffness", "crack", "cpu")]
    parts = [
        "## Numbers",
        TEXT.format(runs=len(result.found), full=sum(count for count, _ in result.full.values())),
        "### Defaults\n",
        table(
            ["specimen", *(h for _, h in shown)], [[row["specimen"], *(row[k] for k, _ in shown)] for row in default]
        ),
        "\n### One parameter at a time\n",
        VARIED,
        table(["variation", "runs", "right", "load [%]", "energy [%]", "bodies", "effort"], _varied(result)),
        "\n### Tolerances\n",
        table(["tolerance [%]", "runs", "kept by", "load, 95 % [%]", "load, worst [%]"], _tolerances(result)),
        "\n### Indicators of the error\n",
        table(
            ["indicator", "rank correlation", "of logarithms", "covering", "exaggerates"],
            [
                [c.name.replace("_", " "), f"{c.rank:.2f}", f"{c.linear:.2f}", f"{c.covering:.2g}", f"{c.excess:.1f}"]
                for c in correlations(m for m in result.found if m.finished)
            ],
        ),
        f"\n`load_error_bound` holds in {_bounded(result):.0%} of the {len(_finished(result))} runs.",
        "\n### Places of cracks\n",
        table(
            ["specimen", "variation", "seeds", "same crack", "largest shift [mm]", "p"],
            [
                [
                    place.specimen,
                    place.variation,
                    f"{len(place.full)}",
                    f"{int(place.same.sum())}",
                    f"{1e3 * np.abs(place.adaptive - place.full).max():.1f}",
                    f"{place.probability:.2f}",
                ]
                for place in localisation(result.found)
                if place.specimen in result.free and place.variation == "default"
            ],
        ),
        "\n### Runs beyond their limits, at the defaults\n",
        _beyond(result),
    ]
    return "\n".join(parts)


def _finished(result: StudyResult) -> list[Measures]:
    return [m for m in result.found if m.compared and m.finished]


def _varied(result: StudyResult) -> list[list[str]]:
    base = {(m.specimen, m.seed): m for m in result.of(variation="default") if m.compared}
    rows = []
    for variation in result.study.variations:
        runs = result.of(variation=variation.name)
        pairs = [(m, base[m.specimen, m.seed]) for m in runs if m.compared and (m.specimen, m.seed) in base]
        if not pairs:
            continue
        right = sum(m.compared and not fails(m, result.specimen(m.specimen).limits) for m in runs)
        rows.append(
            [
                variation.name,
                f"{len(runs)}",
                f"{right}",
                _pair([100 * m.load for m, _ in pairs]),
                _pair([100 * abs(m.energy) for m, _ in pairs]),
                f"{median(m.bodies_end / d.bodies_end for m, d in pairs):.2f}",
                f"{median(m.effort_ratio / d.effort_ratio for m, d in pairs):.2f}",
            ]
        )
    return rows


def _pair(values: Sequence[float]) -> str:
    return f"{median(values):.2f} ({max(values):.2f})"


def _kept(result: StudyResult, name: str, tolerance: float) -> tuple[int, list[float]]:
    """Runs that keep a tolerance, and the errors of all."""
    errors = [m.load for m in result.of(variation=name) if m.compared]
    return sum(error <= tolerance for error in errors), errors


def _tolerances(result: StudyResult) -> list[list[str]]:
    rows = []
    for name, tolerance in TOLERANCES.items():
        kept, errors = _kept(result, name, tolerance)
        if errors:
            quantile = float(np.quantile(errors, WANTED, method="higher"))
            rows.append(
                [
                    f"{100 * tolerance:g}",
                    f"{len(errors)}",
                    f"{kept} ({kept / len(errors):.0%})",
                    f"{100 * quantile:.2f}",
                    f"{100 * max(errors):.2f}",
                ]
            )
    return rows


def _bounded(result: StudyResult) -> float:
    """Share of all runs whose error is below the bound that they report."""
    return float(np.mean([m.load <= m.bound for m in _finished(result)]))


def _beyond(result: StudyResult) -> str:
    rows = []
    for m in result.of(variation="default"):
        missed = fails(m, result.specimen(m.specimen).limits) if m.compared else [m.end]
        if missed:
            rows.append([m.specimen, f"{m.seed}", ", ".join(missed), f"{100 * m.overlap:.0f}", m.message or "-"])
    if not rows:
        return "None."
    return table(["specimen", "seed", "misses", "overlap [%]", "message"], rows)


def _checks(result: StudyResult) -> list[Check]:
    checks = []
    for entry in result.study.specimens:
        runs = [m for m in result.of([entry.name], "default") if m.compared]
        for key in ("load", "peak", "energy"):
            worst = max((abs(getattr(m, key)) for m in runs), default=float("nan"))
            checks.append(Check(f"{entry.name}, {key} [%]", 100 * worst, 100 * getattr(entry.limits, key)))
    for name, tolerance in TOLERANCES.items():
        kept, errors = _kept(result, name, tolerance)
        if errors:
            share = 100 * kept / len(errors)
            checks.append(
                Check(f"within a tolerance of {100 * tolerance:g} % [% of runs]", share, 100 * WANTED, at_least=True)
            )
    checks.append(Check("within their bound [% of runs]", 100 * _bounded(result), 100 * WANTED, at_least=True))
    return checks


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, [], [], more=more)))
