"""Calculations that fail in the middle of a run: what was computed before is kept."""

from functools import cache
from itertools import islice

import numpy as np
import pytest

import fissura
import fissura.simulation.advance
import fissura.simulation.discretization
from equilibrium.models import beam
from fissura.equilibrium import StepSolver
from fissura.errors import InputError, RunStopped
from fissura.linear import SingularMatrixError
from fissura.simulation.discretization import Discretization
from fissura.simulation.loop import Simulation

REFINING = {
    "discretization": {"l_f": 0.006, "l_c": 0.02},
    "adaptivity": {"r_f": 0.012},
    "control": {"target": 2e-5},
    "output": {"vtk": 0},
}

#: Errors, and what is said of each.
ERRORS = {
    "mechanism": (SingularMatrixError("zero pivot"), "zero pivot"),
    "limit of the law": (InputError("discretization.l_f", "too long"), r"discretization\.l_f: too long"),
    "linear algebra": (np.linalg.LinAlgError("no eigenvalues"), r"a calculation failed \(LinAlgError: no eigenvalues"),
    "division": (ZeroDivisionError("by zero"), r"a calculation failed \(ZeroDivisionError: by zero"),
    "overflow": (FloatingPointError("overflow"), r"a calculation failed \(FloatingPointError: overflow"),
    "memory": (MemoryError(), "out of memory"),
    "fault": (IndexError("index 9"), r"a fault of the program.*IndexError: index 9 in test_failures\.py, line \d+"),
}
every_error = pytest.mark.parametrize("name", ERRORS)


class Broken:
    """Raises an error from the given call on; calls before go to what it replaces."""

    def __init__(self, monkeypatch, owner, name, error, after=0):
        self.called, original = 0, getattr(owner, name)

        def replacement(*args, **more):
            self.called += 1
            if self.called > after:
                raise error
            return original(*args, **more)

        monkeypatch.setattr(owner, name, replacement)


def stopped(text):
    """Steps until a run stops, saying why, and what it raised."""
    kept = []
    with pytest.raises(RunStopped, match=text) as caught:
        kept.extend(Simulation(beam(**REFINING)).steps())  # takes one step after the other
    return kept, caught.value


@cache
def undisturbed():
    return list(Simulation(beam(**REFINING)).steps())


@every_error
def test_a_failing_solution_stops_the_run(name, monkeypatch):
    error, text = ERRORS[name]
    expected = [s.load for s in undisturbed()]
    Broken(monkeypatch, StepSolver, "solve", error, after=3)
    kept, stop = stopped(text)
    assert stop.__cause__ is error
    assert stop.step == len(kept) + 1 > 1
    assert stop.gauge == kept[-1].gauge
    assert [s.load for s in kept] == expected[: len(kept)]


@every_error
def test_a_failing_refinement_stops_the_run(name, monkeypatch):
    error, text = ERRORS[name]
    refined = next(s.number for s in undisturbed() if s.refinements)
    Broken(
        monkeypatch, fissura.simulation.discretization, "discretize", error, after=2
    )  # the start, and full resolution
    kept, stop = stopped(text)
    assert stop.step == refined
    assert len(kept) == refined - 1


def test_all_steps_before_a_failure_are_saved(tmp_path, monkeypatch):
    expected = [s.load for s in undisturbed()[:3]]
    Broken(monkeypatch, Discretization, "assess", np.linalg.LinAlgError("no eigenvalues"), after=3)
    with pytest.raises(RunStopped, match="no eigenvalues") as caught:
        fissura.run(beam(**REFINING), output=tmp_path)
    result = caught.value.result
    assert list(result.curve["load_N"]) == expected
    assert result.summary["status"] == "stopped"
    assert result.summary["message"] == str(caught.value)
    written = {path.name for path in tmp_path.iterdir()}
    assert {"curve.csv", "summary.json", "case.json", "state_last.npz", "section.npz", "curve.png"} <= written


@every_error
def test_a_failing_start_refuses_the_case_or_stops(name, monkeypatch):
    error, text = ERRORS[name]
    Broken(monkeypatch, fissura.simulation.discretization, "gauge_compliance", error)
    kind = InputError if isinstance(error, (InputError, SingularMatrixError)) else RunStopped
    with pytest.raises(kind, match=text):
        next(Simulation(beam(**REFINING)).steps())


def test_an_interruption_is_no_failure(monkeypatch):
    Broken(monkeypatch, StepSolver, "solve", KeyboardInterrupt(), after=2)
    with pytest.raises(KeyboardInterrupt):
        list(Simulation(beam(**REFINING)).steps())


#: Refined although nothing is near its strength.
EAGER = {**REFINING, "adaptivity": {"r_f": 0.012, "gamma": 0.15, "coarsen": True}, "control": {"target": 4e-6}}


@pytest.fixture
def giving_up(monkeypatch):
    """No fine body is needed any more, and every saving is worth a change."""
    monkeypatch.setattr("fissura.adaptivity.limits.FEWEST", 1)
    monkeypatch.setattr("fissura.adaptivity.limits.SAVING", 0.0)
    monkeypatch.setattr(
        fissura.simulation.discretization,
        "needed_bodies",
        lambda tessellation, *rest: np.zeros(len(tessellation), bool),
    )


@cache
def coarsened():
    """Steps until something is made coarse again, while `giving_up` is in force."""
    steps = []
    for step in Simulation(beam(**EAGER)).steps():
        steps.append(step)
        if step.coarsenings:
            return steps
    raise AssertionError


def fail_in_coarsening(where, error, monkeypatch):
    original = Discretization.coarsen

    def failing(self, *args):
        with monkeypatch.context() as inside:
            Broken(
                inside,
                fissura.simulation.discretization if where == "discretize" else fissura.simulation.advance,
                where,
                error,
            )
            return original(self, *args)

    monkeypatch.setattr(Discretization, "coarsen", failing)


@every_error
@pytest.mark.parametrize("where", ["discretize", "settle"])
def test_a_run_goes_on_where_coarsening_fails(name, where, giving_up, monkeypatch):
    """With the structure that it has; only a fault of the program stops it."""
    error, text = ERRORS[name]
    expected = coarsened()
    fail_in_coarsening(where, error, monkeypatch)
    simulation = Simulation(beam(**EAGER))
    steps = simulation.steps()
    found = list(islice(steps, len(expected) - 1))
    assert [s.load for s in found] == [s.load for s in expected[:-1]]
    assert not simulation.notices
    before = simulation.tessellation
    if name == "fault":
        with pytest.raises(RunStopped, match=text):
            next(steps)
        assert simulation.tessellation is before
        return
    following = next(steps)
    assert following.coarsenings == 0
    assert following.refinements == 0
    assert following.snapshot.tessellation is before
    (notice,) = simulation.notices
    assert notice.key == "adaptivity.coarsen"
    assert f"after step {found[-1].number} (" in notice.problem


def test_a_failing_coarsening_is_a_warning_of_the_summary(giving_up, monkeypatch):
    """And is tried once only."""
    fail_in_coarsening("discretize", InputError("discretization.l_f", "too long"), monkeypatch)
    result = fissura.run(beam(**{**EAGER, "control": {"target": 1.5e-6}}))
    assert result.summary["status"] == "finished"
    assert result.summary["coarsenings"] == 0
    (warning,) = (text for text in result.summary["warnings"] if "coarsen" in text)
    assert warning.startswith("adaptivity.coarsen: ")
    assert "discretization.l_f: too long" in warning


def test_nothing_is_made_coarse_after_the_last_step(giving_up, monkeypatch):
    called, original = [], Discretization.coarsen
    monkeypatch.setattr(Discretization, "coarsen", lambda self, *args: called.append(1) or original(self, *args))
    simulation = Simulation(beam(**{**EAGER, "control": {"target": 1e-6}}))
    steps = list(simulation.steps())
    assert len(called) == len(steps) - 1
    assert simulation.tessellation is steps[-1].snapshot.tessellation
