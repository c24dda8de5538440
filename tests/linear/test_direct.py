import numpy as np
import pytest

from equilibrium.models import beam_system, half_fine, secant_entries, tangent_entries
from fissura.linear import SingularMatrixError
from fissura.linear.direct import SOLVERS, best_solver

NAMES = sorted(SOLVERS)


@pytest.fixture(scope="module")
def system():
    return beam_system(region=half_fine())


@pytest.fixture(scope="module")
def stiffness(system):
    return secant_entries(system, system.virgin())


@pytest.fixture(scope="module")
def unsymmetric(system):
    rng = np.random.default_rng(0)
    u = rng.normal(size=system.size) * np.tile(np.repeat([2e-6, 2e-4], 3), len(system.tessellation))
    response = system.response(u, system.virgin())
    assert response.history[:, 0].max() > 0
    return tangent_entries(system, response, system.virgin())


def solved(name, system, data, right, *, symmetric):
    solver = SOLVERS[name](system.pattern)
    solver.factor(data, symmetric=symmetric)
    return solver.solve(right)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("symmetric", [True, False])
def test_solves_the_equations(name, symmetric, system, stiffness, unsymmetric):
    data = stiffness if symmetric else unsymmetric
    right = np.stack([system.load, system.control], axis=1)
    solution = solved(name, system, data, right, symmetric=symmetric)
    back = system.pattern.matrix(data) @ solution
    np.testing.assert_allclose(back, right, atol=1e-6 * np.abs(right).max())
    one = solved(name, system, data, system.load, symmetric=symmetric)
    np.testing.assert_allclose(one, solution[:, 0], rtol=1e-9, atol=1e-12 * np.abs(one).max())


@pytest.mark.skipif("pardiso" not in SOLVERS, reason="PARDISO is not installed")
@pytest.mark.parametrize("symmetric", [True, False])
def test_both_solvers_agree(symmetric, system, stiffness, unsymmetric):
    data = stiffness if symmetric else unsymmetric
    a, b = (solved(name, system, data, system.load, symmetric=symmetric) for name in NAMES)
    np.testing.assert_allclose(a, b, atol=1e-8 * np.abs(a).max())


@pytest.mark.parametrize("name", NAMES)
def test_a_solver_can_be_used_again_and_counts(name, system, stiffness, unsymmetric):
    solver = SOLVERS[name](system.pattern)
    solver.factor(stiffness, symmetric=True)
    first = solver.solve(system.load)
    solver.factor(unsymmetric, symmetric=False)
    solver.solve(system.load)
    solver.factor(2.0 * stiffness, symmetric=True)
    np.testing.assert_allclose(solver.solve(system.load), 0.5 * first, rtol=1e-7, atol=1e-10 * np.abs(first).max())
    assert solver.factorizations == 3


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_values_that_are_not_finite(name, value, system, stiffness):
    data = stiffness.copy()
    data[17] = value
    with pytest.raises(SingularMatrixError, match="finite"):
        SOLVERS[name](system.pattern).factor(data, symmetric=True)


@pytest.mark.parametrize("name", NAMES)
def test_singular_matrix(name, system, stiffness):
    """A body without any stiffness; afterwards the solver still works."""
    data, form = stiffness.copy(), system.pattern
    row = np.repeat(np.arange(form.size), np.diff(form.indptr))
    data[(row // 6 == 20) | (form.indices // 6 == 20)] = 0.0
    solver = SOLVERS[name](form)
    solver.factor(stiffness, symmetric=True)
    first = solver.solve(system.load)
    with pytest.raises(SingularMatrixError):
        solver.factor(data, symmetric=True)
    solver.factor(stiffness, symmetric=True)
    np.testing.assert_allclose(solver.solve(system.load), first, atol=1e-10 * np.abs(first).max())


@pytest.mark.skipif("pardiso" not in SOLVERS, reason="PARDISO is not installed")
def test_pardiso_wants_a_positive_definite_matrix(system, stiffness):
    with pytest.raises(SingularMatrixError):
        SOLVERS["pardiso"](system.pattern).factor(-stiffness, symmetric=True)


def test_best_solver_is_the_first_choice():
    assert best_solver() is SOLVERS["pardiso" if "pardiso" in SOLVERS else "superlu"]
