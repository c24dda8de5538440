"""Reactions of supports against statics, their balance with the load, and energy at the places of both."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fissura.case import case_from_dict
from fissura.equilibrium.attach import owners_of
from fissura.simulation.loop import Simulation
from fissura.specimen import conditions_from_case, domain_from_case

from .models import BEAM, beam, beam_system, changed


def first(case, *, full=True):
    """The first step, which is elastic."""
    return next(Simulation(case, full=full).steps())


ELASTIC = {"target": 1e-6}


@pytest.mark.parametrize("linear", ["direct", "two-level"])
@pytest.mark.parametrize("full", [True, False])
def test_a_beam_shares_its_load_like_a_lever(linear, full):
    """Supports at 10 and 90 mm, load at 30 mm: a quarter and three quarters; moments only what holds the pin."""
    step = first(beam(load={"at": 0.03}, control=ELASTIC, solver={"linear": linear}), full=full)
    expected = np.zeros((2, 3))
    expected[:, 1] = [0.75 * step.load, 0.25 * step.load]
    assert_allclose(step.reactions[:, :3], expected, atol=1e-9 * step.load)
    assert_allclose(step.reactions[:, 3:], 0.0, atol=1e-9 * step.load * 0.1)
    assert np.linalg.norm(step.rest[:3]) < 1e-9 * step.load
    assert np.linalg.norm(step.rest[3:]) < 1e-9 * step.load * 0.1


@pytest.mark.parametrize("direction", [[1, 0, 0], [0, -1, 0], [0, 0, 1], [1, -2, 3]])
def test_a_clamp_takes_force_and_moment(direction):
    """A cantilever: force against the load, moment of the load about the middle of the clamped face."""
    size = np.array([0.06, 0.03, 0.03])
    data = changed(BEAM, {"specimen": {"size": size.tolist()}, "notch": None, "gauge": None})
    data["supports"] = [{"type": "clamp", "face": "left"}]
    data["load"] = {"face": "right", "direction": direction, "at": 0.015}
    data["control"] = {"type": "displacement", "target": 1e-6}
    step = first(case_from_dict(data))
    force = step.load * np.array(direction) / np.linalg.norm(direction)
    (reaction,) = step.reactions
    assert_allclose(reaction[:3], -force, atol=1e-9 * step.load)
    assert_allclose(reaction[3:], -np.cross([size[0], 0.0, 0.0], force), atol=1e-9 * step.load * 0.1)


def test_whole_faces_and_strips_are_in_balance_too():
    data = changed(BEAM, {"specimen": {"size": [0.03, 0.03, 0.03]}, "notch": None, "gauge": None})
    data["supports"] = [{"type": "clamp", "face": "bottom", "at": 0.015, "width": 0.01}]
    data["load"] = {"face": "top"}
    data["discretization"] = {"l_f": 0.006, "l_c": 0.006}
    data["control"] = {"type": "displacement", "target": 1e-7}
    step = first(case_from_dict(data))
    assert_allclose(step.reactions[0, :3], [0.0, step.load, 0.0], atol=1e-9 * step.load)
    assert np.linalg.norm(step.rest[3:]) < 1e-9 * step.load * 0.03


@pytest.fixture(scope="module")
def broken():
    """A beam that refines itself and cracks."""
    fine = {"discretization": {"l_f": 0.008, "l_c": 0.02}, "adaptivity": {"r_f": 0.016}}
    simulation = Simulation(beam(**fine, control={"target": 1e-4, "type": "gauge"}))
    return simulation, list(simulation.steps())


def test_a_cracked_beam_is_in_balance(broken):
    simulation, steps = broken
    assert any(s.refinements for s in steps)
    peak = max(s.load for s in steps)
    assert max(np.linalg.norm(s.rest[:3]) for s in steps) < simulation.case.control.tolerance * peak
    for s in steps:
        assert_allclose(s.reactions[:, 1], 0.5 * s.load, atol=simulation.case.control.tolerance * peak)


def test_energy_at_places_adds_up_over_refinements(broken):
    """Anew from the owners of the points, step by step."""
    simulation, steps = broken
    conditions = conditions_from_case(simulation.case, domain_from_case(simulation.case))
    ends = np.cumsum([0, *(held.functionals for held in conditions.held)])
    places = [list(conditions.loads), *(conditions.supports[a:b] for a, b in pairwise(ends))]
    total = np.zeros(4)
    for s in steps:
        t = s.snapshot.tessellation
        bodies = [owners_of(place, t) for place in places]
        touched = [np.isin(t.contacts.bodies, some).any(axis=1) for some in bodies]
        total += [s.spent[of].sum() for of in (*touched, np.any(touched, axis=0))]
        assert_allclose(s.dissipated_at, total, rtol=1e-9, atol=1e-15)
        assert s.dissipated_at[-1] <= s.dissipated + 1e-15
    assert total[0] > 1e-9  # the crack has come near to the load
    assert total[-1] < 0.2 * steps[-1].dissipated


def test_forces_of_supports_are_those_in_the_equations():
    system = beam_system()
    u = np.random.default_rng(1).normal(size=system.size)
    response = system.response(u, system.virgin())
    without = system.internal(response.traction, 0.0 * u)
    rows = np.zeros((len(system.supports.rows), system.size))
    rows[:, system.supports.dofs] = system.supports.rows
    spin = response.forces - without + rows.T @ system.supports.forces(response.u)
    # What is left of the difference is the trace of rotational stiffness, which leaves no resultant force.
    assert_allclose(spin.reshape(-1, 6)[:, :3], 0.0, atol=1e-9 * np.abs(response.forces).max())
