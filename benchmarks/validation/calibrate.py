"""Known constants found again by fissura calibrate, and how often its 95 % intervals hold them: docs/calibrate.md.

First the half-notched beam of Grégoire et al.: curves of it are computed with known f_t and G_t and seeds of their own,
and the tool finds these constants from them. Then many experiments on small beams, each with other seeds for what is
"measured" and for what is computed: the share of the experiments in which an interval holds the true value is to be
95 %. An experiment of small beams calls the search as the command does, but computes its runs in one process.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import above  # noqa: F401
import numpy as np
from numpy.typing import NDArray

import fissura
from common import ROOT, Check, Report, main, options, say, table
from fissura.batch.processes import computed
from fissura.calibration.observed import Observed, at_points, observed
from fissura.calibration.problem import Problem, Test, Unknown
from fissura.calibration.search import search
from fissura.calibration.surrogate import Samples
from fissura.case import Case, case_from_dict
from fissura.ensemble.outcome import compute
from fissura.ensemble.planning import planned
from fissura.machine.threads import threads_each
from fissura.results.curve_writer import CurveWriter
from fissura.results.load_path import LoadPath
from fissura.results.measured import MeasuredBand

F_T, G_T = "material.f_t", "material.G_t"
TRUE = {F_T: 2.8e6, G_T: 50.0}
#: Seed of the "measured" specimens, far from those of what is computed.
MEASURED = 700

SMALL: dict[str, Any] = {
    "name": "small",
    "specimen": {"size": ["100 mm", "30 mm", "15 mm"]},
    "notch": {"face": "bottom", "position": "50 mm", "depth": "12 mm"},
    "supports": [
        {"type": "pin", "face": "bottom", "at": "12 mm"},
        {"type": "roller", "face": "bottom", "at": "88 mm"},
    ],
    "load": {"face": "top", "at": "50 mm"},
    "gauge": {"a": {"face": "bottom", "at": "46 mm"}, "b": {"face": "bottom", "at": "54 mm"}},
    "material": {"E": "58 GPa", "alpha": 0.29, "f_t": "2.2 MPa", "G_t": "35 J/m^2"},
    "discretization": {"l_f": "6 mm", "l_c": "12 mm"},
    "control": {"target": "0.1 mm", "max_step": "2 um"},
    "output": {"vtk": 0},
}


@dataclass(frozen=True)
class Experiment:
    """One experiment on small beams: its number, how many specimens are measured, seeds of a round, start."""

    number: int
    specimens: int
    seeds: int
    most: int
    start: tuple[float, float]


def known(specimens: int, keep: Path) -> dict[str, Any]:
    """The tool on curves of the half-notched beam that were computed with known constants."""
    say(f"the half-notched beam, {specimens} specimens")
    folder = keep / f"beam{specimens}"
    if (folder / "calibration.json").is_file():
        with suppress(fissura.InputError):  # it was begun only
            return _of_beam(fissura.Calibration.load(folder), specimens)
    case = fissura.load_case(ROOT / "examples" / "gregoire_d50_halfnotch.toml").with_({"output.measured": None})
    with tempfile.TemporaryDirectory() as place:
        files = []
        for k in range(specimens):
            curve = fissura.run(case.with_({**TRUE, "seed": MEASURED + k})).curve
            files.append(Path(place) / f"measured{k}.csv")
            writer = CurveWriter(files[-1], ["gauge_m", "load_N"])
            for gauge, load in zip(curve["gauge_m"], curve["load_N"], strict=True):
                writer.write({"gauge_m": gauge, "load_N": load})
            writer.close()
        resume = (folder / "calibration.json").is_file()
        found = fissura.calibrate(case, files, output=folder, resume=resume)
    return _of_beam(found, specimens)


def _of_beam(found: fissura.Calibration, specimens: int) -> dict[str, Any]:
    return _row(f"{specimens}", {key: (e.value, e.error, e.low, e.high) for key, e in found.estimates.items()}) | {
        "runs": found.runs,
        "converged": found.converged,
        "correlation": float(found.correlation[0, 1]),
    }


def experiment(task: Experiment) -> dict[str, Any]:
    """The search on curves of small beams that were computed with known constants."""
    case = case_from_dict(SMALL)
    start = dict(zip((F_T, G_T), task.start, strict=True))
    unknowns = tuple(Unknown(key, start[key], start[key] / 4, start[key] * 4) for key in (F_T, G_T))
    measured = _curves(case.with_(TRUE), planned(case.with_(TRUE), task.specimens, seed=10_000 + task.number))
    bands = tuple(MeasuredBand(path.value, path.load, path.load) for path in measured)
    problem = Problem("small", unknowns, (Test("small", case, bands, 1.0, task.specimens, "gauge"),))
    tests = [observed(test) for test in problem.tests]

    def simulate(designs: NDArray[np.float64], seeds: int) -> tuple[NDArray[np.float64], list[Samples]]:
        return designs, [_samples(problem, tests[0], case, designs, seeds, task.number)]

    found = search(problem, tests, simulate, task.seeds, task.most)
    sure = found.uncertainty
    out = {}
    for k, unknown in enumerate(unknowns):
        at, error = float(found.coordinates[k]), float(sure.errors[k])
        ends = [float(np.exp(at + sign * sure.factor * error)) for sign in (-1, 1)]
        out[unknown.key] = (float(np.exp(at)), float(np.exp(at)) * error, *ends)
    return _row(f"{task.number}", out) | {"runs": found.runs, "converged": found.converged}


def _curves(case: Case, plan: Any) -> list[LoadPath]:
    outcomes = [compute(task) for task in plan.tasks() if task.kind == "run"]
    return [LoadPath.of(of.curve, "measured", "gauge") for of in outcomes if of.curve is not None]


def _samples(
    problem: Problem, test: Observed, case: Case, designs: NDArray[np.float64], seeds: int, master: int
) -> Samples:
    values = [problem.values(design) for design in designs]
    vary = {unknown.key: [point[unknown.key] for point in values] for unknown in problem.unknowns}
    plan = planned(case, seeds, vary=vary, combine="together", seed=master)
    tasks = list(plan.tasks())
    loads = np.full((len(tasks), len(test.x)), np.nan)
    for k, task in enumerate(tasks):
        curve = compute(task).curve
        if curve is not None:
            loads[k] = at_points(LoadPath.of(curve, "run", "gauge"), test.x)
    return Samples(
        np.array([designs[task.point] for task in tasks]), np.array([task.realisation - 1 for task in tasks]), loads
    )


def _row(name: str, found: dict[str, tuple[float, float, float, float]]) -> dict[str, Any]:
    row: dict[str, Any] = {"name": name}
    for key, (value, error, low, high) in found.items():
        short = key.rpartition(".")[2]
        row |= {short: value, f"{short}_error": error}
        row[f"{short}_inside"] = bool(low <= TRUE[key] <= high)
    return row


def produce(found: argparse.Namespace) -> Report:
    """Run everything."""
    beams = [known(count, found.keep) for count in found.beams]
    tasks = [
        Experiment(number, specimens, 6, 40, ((2.2e6, 35.0), (3.6e6, 70.0))[number % 2])
        for specimens in found.specimens
        for number in range(1, found.experiments + 1)
    ]
    rows: dict[int, list[dict[str, Any]]] = {count: [] for count in found.specimens}
    left = []
    for task in tasks:
        path = _path(found.keep, task)
        if path.is_file():
            rows[task.specimens].append(json.loads(path.read_text()))
        else:
            left.append(task)
    with threads_each(1):
        for task, row in computed(experiment, left, found.workers):
            assert row is not None, "the process that computed an experiment died"
            rows[task.specimens].append(row)
            path = _path(found.keep, task)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(json.dumps(row))
            say(f"{task.specimens} specimens, experiment {task.number}: {row['runs']} runs")
    return Report(
        "validation_calibrate",
        [*beams, *(row | {"specimens": count} for count, of in rows.items() for row in of)],
        _markdown(beams, rows),
        _checks(beams, rows),
    )


def _path(keep: Path, task: Experiment) -> Path:
    return keep / f"small{task.specimens}" / f"{task.number:03d}.json"


def _markdown(beams: list[dict[str, Any]], rows: dict[int, list[dict[str, Any]]]) -> str:
    known_table = table(
        ("specimens", "f_t [MPa], true 2.8", "off by", "G_t [J/m²], true 50", "off by", "correlation", "runs"),
        [
            (
                row["name"],
                f"{row['f_t'] / 1e6:.3f} ± {row['f_t_error'] / 1e6:.3f}",
                f"{_off(row, 'f_t'):+.2f} errors",
                f"{row['G_t']:.1f} ± {row['G_t_error']:.1f}",
                f"{_off(row, 'G_t'):+.2f} errors",
                f"{row['correlation']:+.2f}",
                f"{row['runs']}",
            )
            for row in beams
        ],
    )
    coverage = table(
        ("specimens", "experiments", "f_t inside", "G_t inside", "f_t off [errors]", "G_t off [errors]", "f_t", "G_t",
         "runs, mean and most", "converged"),
        [
            (
                f"{count}",
                f"{len(of)}",
                *(f"{np.mean([row[f'{name}_inside'] for row in of]):.0%}" for name in ("f_t", "G_t")),
                *(_shown([_off(row, name) for row in of]) for name in ("f_t", "G_t")),
                *(_error(of, name) for name in ("f_t", "G_t")),
                f"{np.mean([row['runs'] for row in of]):.0f}, {max(row['runs'] for row in of)}",
                f"{np.mean([row['converged'] for row in of]):.0%}",
            )
            for count, of in rows.items()
            if of
        ],
    )  # fmt: skip
    return "\n\n".join(
        [
            "## Known constants found again",
            "The half-notched beam of Grégoire et al., its curves computed with f_t = 2.8 MPa and G_t = 50 J/m² and"
            " other seeds, started from the values of the example:",
            known_table,
            "Small beams (100 x 30 x 15 mm, l_f 6 mm), each experiment with seeds of its own for what is measured and"
            " what is computed, started 20 to 30 % below the true values and 30 to 40 % above, in turn. *Inside*: how"
            " often the 95 % interval holds the true value. *Off*: mean and standard deviation of the difference"
            " of logarithms in standard errors. The last columns are mean standard errors, and the scatter of the"
            " estimates themselves.",
            coverage,
        ]
    )


def _off(row: dict[str, Any], name: str) -> float:
    """Difference of the logarithms of found and true value in standard errors, in which intervals are symmetric."""
    return float(np.log(row[name] / TRUE[f"material.{name}"]) * row[name] / row[f"{name}_error"])


def _shown(values: list[float]) -> str:
    return f"{np.mean(values):+.2f} ± {np.std(values, ddof=1) if len(values) > 1 else 0.0:.2f}"


def _error(rows: list[dict[str, Any]], name: str) -> str:
    true = TRUE[f"material.{name}"]
    told = np.sqrt(np.mean([(row[f"{name}_error"] / true) ** 2 for row in rows]))
    seen = np.std([row[name] / true for row in rows], ddof=1) if len(rows) > 1 else 0.0
    return f"{told:.1%} told, {seen:.1%} seen"


def _checks(beams: list[dict[str, Any]], rows: dict[int, list[dict[str, Any]]]) -> list[Check]:
    checks = [
        Check(f"{row['name']} specimens, {name}: off in standard errors", abs(_off(row, name)), 2.6)
        for row in beams
        for name in ("f_t", "G_t")
    ]
    checks += [Check(f"{row['name']} specimens: runs", row["runs"], 40) for row in beams]
    for count, of in rows.items():
        for name in ("f_t", "G_t"):
            inside = float(np.mean([row[f"{name}_inside"] for row in of])) if of else 0.0
            checks.append(Check(f"{count} specimens, {name}: share inside", inside, 0.8, at_least=True))
    return checks


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--beams", nargs="*", type=int, default=[1, 3], metavar="N", help="measured half-notched beams")
    parser.add_argument("--specimens", nargs="*", type=int, default=[1, 3], metavar="N", help="measured small beams")
    parser.add_argument("--experiments", type=int, default=24, metavar="N", help="experiments of each")
    parser.add_argument("--workers", type=int, default=2, metavar="N", help="experiments side by side")
    keep = ROOT / "results" / "validation" / "calibrate"
    parser.add_argument("--keep", type=Path, default=keep, help="folder for what was computed, which is not done again")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["all"], [1], more=_more)))
