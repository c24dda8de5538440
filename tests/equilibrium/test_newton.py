"""Solution of steps; a bar of two bodies with one contact follows the contact law exactly."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest

from equilibrium.models import BEAM, CONCRETE, beam, beam_system, changed, elastic_contacts, half_fine, secant_entries
from fissura.case import case_from_dict
from fissura.contact import CusatisCedolin
from fissura.equilibrium import StepSolver, System, settle
from fissura.equilibrium.constraint import Constraint, prescribed
from fissura.equilibrium.corrections import StepEquations
from fissura.equilibrium.newton import _Search
from fissura.linear import SingularMatrixError
from fissura.specimen import conditions_from_case, domain_from_case
from fissura.tessellation.discretize import tessellate

YIELD = CONCRETE.f_t / CONCRETE.E
LENGTH, SIDE = 0.02, 0.03


@pytest.fixture(scope="module")
def bar(tmp_path_factory):
    """Two bodies in a row, clamped on the left, pulled on the right; the gauge is the elongation."""
    case = case_from_dict(
        changed(
            BEAM,
            {
                "specimen": {"size": [2 * LENGTH, SIDE, SIDE]},
                "notch": None,
                "supports": [{"type": "clamp", "face": "left"}],
                "load": {"face": "right", "direction": [1, 0, 0], "at": None},
                "gauge": {"a": {"face": "left"}, "b": {"face": "right"}},
            },
        ),
        tmp_path_factory.mktemp("bar"),
    )
    case = case.model_copy(update={"load": case.load.model_copy(update={"at": None})})
    domain = domain_from_case(case)
    x = np.array([[0.5 * LENGTH, 0.5 * SIDE, 0.5 * SIDE], [1.5 * LENGTH, 0.5 * SIDE, 0.5 * SIDE]])
    tessellation = tessellate(x, domain.cell_of(x), domain.complex, domain.surfaces, np.full(2, LENGTH))
    assert len(tessellation.contacts) == 1
    return System(tessellation, CONCRETE, CusatisCedolin, conditions_from_case(case, domain))


def test_bar_follows_the_contact_law_into_softening_and_back(bar):
    solver = StepSolver(1e-10, 60)
    law = CusatisCedolin.create(CONCRETE, np.array([LENGTH]))
    history, own = bar.virgin(), law.initial_history()
    u, load = np.zeros(bar.size), 0.0
    area = SIDE * SIDE
    for strain in np.array([0.5, 0.9, 1.2, 2.0, 4.0, 8.0, 5.0, 1.0, 6.0, 12.0, 40.0]) * YIELD:
        state = solver.solve(bar, history, prescribed(bar, strain * LENGTH), (u, load), 0.1 * area * CONCRETE.f_t)
        assert state is not None
        u, load, history = state.response.u, state.load, state.response.history
        traction, own = law.response(np.array([[strain, 0.0, 0.0]]), own)
        assert load == pytest.approx(area * traction[0, 0], rel=1e-7)
        assert history[0, 0] == pytest.approx(own[0, 0], abs=1e-9)
        assert state.residual <= 1e-10


def test_bar_under_compression_hardens(bar):
    solver = StepSolver(1e-10, 60)
    value = -25 * YIELD * LENGTH
    state = solver.solve(bar, bar.virgin(), prescribed(bar, value), (np.zeros(bar.size), 0.0), CONCRETE.f_t * SIDE**2)
    law = CusatisCedolin.create(CONCRETE, np.array([LENGTH]))
    traction, _ = law.response(np.array([[-25 * YIELD, 0.0, 0.0]]), law.initial_history())
    assert state.load == pytest.approx(SIDE**2 * traction[0, 0], rel=1e-7)
    assert state.load < -16 * CONCRETE.f_t * SIDE**2


def test_two_bodies_in_series_with_elastic_ends(bar):
    """Bodies are rigid: the elastic stiffness is ``E A / L`` of the single contact."""
    state = settle(bar, bar.virgin(), 1e-7)
    assert state.load / 1e-7 == pytest.approx(CONCRETE.E * SIDE**2 / LENGTH, rel=1e-9)


@pytest.fixture(scope="module")
def system():
    return beam_system()


def test_settle_meets_the_value_in_equilibrium(system):
    state = settle(system, system.virgin(), 3e-6)
    assert system.control @ state.response.u == pytest.approx(3e-6, rel=1e-12)
    residual = state.load * system.load - system.internal(state.response.traction, state.response.u)
    assert np.linalg.norm(residual) < 1e-8 * abs(state.load) * np.linalg.norm(system.load)
    double = settle(system, system.virgin(), 6e-6)
    assert double.load == pytest.approx(2 * state.load, rel=1e-10)


def test_settle_keeps_the_damage_that_is_there(system):
    history = system.virgin()
    history[::3, 0] = 0.6
    soft, stiff = settle(system, history, 1e-5), settle(system, system.virgin(), 1e-5)
    assert soft.load < 0.95 * stiff.load
    np.testing.assert_array_equal(soft.response.history, history)
    expected = (1 - history[:, :1]) * system.moduli[system.damageable] * soft.response.strain[system.damageable]
    np.testing.assert_allclose(soft.response.traction[system.damageable], expected, rtol=1e-12)
    residual = soft.load * system.load - soft.response.forces
    assert np.linalg.norm(residual) < 1e-8 * abs(soft.load) * np.linalg.norm(system.load)


def test_reciprocity(system):
    """Maxwell-Betti: the gauge under the load moves as the load under the gauge."""
    system.symmetric.factor(secant_entries(system, system.virgin()))
    a, b = system.symmetric.solve(np.stack([system.load, system.control], axis=1)).T
    assert system.control @ a == pytest.approx(system.load @ b, rel=1e-8)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-9])
def test_a_step_ends_in_equilibrium_at_the_prescribed_value(system, tolerance):
    solver = StepSolver(tolerance, 60)
    start = settle(system, system.virgin(), 4e-6)
    state = solver.solve(system, system.virgin(), prescribed(system, 4e-6), (start.response.u, start.load), 0.0)
    assert state is not None
    assert state.response.history[:, 0].max() > 0.05
    assert state.value == 4e-6
    assert system.control @ state.response.u == pytest.approx(4e-6, rel=1e-9)
    again = system.response(state.response.u, system.virgin())
    residual = system.weights * (state.load * system.load - again.forces)
    size = np.linalg.norm(system.weights * system.load) * abs(state.load)
    assert np.linalg.norm(residual) <= tolerance * size * (1 + 1e-6)
    assert state.residual == pytest.approx(np.linalg.norm(residual) / size, rel=1e-6)
    assert state.energy <= tolerance


def test_elastic_step_is_the_linear_solution(system):
    start = settle(system, system.virgin(), 1e-7)
    wrong = (np.zeros(system.size), 0.0)
    state = StepSolver(1e-9, 10).solve(system, system.virgin(), prescribed(system, 1e-7), wrong, 0.0)
    assert state.load == pytest.approx(start.load, rel=1e-9)
    np.testing.assert_allclose(state.response.u, start.response.u, atol=1e-9 * np.abs(start.response.u).max())


def test_newton_and_secant_find_the_same_state(system, monkeypatch):
    start = settle(system, system.virgin(), 4e-6)
    guess = (start.response.u, start.load)
    newton = StepSolver(1e-9, 300).solve(system, system.virgin(), prescribed(system, 4e-6), guess, 0.0)
    monkeypatch.setattr(StepEquations, "newton", lambda self, trial, constraint: self.mixed(trial, constraint, 0.0))
    secant = StepSolver(1e-9, 300).solve(system, system.virgin(), prescribed(system, 4e-6), guess, 0.0)
    assert newton.iterations < secant.iterations
    assert newton.load == pytest.approx(secant.load, rel=1e-6)
    np.testing.assert_allclose(newton.response.history[:, 0], secant.response.history[:, 0], atol=1e-5)


def test_newton_converges_quadratically(system):
    """From 1e-4 to 1e-9 takes no more than two further iterations."""
    start = settle(system, system.virgin(), 4e-6)
    guess = (start.response.u, start.load)
    count = [
        StepSolver(t, 60).solve(system, system.virgin(), prescribed(system, 4e-6), guess, 0.0).iterations
        for t in (1e-4, 1e-9)
    ]
    assert count[1] <= count[0] + 2


def test_gives_up_after_the_allowed_iterations(system):
    start = settle(system, system.virgin(), 3e-5)
    guess = (start.response.u, start.load)
    assert StepSolver(1e-12, 2).solve(system, system.virgin(), prescribed(system, 3e-5), guess, 0.0) is None


def test_elastic_bodies_around_a_fine_zone():
    case = beam()
    system = beam_system(case, region=half_fine())
    assert len(elastic_contacts(system))
    start = settle(system, system.virgin(), 6e-6)
    state = StepSolver(1e-8, 60).solve(
        system, system.virgin(), prescribed(system, 6e-6), (start.response.u, start.load), 0.0
    )
    assert state is not None
    assert len(state.response.history) == len(system.damageable)
    elastic = (system.moduli * state.response.strain)[elastic_contacts(system)]
    np.testing.assert_allclose(state.response.traction[elastic_contacts(system)], elastic, rtol=1e-12)


def search_of(left):
    return _Search(StepEquations(None, None, None, 0.0, 1e-4), None, left)


@pytest.mark.parametrize("high", [0.01, 0.12, 5.0])  # 1.25, 15 and 600 times as large
def test_an_iteration_that_alternates_between_two_states_is_left(monkeypatch, high):
    """Whatever the ratio of both residuals: a contact at a kink of its law may be undone by every other correction."""
    sizes = itertools.cycle([high, 0.008])
    monkeypatch.setattr(StepEquations, "newton", lambda self, trial, constraint: SimpleNamespace(size=next(sizes)))
    monkeypatch.setattr(StepEquations, "converged", lambda self, trial, constraint: False)
    search = search_of(30)
    search._newton_phase(SimpleNamespace(size=0.008))
    assert search.left >= 26


def test_a_leap_that_is_made_up_for_at_once_is_gone_on_with(monkeypatch):
    sizes = iter([6.0, 0.45, 0.01, 1e-3, 1e-5])  # 0.45 is hardly below 0.5, but made up for the leap
    monkeypatch.setattr(StepEquations, "newton", lambda self, trial, constraint: SimpleNamespace(size=next(sizes)))
    monkeypatch.setattr(StepEquations, "converged", lambda self, trial, constraint: trial.size <= 1e-5)
    assert search_of(30)._newton_phase(SimpleNamespace(size=0.5)).size == 1e-5


@pytest.mark.parametrize("prescribed_gauge", [True, False])
def test_where_a_mixture_fails_the_next_one_has_less_of_the_tangent(system, monkeypatch, prescribed_gauge):
    """Down to the secant stiffness, which solves the step alone."""
    start = settle(system, system.virgin(), 4e-6)
    guess = (start.response.u, start.load)
    constraint = prescribed(system, 4e-6)
    if not prescribed_gauge:  # another equation that means the same: a mixture is for prescribed gauges only
        constraint = Constraint(system.control, 0.0, 4e-6, 1e-9, 4e-6)
    expected = StepSolver(1e-8, 300).solve(system, system.virgin(), prescribed(system, 4e-6), guess, 0.0)
    mixed, shares = StepEquations.mixed, []

    def fails(self, *args):
        raise SingularMatrixError("on purpose")

    def only_secant(self, trial, constraint, share):
        shares.append(share)
        return fails(self) if share > 0.0 else mixed(self, trial, constraint, share)

    monkeypatch.setattr(StepEquations, "newton", fails)
    monkeypatch.setattr(StepEquations, "mixed", only_secant)
    found = StepSolver(1e-8, 300).solve(system, system.virgin(), constraint, guess, 0.0)
    assert shares[:4] == ([0.9, 0.7, 0.5, 0.0] if prescribed_gauge else [0.0] * 4)
    assert set(shares[4:]) == {0.0}
    assert found.load == pytest.approx(expected.load, rel=1e-6)


def test_a_step_is_given_up_when_the_secant_stiffness_fails(system, monkeypatch):
    def fails(self, *args):
        raise SingularMatrixError("on purpose")

    tried = []
    monkeypatch.setattr(StepEquations, "newton", lambda *args: tried.append(1) or fails(*args))
    monkeypatch.setattr(StepEquations, "mixed", fails)
    guess = (np.zeros(system.size), 0.0)
    solver = StepSolver(1e-8, 300)
    assert solver.solve(system, system.virgin(), prescribed(system, 4e-6), guess, 0.0) is None
    assert len(tried) == 1
