"""Newton corrections by GMRES against direct solution of the same equations."""

import numpy as np
import pytest

from equilibrium.models import beam, beam_system, secant_entries, tangent_entries
from fissura.equilibrium import StepSolver, limits, settle
from fissura.equilibrium.constraint import Constraint, prescribed
from fissura.equilibrium.tangent import TangentSolver
from fissura.linear import SingularMatrixError
from fissura.linear.direct import best_solver

CASE = beam(discretization={"l_f": 0.006, "l_c": 0.012})
VALUE = 6e-6


@pytest.fixture
def system():
    return beam_system(CASE)


@pytest.fixture
def state(system):
    """Equilibrium with damage that grows."""
    start = settle(system, system.virgin(), VALUE)
    guess = (start.response.u, start.load)
    found = StepSolver(1e-8, 60).solve(system, system.virgin(), prescribed(system, VALUE), guess, 0.0)
    assert found.response.history[:, 0].max() > 0.2
    return found


def direct(system, state, residual, constraint, gap):
    """The same correction with the assembled tangent."""
    solver = best_solver()(system.pattern)
    solver.factor(tangent_entries(system, state.response, system.virgin()), symmetric=False)
    a, b = solver.solve(np.stack([system.load, residual], axis=1)).T
    more = (gap - constraint.vector @ b) / (constraint.vector @ a + constraint.load_factor)
    return b + more * a, more


def corrected(system, state, residual, constraint, gap, tolerance=1e-10):
    solver = TangentSolver(system)
    stiffness = system.law.tangent(state.response.strain[system.damageable], system.virgin())
    found = solver.solve(state.response, stiffness, state.load, residual, constraint, gap, tolerance)
    return *found, solver.iterations


def random_residual(system, state, seed=1):
    rng = np.random.default_rng(seed)
    return 1e-3 * state.load * rng.normal(size=system.size) / system.weights


CONSTRAINTS = {
    "gauge": lambda system, state: prescribed(system, VALUE),
    "load in the constraint": lambda system, state: Constraint(
        0.5 * state.load * system.load, -0.3 * float(system.load @ state.response.u), 1e-6, 1e-3, 1e-6
    ),
}


@pytest.mark.parametrize("linear", ["two-level", "direct", "amg"])
@pytest.mark.parametrize("kind", CONSTRAINTS)
@pytest.mark.parametrize("share", [0.0, 0.01])
def test_correction_is_that_of_direct_solution(linear, kind, share):
    system = beam_system(CASE, linear=linear)
    start = settle(system, system.virgin(), VALUE)
    solver = StepSolver(1e-8, 60)
    state = solver.solve(system, system.virgin(), prescribed(system, VALUE), (start.response.u, start.load), 0.0)
    constraint = CONSTRAINTS[kind](system, state)
    residual, gap = random_residual(system, state), share * constraint.value
    expected, more = direct(system, state, residual, constraint, gap)
    du, load, _ = corrected(system, state, residual, constraint, gap)
    np.testing.assert_allclose(du, expected, atol=1e-6 * np.abs(expected).max())
    assert load == pytest.approx(more, rel=1e-6, abs=1e-7 * state.load)


def test_a_gauge_is_met_exactly_however_rough_the_solution(system, state):
    constraint, gap = prescribed(system, VALUE), 1e-3 * VALUE
    du, *_ = corrected(system, state, random_residual(system, state), constraint, gap, 0.3)
    assert system.control @ du == pytest.approx(gap, rel=1e-9)


def test_a_fresh_preparation_needs_fewer_iterations_than_an_old_one(system, state):
    residual, constraint = random_residual(system, state), prescribed(system, VALUE)
    system.prepared.solve(system.virgin())
    *old, many = corrected(system, state, residual, constraint, 0.0)
    system.prepared.prepare(state.response, state.load)
    *new, few = corrected(system, state, residual, constraint, 0.0)
    assert few < many
    np.testing.assert_allclose(new[0], old[0], atol=1e-6 * np.abs(new[0]).max())


def test_an_elastic_structure_needs_one_iteration(system):
    start = settle(system, system.virgin(), 1e-8)
    residual, constraint = random_residual(system, start), prescribed(system, 1e-8)
    *_, iterations = corrected(system, start, residual, constraint, 0.0)
    assert iterations == 1


def test_damage_and_displacements_of_an_equilibrium_are_its_secant_solution(system, state):
    """So that preparation takes the displacements under the unit load from the state itself."""
    system.prepared.prepare(state.response, state.load)
    from_state = system.prepared.unit.copy()
    solved = system.prepared.solve(state.response.history)
    np.testing.assert_allclose(from_state, solved, atol=1e-6 * np.abs(solved).max())
    product = system.pattern.matrix(secant_entries(system, state.response.history)) @ from_state
    np.testing.assert_allclose(
        product, state.response.forces / state.load, atol=1e-9 * np.abs(system.load).max() + 1e-9
    )


def test_preparation_is_renewed_when_old_ones_have_cost_enough(system, state, monkeypatch):
    system.prepared.solve(system.virgin())
    solver, count = TangentSolver(system), system.prepared.count
    stiffness = system.law.tangent(state.response.strain[system.damageable], system.virgin())
    constraint, residual = prescribed(system, VALUE), random_residual(system, state)

    def solve(tolerance):
        return solver.solve(state.response, stiffness, state.load, residual, constraint, 0.0, tolerance)

    monkeypatch.setattr(limits, "PREPARATION", 3)
    solve(0.5)
    solve(1e-8)  # takes more than three iterations longer than the first one
    assert system.prepared.count == count
    solve(1e-8)
    assert system.prepared.count == count + 1


def test_a_scaled_system_does_not_take_the_preparation_of_the_other(system):
    first = settle(system, system.virgin(), 1e-7)
    softer = system.scaled(0.5)
    assert settle(softer, softer.virgin(), 1e-7).load == pytest.approx(first.load, rel=1e-9)  # all contacts are fine
    assert softer.prepared is not system.prepared


@pytest.fixture
def stale(system, state):
    """What is needed to solve with a preparation for the virgin structure, and the iterations that a fresh one takes.

    The returned function solves to a reduction of 1e-8.
    """
    stiffness = system.law.tangent(state.response.strain[system.damageable], system.virgin())
    constraint, residual = prescribed(system, VALUE), random_residual(system, state)

    def solve(solver):
        return solver.solve(state.response, stiffness, state.load, residual, constraint, 0.0, 1e-8)

    system.prepared.prepare(state.response, state.load)
    fresh = TangentSolver(system)
    expected = solve(fresh)
    system.prepared.solve(system.virgin())
    return solve, fresh.iterations, expected


def test_after_a_failure_the_preparation_is_renewed_at_once(system, stale, monkeypatch):
    """Also when the failure is the first solution with it, which cannot be compared with an earlier one."""
    solve, fresh, expected = stale
    solver, count = TangentSolver(system), system.prepared.count
    monkeypatch.setattr(limits, "MOST_ITERATIONS", fresh)
    monkeypatch.setattr(limits, "USELESS", 1e-7)  # what the stale preparation leaves after these iterations
    du, load = solve(solver)
    assert system.prepared.count == count + 1
    assert solver.iterations == 2 * fresh
    np.testing.assert_allclose(du, expected[0], atol=1e-6 * np.abs(expected[0]).max())
    assert load == pytest.approx(expected[1], rel=1e-6)


def test_a_failure_with_a_fresh_preparation_is_final(system, state, stale, monkeypatch):
    solve, *_ = stale
    system.prepared.prepare(state.response, state.load)
    count = system.prepared.count
    monkeypatch.setattr(limits, "USELESS", 1e-12)
    with pytest.raises(SingularMatrixError):
        solve(TangentSolver(system))
    assert system.prepared.count == count


def test_a_solution_that_was_given_up_is_no_measure_of_a_fresh_preparation(system, stale, monkeypatch):
    """Taken for one, it would let the stale preparation stay for good."""
    solve, fresh, expected = stale
    solver, count = TangentSolver(system), system.prepared.count
    monkeypatch.setattr(limits, "MOST_ITERATIONS", fresh)
    monkeypatch.setattr(limits, "PREPARATION", fresh - 1)
    solve(solver)  # of use, but less exact than was asked for
    assert system.prepared.count == count
    du, _ = solve(solver)
    assert system.prepared.count == count + 1
    np.testing.assert_allclose(du, expected[0], atol=1e-6 * np.abs(expected[0]).max())


def test_a_load_that_does_not_move_what_is_controlled_is_an_error_of_its_own(system, state):
    nothing = Constraint(np.zeros(system.size), 0.0, 0.0, 1e-9, 0.0, prescribed=True)
    with pytest.raises(SingularMatrixError, match="does not move"):
        corrected(system, state, random_residual(system, state), nothing, 0.0)
