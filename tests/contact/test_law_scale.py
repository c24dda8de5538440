"""The law with a relative strength and ductility for each contact: the law of a material scaled alike."""

from dataclasses import replace

import numpy as np
import pytest

from equilibrium.models import CONCRETE
from fissura.contact import CusatisCedolin
from fissura.errors import InputError


@pytest.mark.parametrize("own_energy", [False, True])
def test_scaled_contacts_are_those_of_a_scaled_material(own_energy):
    rng = np.random.default_rng(2)
    m = 300
    length = rng.uniform(0.005, 0.02, m)
    scale = rng.uniform(0.4, 1.7, m)
    ductility = rng.uniform(0.6, 2.0, m) if own_energy else None
    law = CusatisCedolin.create(CONCRETE, length, scale, ductility)
    strain = rng.normal(size=(m, 3)) * 3e-4
    history = np.zeros((m, 3))
    traction, new = law.response(strain, history)
    tangent, used = law.tangent(strain, history), law.utilisation(strain)
    for c in range(m):
        h = scale[c]
        g = h * h * (1.0 if ductility is None else ductility[c])
        f = {"f_t": CONCRETE.f_t * h, "f_s": CONCRETE.f_s * h, "f_c": CONCRETE.f_c * h}
        own = replace(CONCRETE, G_t=CONCRETE.G_t * g, G_s=CONCRETE.G_s * g, **f)
        alone = CusatisCedolin.create(own, length[c : c + 1])
        one = slice(c, c + 1)
        t, n = alone.response(strain[one], history[one])
        np.testing.assert_allclose(t, traction[one], rtol=1e-9, atol=1e-6)
        np.testing.assert_allclose(n, new[one], rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(alone.tangent(strain[one], history[one]), tangent[one], rtol=1e-6, atol=1.0)
        np.testing.assert_allclose(alone.utilisation(strain[one]), used[one], rtol=1e-12)


def test_softening_does_not_depend_on_strength_alone():
    """``G_t`` goes with ``H^2``, so that length alone decides how a contact softens."""
    length = np.full(5, 0.01)
    one, other = (CusatisCedolin.create(CONCRETE, length, scale) for scale in (None, np.linspace(0.2, 2.0, 5)))
    for name in ("k_t", "k_s", "n_t"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_a_contact_too_brittle_for_its_length_is_named():
    length = np.array([0.01, 0.02, 0.02])
    CusatisCedolin.create(CONCRETE, length, np.ones(3), np.array([1.0, 0.5, 0.1]))
    with pytest.raises(InputError, match=r"20 mm long.*0.01 times.*below 2\.757 mm.*cross_correlation") as error:
        CusatisCedolin.create(CONCRETE, length, np.ones(3), np.array([0.05, 1.0, 0.01]))
    assert error.value.key == "field.energy"
    with pytest.raises(InputError) as error:  # too long for the mean material: not the field's fault
        CusatisCedolin.create(CONCRETE, length * 20.0, np.ones(3), np.full(3, 0.9))
    assert error.value.key == "discretization.l_f"
    CusatisCedolin.create(CONCRETE, length[:0], np.ones(0), np.ones(0))
