import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fissura.linear.krylov import dot, gmres, norm


def problem(seed, size=30, spread=1.0):
    """A well-conditioned unsymmetric matrix, a right-hand side, and an invertible preconditioner."""
    rng = np.random.default_rng(seed)
    matrix = np.eye(size) + spread * rng.normal(size=(size, size)) / np.sqrt(size) / 2
    return matrix, rng.normal(size=size), np.diag(rng.uniform(0.5, 2.0, size))


def operator(matrix, preconditioner):
    def apply(v):
        move = preconditioner @ v
        return move, matrix @ move

    return apply


@pytest.mark.parametrize("seed", range(5))
def test_solves_an_unsymmetric_system(seed):
    matrix, right, preconditioner = problem(seed)
    found = gmres(operator(matrix, preconditioner), right, 1e-12, 60)
    np.testing.assert_allclose(found.solution, np.linalg.solve(matrix, right), rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("most", [1, 3, 6, 10])
def test_the_reduction_is_that_of_the_true_residual_and_the_least_possible(most):
    matrix, right, preconditioner = problem(7)
    found = gmres(operator(matrix, preconditioner), right, 0.0, most)
    assert found.iterations == most
    rest = right - matrix @ found.solution
    assert found.reduction == pytest.approx(np.linalg.norm(rest) / np.linalg.norm(right), rel=1e-9)
    space, v = [], right
    for _ in range(most):
        space.append(v / np.linalg.norm(v))
        v = matrix @ preconditioner @ space[-1]
    images = matrix @ preconditioner @ np.linalg.qr(np.array(space).T)[0]
    best = right - images @ np.linalg.lstsq(images, right, rcond=None)[0]
    assert np.linalg.norm(rest) == pytest.approx(np.linalg.norm(best), rel=1e-6)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 1000), rank=st.integers(0, 6), tolerance=st.sampled_from([0.1, 1e-3, 1e-8]))
def test_a_matrix_that_differs_from_the_preconditioner_in_a_few_directions_takes_as_few_iterations(
    seed, rank, tolerance
):
    rng = np.random.default_rng(seed)
    known = np.eye(25) + 0.3 * np.diag(rng.uniform(size=24), 1)
    matrix = known + 0.5 * rng.normal(size=(25, rank)) @ rng.normal(size=(rank, 25)) / 5.0
    inverse = np.linalg.inv(known)
    right = rng.normal(size=25)
    found = gmres(operator(matrix, inverse), right, tolerance, 40)
    assert found.iterations <= rank + 1
    assert np.linalg.norm(right - matrix @ found.solution) <= tolerance * np.linalg.norm(right) * (1 + 1e-6) + 1e-12


def test_nothing_to_do():
    found = gmres(operator(np.eye(4), np.eye(4)), np.zeros(4), 1e-8, 10)
    assert (found.iterations, found.reduction) == (0, 0.0)
    np.testing.assert_array_equal(found.solution, np.zeros(4))


def test_a_singular_operator_is_reported_by_what_is_left():
    """A right-hand side outside of the range cannot be reached."""
    matrix = np.diag([1.0, 2.0, 0.0])
    found = gmres(operator(matrix, np.eye(3)), np.array([1.0, 1.0, 1.0]), 1e-8, 10)
    assert found.reduction == pytest.approx(1 / np.sqrt(3))


def test_values_that_are_not_finite_end_the_iteration():
    found = gmres(lambda v: (v, np.full_like(v, np.nan)), np.ones(3), 1e-8, 10)
    assert (found.iterations, found.reduction) == (0, 1.0)


def test_dot_and_norm():
    a, b = np.random.default_rng(1).normal(size=(2, 1001))
    assert dot(a, b) == pytest.approx(a @ b, rel=1e-12)
    assert norm(a) == pytest.approx(np.linalg.norm(a), rel=1e-12)
