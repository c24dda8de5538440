"""Experiments on small beams: curves with known constants and seeds of their own, and what the search finds from them.

They call the search as `fissura calibrate` does, but compute their runs in one process.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fissura import run
from fissura.calibration.observed import Observed, at_points, observed
from fissura.calibration.problem import Problem, Test, Unknown
from fissura.calibration.search import STEP, search
from fissura.calibration.surrogate import Samples
from fissura.case import Case, case_from_dict
from fissura.ensemble.outcome import compute
from fissura.ensemble.planning import planned
from fissura.results.load_path import LoadPath
from fissura.results.measured import MeasuredBand

F_T, G_T = "material.f_t", "material.G_t"
TRUE = {F_T: 2.8e6, G_T: 50.0}
INITIAL, TAIL = (f"material.cusatis-cedolin-two-energies.{name}" for name in ("initial", "tail"))
TWO = {INITIAL: 0.2, TAIL: 0.35}
BOUNDS = {INITIAL: (0.05, 0.5), TAIL: (0.03, 0.9)}
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
    """One experiment on small beams: of which set, its number, measured specimens, seeds of a round, runs of a test."""

    of: str
    number: int
    specimens: int
    seeds: int
    most: int


def experiment(task: Experiment) -> dict[str, Any]:
    """The search on curves of small beams that were computed with known constants."""
    cases, true, starts = SETS[task.of](task.number)
    unknowns = tuple(Unknown(key, start, *BOUNDS.get(key, (start / 4, start * 4))) for key, start in starts.items())
    found_tests = []
    for k, case in enumerate(cases):
        real = case.with_(true)
        measured = _curves(real, planned(real, task.specimens, seed=10_000 * (k + 1) + task.number))
        bands = tuple(MeasuredBand(path.value, path.load, path.load) for path in measured)
        found_tests.append(Test(case.name, case, bands, 1.0, task.specimens, "gauge"))
    problem = Problem("small", unknowns, tuple(found_tests))
    tests = [observed(test) for test in problem.tests]

    def simulate(designs: NDArray[np.float64], seeds: int) -> tuple[NDArray[np.float64], list[Samples]]:
        return designs, [
            _samples(problem, of, case, designs, seeds, task.number) for of, case in zip(tests, cases, strict=True)
        ]

    found = search(problem, tests, simulate, task.seeds, task.most * len(tests))
    sure = found.uncertainty
    out = {}
    for k, unknown in enumerate(unknowns):
        at, error = float(found.coordinates[k]), float(sure.errors[k])
        ends = [float(np.exp(at + sign * sure.factor * error)) for sign in (-1, 1)]
        out[unknown.key] = (float(np.exp(at)), float(np.exp(at)) * error, *ends)
    return row_of(f"{task.number}", out) | {
        "runs": found.runs,
        "converged": found.converged,
        "move": found.move,
        "correlation": sure.correlation.tolist(),
    }


def _small(number: int) -> tuple[tuple[Case, ...], dict[str, float], dict[str, float]]:
    """A small notched beam, its true constants, and where the search starts."""
    start = ((2.2e6, 35.0), (3.6e6, 70.0))[number % 2]
    return (case_from_dict(SMALL),), TRUE, dict(zip((F_T, G_T), start, strict=True))


def _energies(number: int) -> tuple[tuple[Case, ...], dict[str, float], dict[str, float]]:
    """A small beam with and without its notch, by the law with two energies."""
    material = SMALL["material"] | {"law": "cusatis-cedolin-two-energies"}
    notched = {**SMALL, "name": "notched", "material": material}
    gauge = {"a": {"face": "bottom", "at": "30 mm"}, "b": {"face": "bottom", "at": "70 mm"}}
    unnotched = {**notched, "name": "unnotched", "gauge": gauge}
    del unnotched["notch"]
    start = ((2.2e6, 35.0, 0.3, 0.25), (3.6e6, 70.0, 0.15, 0.45))[number % 2]
    starts = dict(zip((F_T, G_T, INITIAL, TAIL), start, strict=True))
    return (case_from_dict(notched), case_from_dict(unnotched)), TRUE | TWO, starts


SETS = {"small": _small, "energies": _energies}


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


def structures(specimens: int, groups: int) -> dict[str, Any]:
    """How far f_t and G_t of single random structures are apart, without any search.

    Curves with the true constants are turned into shifts of logarithms by the pseudo-inverse of the derivative of the
    mean curve: for the measured specimens of the first experiments, and for the seeds that they compute, 6 of each.
    """
    case = case_from_dict(SMALL).with_(TRUE)
    real = [_seed(case, 10_000 + number, 1)[0] for number in range(1, specimens + 1)]
    computed = [seed for number in range(1, groups + 1) for seed in _seed(case, number, 6)]
    first = _loads(case, real[0])
    test = Test("small", case, (MeasuredBand(first.value, first.load, first.load),), 1.0, 1, "gauge")
    x = observed(test).x
    loads = np.array([at_points(_loads(case, seed), x) for seed in [*real, *computed]])
    columns = []
    for key in (F_T, G_T):
        ends = [case.with_({key: TRUE[key] * np.exp(sign * STEP)}) for sign in (1, -1)]
        up, down = (np.mean([at_points(_loads(end, seed), x) for seed in real[:20]], axis=0) for end in ends)
        columns.append((up - down) / (2.0 * STEP))
    shifts = loads @ np.linalg.pinv(np.stack(columns, axis=1)).T
    parts = {
        f"measured specimens 1 to {specimens // 2}": shifts[: specimens // 2],
        f"measured specimens {specimens // 2 + 1} to {specimens}": shifts[specimens // 2 : specimens],
        f"computed seeds of experiments 1 to {groups}": shifts[specimens:],
        "all": shifts,
    }
    return {
        name: {"count": len(of), "f_t": float(of[:, 0].std(ddof=1)), "G_t": float(of[:, 1].std(ddof=1))}
        for name, of in parts.items()
    }


def _seed(case: Case, master: int, count: int) -> list[int]:
    return [task.case.seed for task in planned(case, count, seed=master).tasks() if task.kind == "run"]


def _loads(case: Case, seed: int) -> LoadPath:
    return LoadPath.of(run(case.with_({"seed": seed})).curve, "run", "gauge")


def row_of(name: str, found: dict[str, tuple[float, float, float, float]]) -> dict[str, Any]:
    row: dict[str, Any] = {"name": name}
    for key, (value, error, low, high) in found.items():
        short = key.rpartition(".")[2]
        row |= {short: value, f"{short}_error": error}
        row[f"{short}_inside"] = bool(low <= (TRUE | TWO)[key] <= high)
    return row
