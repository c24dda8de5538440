"""Designs of a calibration computed by ensembles: one for each round and test, in a folder of its own."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from fissura.arrays import FloatArray
from fissura.batch.machines import Machines
from fissura.calibration.observed import Observed, at_points
from fissura.calibration.problem import Problem, Test
from fissura.calibration.surrogate import Samples
from fissura.ensemble.plan import Plan
from fissura.ensemble.planning import planned
from fissura.ensemble.result import EnsembleResult
from fissura.ensemble.runner import OnOutcome, run_plan
from fissura.errors import InputError
from fissura.files.folder import Folder
from fissura.results.curve import COLUMN_OF, read_curve
from fissura.results.load_path import LoadPath
from fissura.results.summary import read_summary

OnRound = Callable[[int, list[dict[str, float]], int], None]


class Rounds:
    """Computes designs, round after round, and goes on with rounds that are there.

    Parameters
    ----------
    problem : Problem
    tests : sequence of Observed
        At whose points loads are asked for.
    folder : Path
        Where the rounds are kept.
    master : int
        Seed from which those of the realisations are spawned, the same in all rounds.
    full : bool
        Full resolution.
    machines : Machines
        Where runs are computed.
    on_round : callable, optional
        Called before each round with its number from 1, the designs as values by key, and the seeds of each.
    on_outcome : callable, optional
        Called with the summary of every run.
    """

    def __init__(
        self,
        problem: Problem,
        tests: Sequence[Observed],
        folder: Path,
        *,
        master: int,
        full: bool,
        machines: Machines,
        on_round: OnRound | None = None,
        on_outcome: OnOutcome | None = None,
    ) -> None:
        self._problem, self._tests, self._folder = problem, tests, folder
        self._master, self._full, self._machines = master, full, machines
        self._on_round, self._on_outcome = on_round, on_outcome
        self._number = 0

    def __call__(self, designs: FloatArray, seeds: int) -> tuple[FloatArray, list[Samples]]:
        """Designs that were run, shape (designs, m), and runs of every test.

        A round that was begun before is gone on with, at the very values it was begun with.
        """
        self._number += 1
        places = [self._place(test) for test in self._problem.tests]
        values = [self._problem.values(design) for design in designs]
        earlier = next((found for found in map(_values_of, places) if found is not None), None)
        values = values if earlier is None else earlier
        if self._on_round is not None:
            self._on_round(self._number, values, seeds)
        unknowns = self._problem.unknowns
        used = np.array([[unknown.coordinate(point[unknown.key]) for unknown in unknowns] for point in values])
        found = []
        for test, of, place in zip(self._problem.tests, self._tests, places, strict=True):
            result = self._run(test, place, values, seeds)
            found.append(_samples(result, test, of, used))
        return used, found

    def _place(self, test: Test) -> Path:
        name = f"round{self._number:02d}"
        return self._folder / name if len(self._problem.tests) == 1 else self._folder / name / test.name

    def _run(self, test: Test, place: Path, values: list[dict[str, float]], seeds: int) -> EnsembleResult:
        plan = self._plan(test, values, seeds)
        there = (place / "ensemble.json").is_file()
        Folder.kept(self._folder, "calibration").add(f"{place.relative_to(self._folder).as_posix()}/")
        return run_plan(plan, place, self._machines, resume=there, on_outcome=self._on_outcome, report=False)

    def _plan(self, test: Test, values: list[dict[str, float]], seeds: int) -> Plan:
        vary = {unknown.key: [point[unknown.key] for point in values] for unknown in self._problem.unknowns}
        return planned(
            test.case,
            seeds,
            vary=vary,
            combine="together",
            seed=self._master,
            full=self._full,
            companions="none",
        )


def _values_of(place: Path) -> list[dict[str, float]] | None:
    """Values by key of the points of a round that was begun before."""
    try:
        vary = read_summary(place / "ensemble.json")["plan"]["vary"]
        return [dict(zip(vary, point, strict=True)) for point in zip(*vary.values(), strict=True)]
    except (InputError, KeyError, TypeError, AttributeError):
        return None


def _samples(result: EnsembleResult, test: Test, of: Observed, designs: FloatArray) -> Samples:
    """Loads of all runs at the points of a test."""
    rows = result.runs
    loads = np.full((len(rows["number"]), len(of.x)), np.nan)
    for k, number in enumerate(rows["number"].tolist()):
        if rows["steps"][k] <= 0:
            continue
        curve = read_curve(result.place(number))
        if np.any(curve[COLUMN_OF[test.quantity]] > 0):
            loads[k] = at_points(LoadPath.of(curve, f"run {number:04d}", test.quantity), of.x)
    return Samples(designs[rows["point"]], rows["realisation"] - 1, loads)
