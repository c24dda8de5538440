"""A run goes on from any of its states as if it had never stopped: the same bits."""

import dataclasses
from functools import cache

import numpy as np
import pytest

import fissura
from conftest import small_beam
from fissura.simulation.advance import advance
from fissura.simulation.loop import Simulation
from remembered import REMEMBERED


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
    simulation = Simulation(small_beam(**REMEMBERED[name]), full=name == "full resolution")
    pairs = [(simulation.state, step) for step in simulation.steps()]
    return simulation, [state for state, _ in pairs], [step for _, step in pairs]


@pytest.mark.parametrize("name", REMEMBERED)
def test_every_state_is_followed_by_the_same_step(name):
    simulation, states, steps = undisturbed(name)
    model = simulation.model
    changes = [k for k, step in enumerate(steps[1:]) if step.refinements or step.coarsenings]
    for k in {2, *changes[:1], *changes[-1:], len(states) - 2}:
        _, step = advance(model, states[k])
        assert bits(step) == bits(steps[k + 1])


@pytest.mark.parametrize("name", REMEMBERED)
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
