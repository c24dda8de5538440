"""Equations that are added to equilibrium."""

from itertools import pairwise

import numpy as np
import pytest

from equilibrium.models import beam_system
from fissura.contact import contact_strains
from fissura.equilibrium import StepSolver, dissipation, settle
from fissura.equilibrium.constraint import Constraint, dissipating, holding, prescribed


@pytest.fixture(scope="module")
def system():
    return beam_system()


@pytest.fixture(scope="module")
def states(system):
    """Two equilibria, one after the other, in softening."""
    solver = StepSolver(1e-10, 100)
    start = settle(system, system.virgin(), 1e-5)
    history, guess, found = system.virgin(), (start.response.u, start.load), []
    for value in (1e-5, 1.2e-5, 1.4e-5):
        state = solver.solve(system, history, prescribed(system, value), guess, 0.0)
        assert state is not None
        history, guess = state.response.history, (state.response.u, state.load)
        found.append(state)
    return found


def test_gap_and_tolerance():
    constraint = Constraint(np.array([1.0, 2.0]), 3.0, 10.0, 1e-2, 10.0)
    assert constraint.gap(np.array([1.0, 1.0]), 2.0) == pytest.approx(1.0)
    assert not constraint.met(np.array([1.0, 1.0]), 2.0)
    assert constraint.met(np.array([1.0, 1.0]), 2.33)


def test_energy_of_the_constraint_is_what_contacts_dissipate(system, states):
    """All unloading goes to the origin, so that load and displacement of both ends are enough."""
    for a, b in pairwise(states):
        spent = dissipation(system, a.response, b.response)[0].sum()
        constraint = dissipating(system, a.response, a.load, spent)
        assert spent > 0
        assert constraint.gap(b.response.u, b.load) == pytest.approx(0.0, abs=1e-7 * spent)
        # Elastic unloading dissipates nothing.
        assert constraint.gap(0.4 * a.response.u, 0.4 * a.load) == pytest.approx(spent, rel=1e-12)


def test_a_step_dissipates_what_is_asked_for(system, states):
    before, now = states[-2:]
    spent = dissipation(system, before.response, now.response)[0].sum()
    for share in (0.1, 0.5, 1.0):
        ratio = 0.9 * share
        guess = (
            now.response.u + ratio * (now.response.u - before.response.u),
            now.load + ratio * (now.load - before.load),
        )
        constraint = dissipating(system, now.response, now.load, share * spent)
        found = StepSolver(1e-8, 30).solve(system, now.response.history, constraint, guess, 0.0)
        assert found is not None
        assert found.residual <= 1e-8
        assert found.value == pytest.approx(system.control @ found.response.u, rel=1e-12)
        assert dissipation(system, now.response, found.response)[0].sum() == pytest.approx(share * spent, rel=2e-3)


def test_holding_weighs_contacts_by_their_growth(system, states):
    a, b = states[-2:]
    constraint = holding(system, a.response, b.response)
    growth = np.maximum(b.response.history[:, 0] - a.response.history[:, 0], 0.0)
    assert growth.max() > 0
    assert constraint.load_factor == 0.0
    assert constraint.met(b.response.u, b.load)
    u = np.random.default_rng(1).normal(size=system.size) * 1e-6
    strain = contact_strains(system.geometry, u.reshape(-1, 6))[system.damageable]
    work = np.einsum("ca,ca->c", b.response.traction[system.damageable], strain)
    assert constraint.vector @ u == pytest.approx((system.geometry.volume[system.damageable] * growth * work).sum())
    assert holding(system, b.response, a.response) is None or (growth < 0).any()
    assert holding(system, b.response, b.response) is None
