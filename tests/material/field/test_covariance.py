"""Correlation functions against closed forms, and their table."""

import numpy as np
import pytest

from fissura.errors import InputError
from fissura.material.field import covariance_named
from fissura.material.field.covariance import MODELS, matern

D = np.concatenate([[0.0], np.geomspace(1e-6, 30.0, 200)])


@pytest.mark.parametrize(
    ("nu", "closed"),
    [
        (0.5, lambda d: np.exp(-d)),
        (1.5, lambda d: (1 + np.sqrt(3) * d) * np.exp(-np.sqrt(3) * d)),
        (2.5, lambda d: (1 + np.sqrt(5) * d + 5 / 3 * d * d) * np.exp(-np.sqrt(5) * d)),
    ],
)
def test_matern_has_its_closed_forms(nu, closed):
    np.testing.assert_allclose(matern(D, nu), closed(D), rtol=1e-12, atol=1e-15)


def test_matern_tends_to_a_squared_exponential():
    assert np.abs(matern(D, 50.0) - np.exp(-D * D / 2)).max() < 0.01
    assert np.abs(matern(D, 0.5) - np.exp(-D * D / 2)).max() > 0.1


@pytest.mark.parametrize(("name", "nu"), [("squared-exponential", None), ("exponential", None), ("matern", 1.3)])
def test_the_table_gives_the_correlation(name, nu):
    covariance = covariance_named(name, (0.02, 0.05, 0.1), nu)
    rng = np.random.default_rng(1)
    x, y = rng.random((40, 3)), np.concatenate([rng.random((50, 3)) * 0.1, rng.random((50, 3))])
    y[:5] = x[:5]
    exact = covariance.between(x, y)
    np.testing.assert_allclose(covariance.tabulated(x, y), exact, atol=2e-9)
    scaled = np.linalg.norm((x[:, None] - y) / [0.02, 0.05, 0.1], axis=2)
    np.testing.assert_allclose(exact, covariance.of(scaled))
    assert np.linalg.eigvalsh(covariance.between(y, y)).min() > -1e-12


@pytest.mark.parametrize("name", MODELS)
def test_correlation_falls_from_one(name):
    covariance = covariance_named(name, (1.0,), 2.2 if name == "matern" else None)
    values = covariance.of(D)
    assert values[0] == 1.0
    assert (np.diff(values) <= 1e-15).all()
    assert values[-1] < 1e-9
    assert covariance.of(covariance.reach(1e-3)) == pytest.approx(1e-3)


@pytest.mark.parametrize(
    ("arguments", "key", "words"),
    [
        (("spherical", (1.0,)), "field.correlation", "matern"),
        (("matern", (1.0,)), "field.nu", "missing"),
        (("exponential", (1.0,), 1.5), "field.nu", "has none"),
        (("matern", (1.0,), 80.0), "field.nu", "at most 50"),
    ],
)
def test_what_cannot_be(arguments, key, words):
    with pytest.raises(InputError, match=words) as error:
        covariance_named(*arguments)
    assert error.value.key == key
