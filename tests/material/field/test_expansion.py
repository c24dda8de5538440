"""Expansions: their covariance as a matrix, exactly; the choice among them."""

import logging

import numpy as np
import pytest

from fissura.errors import InputError
from fissura.material.field import covariance_named
from fissura.material.field.circulant import CirculantExpansion, local_error
from fissura.material.field.eole import DenseExpansion
from fissura.material.field.expansion import expand
from fissura.material.field.separable import SeparableExpansion

SIZE = (0.1, 0.04, 0.02)
POINTS = np.random.default_rng(4).random((60, 3)) * SIZE
POINTS[:8] = np.stack(np.meshgrid(*([0.0, s] for s in SIZE)), axis=-1).reshape(-1, 3)  # corners


def models(length=0.03):
    return [
        covariance_named("squared-exponential", (length,)),
        covariance_named("squared-exponential", (2 * length, length, 0.5 * length)),
        covariance_named("exponential", (length,)),
        covariance_named("matern", (length,), 1.5),
    ]


def covariance_of(expansion, x):
    """Covariance matrix of the field at points: its values for one number after the other."""
    columns = [expansion.realisation(row)(x) for row in np.eye(expansion.accuracy.modes)]
    return np.stack(columns, axis=1) @ np.stack(columns, axis=1).T


@pytest.mark.parametrize("covariance", models(0.05), ids=["se", "se3", "exp", "matern"])
@pytest.mark.parametrize("kind", ["modes", "circulant"])
def test_covariance_of_the_field(covariance, kind):
    """Variance 1 everywhere to round-off; correlation off by no more than the variance error explains.

    With one set of nodes for all points, what is lost is a field of its own, not correlated with what is kept.
    Estimates from different nodes are: there the deviation of the error counts, not its variance.
    """
    steps = covariance.length / 3
    if kind == "circulant":
        expansion = CirculantExpansion(covariance, SIZE, (1.5 if covariance.model.separable else 2.5) * steps)
    elif covariance.model.separable:
        expansion = SeparableExpansion(covariance, SIZE, steps, 0.01)
    else:
        expansion = DenseExpansion(covariance, SIZE, steps, 0.01)
    found = covariance_of(expansion, POINTS)
    np.testing.assert_allclose(np.diag(found), 1.0, atol=2e-12)
    off = np.abs(found - covariance.between(POINTS, POINTS))
    error = expansion.accuracy.largest
    assert off.max() <= 2.0 * (error if kind == "modes" else np.sqrt(error)) + 1e-3
    assert expansion.accuracy.mean <= expansion.accuracy.largest


def test_variance_error_is_that_of_the_modes():
    """What is reported against the variance of the field before it is corrected, at many points."""
    covariance = covariance_named("squared-exponential", (0.03,))
    for limit in (0.2, 0.01):
        one = SeparableExpansion(covariance, SIZE, covariance.length / 3, limit)
        other = DenseExpansion(covariance, SIZE, covariance.length / 3, limit)
        assert one.accuracy.mean <= limit
        assert other.accuracy.mean <= limit
        assert abs(one.accuracy.modes - other.accuracy.modes) <= 1
        nodes = other._nodes
        x = np.random.default_rng(1).random((8000, 3)) * SIZE
        on_faces = np.round(np.random.default_rng(2).random((4000, 3)) * 10.0) / 10.0 * SIZE
        error = 1.0 - np.square(covariance.between(x, nodes) @ other._basis).sum(axis=1)
        assert error.mean() == pytest.approx(other.accuracy.mean, rel=0.03)
        there = 1.0 - np.square(covariance.between(on_faces, nodes) @ other._basis).sum(axis=1)
        assert max(error.max(), there.max()) == pytest.approx(other.accuracy.largest, rel=0.1)


def test_products_of_axes_are_the_modes_of_the_grid():
    """Both expansions of a separable covariance are one: same covariance matrix, though each has its own modes."""
    covariance = covariance_named("squared-exponential", (0.04, 0.03, 0.02))
    matrices = [
        covariance_of(kind(covariance, SIZE, covariance.length / 3, 1e-5), POINTS)
        for kind in (SeparableExpansion, DenseExpansion)
    ]
    np.testing.assert_allclose(*matrices, atol=5e-5)


@pytest.mark.parametrize("covariance", [models()[1], models()[3]], ids=["separable", "not"])
@pytest.mark.parametrize("kind", ["modes", "circulant"])
def test_values_do_not_depend_on_other_points(covariance, kind):
    """Bit for bit but for products of matrices, whose sums may be taken in another order."""
    if kind == "circulant":
        expansion = CirculantExpansion(covariance, SIZE, covariance.length / 3)
    else:
        small = SeparableExpansion if covariance.model.separable else DenseExpansion
        expansion = small(covariance, SIZE, covariance.length / 3, 0.01)
    at = expansion.realisation(np.random.default_rng(3).standard_normal(expansion.accuracy.modes))
    x = np.random.default_rng(5).random((9000, 3)) * SIZE
    order = np.random.default_rng(6).permutation(len(x))
    whole = at(x)
    np.testing.assert_array_equal(at(x), whole)
    np.testing.assert_allclose(at(x[order]), whole[order], rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(np.concatenate([at(x[:7]), at(x[7:])]), whole, rtol=0.0, atol=1e-12)
    assert at(x[:0]).shape == (0,)


def test_local_estimate_meets_the_nodes():
    """Where points are nodes of the torus nothing is lost."""
    covariance = covariance_named("matern", (0.03,), 1.5)
    expansion = CirculantExpansion(covariance, SIZE, np.full(3, 0.01))
    at = expansion.realisation(np.random.default_rng(3).standard_normal(expansion.accuracy.modes))
    nodes = np.array([[0.01, 0.02, 0.0], [0.05, 0.01, 0.02]])
    np.testing.assert_allclose(at(nodes + 1e-12), at(nodes), atol=1e-6)
    assert local_error(covariance, np.full(3, 0.01))[0] > local_error(covariance, np.full(3, 0.005))[0] > 0.0


def test_leading_numbers_move_the_field_most():
    covariance = covariance_named("squared-exponential", (0.03,))
    for expansion in (
        SeparableExpansion(covariance, SIZE, covariance.length / 3, 0.01),
        DenseExpansion(covariance, SIZE, covariance.length / 3, 0.01),
        CirculantExpansion(covariance, SIZE, covariance.length / 2),
    ):
        spread = []
        for k in (*expansion.leading(3), expansion.leading(expansion.accuracy.modes)[-1]):
            unit = np.zeros(expansion.accuracy.modes)
            unit[k] = 1.0
            spread.append(np.square(expansion.realisation(unit)(POINTS)).mean())
        assert min(spread[:3]) > 5.0 * spread[3]


def test_choice_goes_by_size():
    se, matern = covariance_named("squared-exponential", (0.03,)), covariance_named("matern", (0.03,), 2.5)
    assert expand(se, SIZE).accuracy.method == "EOLE, separable"
    assert expand(matern, SIZE).accuracy.method == "EOLE"
    assert expand(matern, (0.3, 0.1, 0.1)).accuracy.method == "circulant embedding"
    assert expand(se, (1.0, 0.3, 0.3)).accuracy.method == "circulant embedding"
    for covariance, size in ((matern, SIZE), (se, SIZE), (matern, (0.3, 0.1, 0.1))):
        assert expand(covariance, size, 0.003).accuracy.mean <= 0.003


def test_grid_that_misses_the_error_says_so(caplog):
    rough = covariance_named("exponential", (0.03,))
    with caplog.at_level(logging.WARNING):
        found = expand(rough, SIZE, 0.01, spacing=0.01).accuracy
    assert found.mean > 0.1
    assert "variance error" in caplog.text
    assert expand(rough, SIZE, 0.08).accuracy.mean <= 0.08


@pytest.mark.parametrize(("spacing", "key"), [(None, "field.length"), (1e-5, "field.spacing")])
def test_too_many_nodes_are_refused(spacing, key):
    covariance = covariance_named("squared-exponential", (1e-4,))
    with pytest.raises(InputError, match="nodes") as error:
        expand(covariance, SIZE if spacing else (1.0, 1.0, 1.0), spacing=spacing)
    assert error.value.key == key
