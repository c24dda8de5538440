import dataclasses

import pytest

from equilibrium.models import CONCRETE, beam
from fissura.material import Material, material_from_case


def test_standard_ratios():
    m = Material.standard(30e9, 0.24, 3e6, 50.0)
    assert (m.f_s, m.f_c, m.G_s, m.K_c) == (9e6, 48e6, 800.0, pytest.approx(7.8e9))
    assert (m.mu, m.beta, m.n_c) == (0.2, 1.0, 2.0)


def test_limits_of_length_follow_the_theory():
    """``l_t = 2 E G_t / f_t^2`` and ``(16 alpha / 9) l_t`` with the default ratios."""
    assert CONCRETE.longest_tension == pytest.approx(2 * 60e9 * 35 / 2.2e6**2, rel=1e-14)
    assert CONCRETE.longest_shear == pytest.approx(16 * 0.29 / 9 * CONCRETE.longest_tension, rel=1e-14)


def test_limits_are_where_softening_moduli_grow_without_bound():
    """``K_t -> infinity``: the softening branch becomes vertical in a contact of that length."""
    length = CONCRETE.longest_tension * (1 - 1e-9)
    slope = 2 * CONCRETE.E * CONCRETE.G_t - CONCRETE.f_t**2 * length
    assert slope / (2 * CONCRETE.E * CONCRETE.G_t) == pytest.approx(1e-9, rel=1e-5)


def test_every_parameter_comes_from_the_case():
    values = {
        "E": 41e9, "alpha": 0.31, "f_t": 2.5e6, "G_t": 44.0, "f_s": 7e6, "f_c": 33e6,
        "G_s": 999.0, "K_c": 9e9, "mu": 0.25, "beta": 1.5, "n_c": 2.5,
    }  # fmt: skip
    assert dataclasses.asdict(material_from_case(beam(material=values))) == values


def test_defaults_of_a_case_are_the_standard_material():
    assert dataclasses.asdict(material_from_case(beam())) == pytest.approx(dataclasses.asdict(CONCRETE), rel=1e-14)
