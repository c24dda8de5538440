import tracemalloc

import numpy as np
import pytest

from equilibrium.models import beam, beam_system, secant_entries
from fissura.linear import SingularMatrixError, limits
from fissura.linear.symmetric import SymmetricSolver

NAMES = ["direct", "two-level", "amg"]


@pytest.fixture(scope="module")
def system():
    return beam_system(beam(discretization={"l_f": 0.006, "l_c": 0.012}))


@pytest.fixture
def make(system):
    return lambda linear: SymmetricSolver(system.pattern, system.tessellation.x, linear)


@pytest.fixture(scope="module")
def expected(system):
    return solved(SymmetricSolver(system.pattern, system.tessellation.x, "direct"), system)


def solved(solver, system):
    solver.factor(secant_entries(system, system.virgin()))
    return solver.solve(np.stack([system.load, system.control], axis=1))


@pytest.mark.parametrize("name", NAMES)
def test_all_solvers_find_the_same(system, make, expected, name):
    solver = make(name)
    np.testing.assert_allclose(solved(solver, system), expected, rtol=0.0, atol=1e-6 * np.abs(expected).max())
    assert (solver.factorizations, solver.matrices) == (1, 1)


@pytest.mark.parametrize("name", NAMES)
def test_application_comes_with_its_exact_product(system, make, name):
    solver = make(name)
    data = secant_entries(system, system.virgin())
    solver.factor(data)
    right = np.random.default_rng(1).normal(size=system.size)
    found, image = solver.apply_with_product(right)
    product = system.pattern.product(data, found)
    np.testing.assert_allclose(image, product, atol=1e-7 * np.abs(product).max())


@pytest.mark.parametrize("name", NAMES)
def test_what_was_released_is_prepared_again_with_the_same_bits(system, make, name):
    solver = make(name)
    before = solved(solver, system)
    solver.release()
    np.testing.assert_array_equal(solved(solver, system), before)


def test_release_gives_memory_back(system, make):
    solver = make("two-level")
    tracemalloc.start()
    solved(solver, system)
    used = tracemalloc.get_traced_memory()[0]
    solver.release()
    given = used - tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    lower = len(system.geometry) + len(
        system.tessellation
    )  # blocks of 36 numbers, and their factor in single precision
    assert given > 36 * (8 + 4) * lower


def test_auto_chooses_by_size(system, make, monkeypatch):
    count = len(system.tessellation)
    for large, name in ((count, "two-level"), (count + 1, "direct")):
        monkeypatch.setattr(limits, "LARGE", large)
        np.testing.assert_array_equal(solved(make("auto"), system), solved(make(name), system))


@pytest.mark.parametrize("failing", ["factor", "solve"])
def test_direct_solver_takes_over_where_the_iterative_one_fails(system, make, monkeypatch, expected, failing):
    def fail(*arguments, **options):
        raise SingularMatrixError("does not converge")

    solver = make("two-level")
    monkeypatch.setattr(solver._chosen, failing, fail)
    np.testing.assert_array_equal(solved(solver, system), expected)
    right = np.ones(system.size)
    assert solver.apply_with_product(right)[1] is right
    monkeypatch.undo()
    np.testing.assert_allclose(solved(solver, system), expected, rtol=0.0, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("name", NAMES)
def test_a_matrix_that_is_not_positive_definite_is_refused(system, make, name):
    solver = make(name)
    with pytest.raises(SingularMatrixError):
        refused(solver, system)


def refused(solver, system):
    solver.factor(-secant_entries(system, system.virgin()))
    solver.solve(system.load)


def test_a_preparation_counts_only_until_the_solver_is_used_for_another_matrix(system):
    prepared = system.prepared
    prepared.solve(system.virgin())
    assert prepared.ready
    system.symmetric.factor(2.0 * secant_entries(system, system.virgin()))
    assert not prepared.ready
    np.testing.assert_allclose(
        system.pattern.product(secant_entries(system, system.virgin()), prepared.solve(system.virgin())),
        system.load,
        atol=1e-6 * np.abs(system.load).max(),
    )
