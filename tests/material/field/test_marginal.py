"""Marginal distributions: moments by quadrature, both tails, the graft."""

import itertools

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import log_ndtr

from fissura.errors import InputError
from fissura.material.field import MARGINALS, marginal_named

ALL = [
    ("grafted", {}),
    ("grafted", {"cov": 0.1}),
    ("grafted", {"cov": 0.5, "shape": 12.0, "graft": 0.01}),
    ("grafted", {"cov": 0.15, "shape": 40.0, "graft": 1e-4}),
    ("gaussian", {}),
    ("gaussian", {"cov": 0.02}),
    ("gaussian", {"cov": 0.6, "lower": 0.2}),
    ("lognormal", {}),
    ("lognormal", {"cov": 0.9}),
    ("weibull", {}),
    ("weibull", {"cov": 0.04}),
    ("weibull", {"cov": 1.2}),
]
every = pytest.mark.parametrize(("name", "changes"), ALL)


def made(name, changes):
    values = {"cov": 0.25, **changes}
    return marginal_named(name, **values), values["cov"]


def test_all_are_tested():
    assert {name for name, _ in ALL} == set(MARGINALS)


@every
def test_mean_and_scatter_are_exact(name, changes):
    """By quadrature of the density, which does not know of the transformation."""
    marginal, cov = made(name, changes)
    breaks = marginal.from_gaussian(np.array([-9.0, -6.0, -3.1, -1.0, 0.0, 1.0, 2.0, 4.0, 9.0]))
    edges = [0.0, *breaks, 1.5 * breaks[-1]]
    if name == "gaussian":
        edges[0] = marginal.lower
    if name == "grafted":
        edges = sorted([*edges, marginal.point])

    def moment(n):
        pieces = [
            quad(lambda h: h**n * marginal.pdf(np.float64(h)), a, b, epsabs=1e-13, epsrel=1e-12)[0]
            for a, b in itertools.pairwise(edges)
            if b > a + 1e-12
        ]
        return sum(pieces)

    assert moment(0) == pytest.approx(1.0, abs=1e-8)
    assert moment(1) == pytest.approx(1.0, abs=1e-8)
    assert moment(2) - 1.0 == pytest.approx(cov**2, rel=1e-6)


@every
def test_moments_of_transformed_gaussians(name, changes):
    """By the trapezoidal rule over Gaussian values, which does not know of the density."""
    marginal, cov = made(name, changes)
    z = np.linspace(-12.0, 12.0, 400_001)
    weights = np.exp(-0.5 * z * z) / np.sqrt(2 * np.pi) * (z[1] - z[0])
    h = marginal.from_gaussian(z)
    assert weights @ h == pytest.approx(1.0, abs=1e-9)
    assert weights @ (h - 1.0) ** 2 == pytest.approx(cov**2, rel=1e-7)


@every
def test_probability_survives_the_way_there_and_back(name, changes):
    """``log F(F^-1(Phi(z)))`` against ``log Phi(z)``, from 30 deviations below the mean on."""
    marginal, _ = made(name, changes)
    z = np.linspace(-30.0 if name != "gaussian" else -5.0, 5.0, 501)
    h = marginal.from_gaussian(z)
    assert (np.diff(h) > 0.0).all()
    assert (h > 0.0).all()
    np.testing.assert_allclose(marginal.log_cdf(h), log_ndtr(z), rtol=1e-9, atol=1e-12)


@every
def test_upper_tail_grows_on(name, changes):
    """Far above, where ``Phi`` is 1 to round-off, values still differ and stay finite."""
    marginal, _ = made(name, changes)
    h = marginal.from_gaussian(np.linspace(5.0, 30.0, 101))
    assert np.isfinite(h).all()
    assert (np.diff(h) > 0.0).all()


@every
def test_density_is_the_slope_of_the_distribution(name, changes):
    marginal, _ = made(name, changes)
    h = marginal.from_gaussian(np.linspace(-4.0, 3.0, 40))
    step = 1e-6 * h
    slope = (np.exp(marginal.log_cdf(h + step)) - np.exp(marginal.log_cdf(h - step))) / (2 * step)
    np.testing.assert_allclose(marginal.pdf(h), slope, rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize("changes", [{}, {"cov": 0.1}, {"cov": 0.6, "shape": 10.0, "graft": 0.05}])
def test_graft_is_continuous(changes):
    marginal, _ = made("grafted", changes)
    below, above = marginal.point * (1 - 1e-12), marginal.point * (1 + 1e-12)
    assert marginal.pdf(below) == pytest.approx(marginal.pdf(above), rel=1e-8)
    assert np.exp(marginal.log_cdf(np.float64(below))) == pytest.approx(marginal.probability, rel=1e-9)
    assert np.exp(marginal.log_cdf(np.float64(above))) == pytest.approx(marginal.probability, rel=1e-9)


def test_tail_of_the_graft_is_weibull():
    """On Weibull paper the tail is straight, with the shape as its slope, however far down."""
    marginal = marginal_named("grafted", 0.25)
    assert (marginal.shape, marginal.probability) == (24.0, 1e-3)
    h = marginal.from_gaussian(np.linspace(-37.0, -3.2, 50))
    ordinate = np.log(-np.log1p(-np.exp(marginal.log_cdf(h))))
    slope = np.diff(ordinate) / np.diff(np.log(h))
    np.testing.assert_allclose(slope, 24.0, rtol=1e-6)


def test_nothing_lies_below_the_bound():
    marginal = marginal_named("gaussian", 0.5, lower=0.3)
    h = marginal.from_gaussian(np.linspace(-38.0, 8.0, 1000))
    assert h.min() == pytest.approx(0.3)
    assert h.min() >= 0.3


@pytest.mark.parametrize(
    ("name", "cov", "parameters", "key", "words"),
    [
        ("normal", 0.25, {}, "field.marginal", "grafted"),
        ("gaussian", 0.95, {"lower": 0.1}, "field.cov", "truncated at 0.1"),
        ("gaussian", 0.2, {"lower": 1.0}, "field.lower", "below 1"),
        ("grafted", 0.25, {"lower": 0.1}, "field.lower", 'only with marginal = "gaussian"'),
        ("lognormal", 0.25, {"shape": 3.0}, "field.shape", 'only with marginal = "grafted"'),
        ("grafted", 2.0, {}, "field.cov", "below"),
        ("grafted", 0.25, {"graft": 0.9}, "field.graft", "0.5"),
        ("grafted", 0.25, {"shape": 0.5}, "field.shape", "above 1"),
        ("weibull", 3.0, {}, "field.cov", "2.236"),
    ],
)
def test_what_cannot_be(name, cov, parameters, key, words):
    with pytest.raises(InputError, match=words) as error:
        marginal_named(name, cov, **parameters)
    assert error.value.key == key
