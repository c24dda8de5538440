"""The law with a steep drop and a long tail: its energies, the published law as a limit, tangent, case file."""

import dataclasses
import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from equilibrium.models import CONCRETE
from fissura import run
from fissura.contact import CusatisCedolin, TwoEnergies
from fissura.contact.two_energies import TwoEnergiesTable, energy_of_tail
from fissura.errors import InputError

from .paths import LENGTH, PATHS, YIELD, answered, extrapolated, random_states, slopes

NAME = "cusatis-cedolin-two-energies"
INITIAL, TAIL = st.floats(0.05, 0.5), st.floats(0.01, 0.9)


def law_of(initial=0.25, tail=0.2, length=(LENGTH,)):
    material = dataclasses.replace(CONCRETE, parameters=TwoEnergiesTable(initial=initial, tail=tail))
    return TwoEnergies.create(material, np.array(length))


def pulled(law, openings, shear=0.0):
    """Tractions at strains beyond the strength of tension, or of shear where `shear` is 1."""
    strain = np.zeros((len(openings), 3))
    strain[:, 1 if shear else 0] = openings
    many = dataclasses.replace(
        law,
        scale=np.ones(len(strain)),
        **{name: np.repeat(getattr(law, name), len(strain)) for name in ("length", "k_t", "k_s", "n_t")},
    )
    return many.response(strain, many.initial_history())[0][:, 1 if shear else 0]


@settings(max_examples=50)
@given(INITIAL, TAIL)
def test_tension_dissipates_G_t(initial, tail):
    """By Gauss points on panels of the shorter decay; what is left beyond them is known.

    They end before the trace of stiffness left to broken contacts shows.
    """
    law = law_of(initial, tail)
    share, steep, flat = law._softening()
    decay = CONCRETE.f_t / law.k_t[0]
    node, weight = np.polynomial.legendre.leggauss(20)
    panels, width = math.ceil(6.0 * steep / flat), decay / steep
    openings = width * (np.arange(panels)[:, None] + 0.5 * (1 + node))
    area = 0.5 * width * (pulled(law, YIELD + openings.ravel()) @ np.tile(weight, panels))
    end = panels * width / decay
    rest = (
        decay
        * CONCRETE.f_t
        * sum(part / rate * math.exp(-rate * end) for part, rate in ((1.0 - share, steep), (share, flat)))
    )
    assert LENGTH * (0.5 * CONCRETE.f_t * YIELD + area + rest) == pytest.approx(CONCRETE.G_t, rel=1e-9)


@settings(max_examples=50)
@given(INITIAL, TAIL)
def test_the_area_under_the_tangent_at_the_peak_is_the_initial_energy(initial, tail):
    """Up to the energy of the elastic peak, which both laws have alike."""
    law = law_of(initial, tail)
    step = 1e-5 * CONCRETE.f_t / law.k_t[0]
    lost = CONCRETE.f_t - pulled(law, np.array([YIELD + step, YIELD + 2 * step]))
    slope = (4.0 * lost[0] - lost[1]) / (2.0 * step)
    whole = CONCRETE.f_t**2 / law.k_t[0]
    assert 0.5 * CONCRETE.f_t**2 / slope == pytest.approx(initial * whole, rel=1e-5)


@given(INITIAL, TAIL)
def test_the_shares_of_energy(initial, tail):
    energy = energy_of_tail(initial, tail)
    assert tail <= energy * (1 + 1e-12)
    assert energy < 1.0
    slope = (1.0 - tail) ** 2 / (1.0 - energy) + tail**2 / energy
    assert 0.5 / slope == pytest.approx(initial, rel=1e-9)


@pytest.mark.parametrize("shear", [0, 1])
def test_where_tension_and_shear_start_to_soften_is_as_published(shear):
    law, published = law_of(), CusatisCedolin.create(CONCRETE, np.array([LENGTH]))
    openings = np.linspace(0.1, 1.0, 10) * (3.0 / CONCRETE.alpha if shear else 1.0) * YIELD
    np.testing.assert_array_equal(pulled(law, openings, shear), pulled(published, openings, shear))


@settings(max_examples=60)
@given(PATHS, TAIL)
def test_with_half_of_the_energy_initial_it_is_the_published_law(corners, tail):
    path = np.concatenate([a + np.linspace(0, 1, 6)[1:, None] * (b - a) for a, b in _pieces(corners)])
    published = CusatisCedolin.create(CONCRETE, np.array([LENGTH]))
    (traction, history), (wanted, known) = answered(law_of(0.5, tail), path), answered(published, path)
    unit = CONCRETE.f_t
    np.testing.assert_allclose(traction, wanted, rtol=1e-6, atol=1e-6 * unit)
    np.testing.assert_allclose(history, known, rtol=1e-6, atol=1e-9)


def _pieces(corners):
    points = np.concatenate([np.zeros((1, 3)), np.array(corners, float)]) * YIELD
    return itertools.pairwise(points)


@pytest.mark.parametrize("known", [False, True])
@pytest.mark.parametrize(("initial", "tail"), [(0.25, 0.2), (0.1, 0.4), (0.45, 0.05)])
def test_tangent(initial, tail, known):
    rng = np.random.default_rng(3)
    law = law_of(initial, tail, np.full(4000, LENGTH))
    strain, history = random_states(law, rng, known=known)
    exact, coarse, fine, size = slopes(law, rng, strain, history)
    smooth = np.linalg.norm(coarse - fine, axis=1) < 1e-5 * size  # no kink nearby
    assert smooth.mean() > 0.8
    error = np.linalg.norm(exact - extrapolated(coarse, fine), axis=1)
    assert (error[smooth] < 1e-6 * size[smooth]).all()


def test_a_case_gives_its_table(small_case):
    case = small_case(material__law=NAME)
    assert case.material.parameters == TwoEnergiesTable(initial=0.25, tail=0.2)
    other = case.with_({f"material.{NAME}.initial": 0.3})
    assert other.material.parameters == TwoEnergiesTable(initial=0.3, tail=0.2)
    with pytest.raises(InputError, match=f"{NAME}.initial"):
        case.with_({f"material.{NAME}.initial": 0.6})


def test_a_tail_weakens_and_lasts_longer(small_case):
    drop, plain = (run(small_case(material__law=law, control__target=4e-4)) for law in (NAME, "cusatis-cedolin"))
    assert drop.peak_load < 0.95 * plain.peak_load
    assert drop.load_values[-1] > 1.1 * plain.load_values[-1]
    assert abs(drop.summary["energy_balance_error"]) < 1e-5
