import dataclasses

import pytest

from equilibrium.models import CONCRETE, beam
from fissura.material import Material, material_from_case


def test_standard_ratios():
    m = Material.standard(30e9, 0.24, 3e6, 50.0)
    assert (m.f_s, m.f_c, m.G_s, m.K_c) == (9e6, 48e6, 800.0, pytest.approx(7.8e9))
    assert (m.mu, m.beta, m.n_c) == (0.2, 1.0, 2.0)


def test_every_parameter_comes_from_the_case():
    values = {
        "E": 41e9, "alpha": 0.31, "f_t": 2.5e6, "G_t": 44.0, "f_s": 7e6, "f_c": 33e6,
        "G_s": 999.0, "K_c": 9e9, "mu": 0.25, "beta": 1.5, "n_c": 2.5,
    }  # fmt: skip
    assert material_from_case(beam(material=values)) == Material(**values)


def test_defaults_of_a_case_are_the_standard_material():
    found, standard = dataclasses.asdict(material_from_case(beam())), dataclasses.asdict(CONCRETE)
    assert found.pop("parameters") is standard.pop("parameters") is None
    assert found == pytest.approx(standard, rel=1e-14)
