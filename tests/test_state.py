"""A run goes on from any of its states as if it had never stopped: the same bits."""

import dataclasses
from functools import cache

import numpy as np
import pytest

import fissura
from conftest import small_beam
from fissura.advance import advance
from fissura.simulation import Simulation

#: Cases of which each has something else that must be remembered.
CASES = {
    "refinement": {"adaptivity__r_f": 0.012},
    "full resolution": {},
    "coarsening": {
        "material__G_t": 4.0,
        "discretization__l_f": 0.006,
        "discretization__l_c": 0.02,
        "adaptivity__r_f": 0.05,
        "adaptivity__coarsen": True,
        "adaptivity__gamma_coarse": 0.7,
        "control__stop_load": 0.2,
    },
    "field": {"field": {"length": 0.03}, "adaptivity__r_f": 0.012},
    "energy": {"control__type": "dissipation", "control__stop_load": 0.3, "material__G_t": 8.0},
    "stages": {
        "control": None,
        "gravity": {"density": 2400.0},
        "loads": {"side": {"face": "right", "at": 0.03, "along": "y"}},
        "stage": [
            {"load": "side", "control": "force", "to": 50.0},
            {"load": "load", "to": [2e-5, "10 % of load", 4e-5, "50 % of peak"]},
            {"load": "load", "to": 5e-5},
        ],
        "adaptivity__r_f": 0.012,
    },
    "platens": {
        "load": {"face": "top", "at": 0.06, "width": 0.01, "platen": {"contact": "frictionless", "turning": "hinged"}},
        "supports__0__width": 0.01,
        "supports__0__platen": "glued",
        "adaptivity__r_f": 0.012,
    },
    "two levels": {"adaptivity__r_f": 0.012, "solver__linear": "two-level"},
    "closing": {"material__law": "cusatis-cedolin-closing"},
}


def bits(step):
    """Everything of a step, but for its tessellation, as bytes."""
    values = {f.name: getattr(step, f.name) for f in dataclasses.fields(step)}
    shot = values.pop("snapshot")
    values |= {f.name: getattr(shot, f.name) for f in dataclasses.fields(shot) if f.name != "tessellation"}
    values |= {"x": shot.tessellation.x, "area": shot.tessellation.contacts.area}
    return {
        name: value if isinstance(value, str | dict) else np.asarray(value).tobytes() for name, value in values.items()
    }


@cache
def undisturbed(name):
    """A run: itself, and its states and steps."""
    simulation = Simulation(small_beam(**CASES[name]), full=name == "full resolution")
    pairs = [(simulation.state, step) for step in simulation.steps()]
    return simulation, [state for state, _ in pairs], [step for _, step in pairs]


@pytest.mark.parametrize("name", CASES)
def test_every_state_is_followed_by_the_same_step(name):
    simulation, states, steps = undisturbed(name)
    model = simulation.model
    changes = [k for k, step in enumerate(steps[1:]) if step.refinements or step.coarsenings]
    for k in {2, *changes[:1], *changes[-1:], len(states) - 2}:
        _, step = advance(model, states[k])
        assert bits(step) == bits(steps[k + 1])


@pytest.mark.parametrize("name", CASES)
def test_another_simulation_goes_on_from_a_state(name):
    simulation, states, steps = undisturbed(name)
    other = Simulation(simulation.case, full=simulation.full)
    k = max([len(steps) // 2, *(k for k, step in enumerate(steps[:-5]) if step.control == "dissipation")])
    other.state = states[k]
    found = list(other.steps())
    assert [bits(step) for step in found] == [bits(step) for step in steps[k + 1 :]]
    assert other.notices == simulation.notices


def test_observers_see_every_state_and_its_step():
    seen = []
    case = small_beam(control__stop_load=0.99)
    result = fissura.run(case, observers=[lambda state, step: seen.append((state, step))])
    assert [step.number for _, step in seen] == result.curve["step"].tolist()
    for state, step in seen:
        assert (state.number, state.totals.dissipated) == (step.number, step.dissipated)
        np.testing.assert_array_equal(state.now.response.u.reshape(-1, 6), step.snapshot.displacement)
