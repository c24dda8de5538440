import numpy as np
import pytest

from equilibrium.models import beam, beam_system
from fissura.equilibrium import SingularMatrixError, symmetric
from fissura.equilibrium.symmetric import SymmetricSolver


@pytest.fixture(scope="module")
def system():
    return beam_system(beam(discretization={"l_f": 0.006, "l_c": 0.012}))


@pytest.fixture
def make(system, monkeypatch):
    """Build a solver with the limit of its choice replaced."""

    def build(large):
        monkeypatch.setattr(symmetric, "_LARGE", large)
        system.solver.factorizations = 0
        return SymmetricSolver(system.pattern, system.tessellation.x, system.solver)

    return build


def solved(solver, system):
    solver.factor(system.secant(system.virgin()))
    return solver.solve(np.stack([system.load, system.control], axis=1))


def test_small_and_large_structures_get_the_same_solution(system, make):
    count = len(system.tessellation)
    direct = make(count + 1)
    expected = solved(direct, system)
    assert (direct.preparations, system.solver.factorizations) == (0, 1)
    iterative = make(count)
    found = solved(iterative, system)
    assert (iterative.preparations, system.solver.factorizations) == (1, 0)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("failing", ["factor", "solve"])
def test_direct_solver_takes_over_where_the_iterative_one_fails(system, make, monkeypatch, failing):
    expected = solved(make(10**9), system)

    def fail(*arguments, **options):
        raise SingularMatrixError("does not converge")

    solver = make(1)
    monkeypatch.setattr(solver._iterative, failing, fail)
    np.testing.assert_array_equal(solved(solver, system), expected)
    assert system.solver.factorizations == 1
    monkeypatch.undo()
    np.testing.assert_allclose(solved(solver, system), expected, rtol=0.0, atol=1e-6 * np.abs(expected).max())


def test_a_matrix_that_is_not_positive_definite_is_refused(system, make):
    for large in (1, 10**9):
        with pytest.raises(SingularMatrixError):
            refused(make(large), system)


def refused(solver, system):
    solver.factor(-system.secant(system.virgin()))
    solver.solve(system.load)
