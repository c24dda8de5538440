"""The contact law: strength, softening, limits (theory section 3)."""

import dataclasses
import math

import numpy as np
import pytest

from equilibrium.models import CONCRETE, beam
from fissura.contact import CusatisCedolin, law_from_case
from fissura.contact.strength import lowest_strength, transition_angle
from fissura.errors import InputError
from fissura.material import Material

from . import reference

YIELD = CONCRETE.f_t / CONCRETE.E  # strain at the tensile strength


def law_of(count, length=0.0125, material=CONCRETE, scale=None):
    return CusatisCedolin.create(material, np.full(count, length), scale)


def virgin(strain, length=0.0125, material=CONCRETE, scale=None):
    law = law_of(len(strain), length, material, scale)
    return law.response(strain, law.initial_history())


def direction(omega, alpha=CONCRETE.alpha, turn=0.7):
    """Strains of unit effective strain in the direction omega."""
    omega = np.atleast_1d(omega)
    e_t = np.cos(omega) / np.sqrt(alpha)
    return np.stack([np.sin(omega), e_t * np.cos(turn), e_t * np.sin(turn)], axis=1)


def effective(traction, alpha=CONCRETE.alpha):
    return np.sqrt(traction[:, 0] ** 2 + (traction[:, 1:] ** 2).sum(axis=1) / alpha)


def at_strength(omega, material=CONCRETE):
    """Tractions ``s_N, s_T`` of virgin contacts just at their strength."""
    strain = direction(omega, material.alpha)
    strain /= law_of(len(strain), material=material).utilisation(strain)[:, None]
    return strain, material.E * strain[:, 0], material.alpha * material.E * np.hypot(*strain[:, 1:].T)


@pytest.mark.parametrize("length", [0.002, 0.0125, 0.06, 0.2])
def test_pure_tension_peaks_at_f_t_and_dissipates_G_t(length):
    law = law_of(1, length)
    decay = CONCRETE.f_t / law.k_t[0]
    # The branch is an exponential; Gauss points on panels of one decay length integrate it to round-off. Beyond the
    # last panel, where the trace of stiffness left to broken contacts would show, it is continued by itself.
    node, weight = np.polynomial.legendre.leggauss(20)
    edges = YIELD + decay * np.arange(12.0)
    e = (edges[:-1, None] + 0.5 * decay * (1 + node)).ravel()
    strain = np.zeros((len(e), 3))
    strain[:, 0] = e
    traction, history = virgin(strain, length)
    tail = decay * traction[-1, 0] * math.exp((e[-1] - edges[-1]) / decay)
    area = 0.5 * CONCRETE.f_t * YIELD + np.tile(0.5 * decay * weight, 11) @ traction[:, 0] + tail
    assert length * area == pytest.approx(CONCRETE.G_t, rel=1e-11)
    assert traction[:, 0].max() <= CONCRETE.f_t * (1 + 1e-14)
    peak, _ = virgin(np.array([[YIELD, 0.0, 0.0]]), length)
    assert peak[0, 0] == pytest.approx(CONCRETE.f_t, rel=1e-14)
    assert (np.diff(history[:, 0]) > 0).all()


def test_pure_shear_peaks_at_three_times_f_t():
    e = np.linspace(0.9, 1.5, 2001) * 3 * CONCRETE.f_t / (CONCRETE.alpha * CONCRETE.E)
    strain = np.stack([0 * e, 0.6 * e, -0.8 * e], axis=1)
    traction, _ = virgin(strain)
    shear = np.hypot(*traction[:, 1:].T)
    assert shear.max() == pytest.approx(3 * CONCRETE.f_t, rel=1e-3)
    assert shear.max() <= 3 * CONCRETE.f_t * (1 + 1e-12)
    assert not traction[:, 0].any()
    exact, _ = virgin(np.array([[0.0, 3 * CONCRETE.f_t / (CONCRETE.alpha * CONCRETE.E), 0.0]]))
    assert exact[0, 1] == pytest.approx(3 * CONCRETE.f_t, rel=1e-14)


def test_pure_compression_never_softens():
    law = law_of(1)
    history, last = law.initial_history(), 0.0
    for e in np.linspace(0.0, 400.0, 801)[1:] * YIELD:
        traction, history = law.response(np.array([[-e, 0.0, 0.0]]), history)
        assert -traction[0, 0] > last
        last = -traction[0, 0]
        assert (history[0, 0] > 0) == (e > 16 * YIELD * (1 + 1e-12))
        assert last >= min(CONCRETE.E * e, 16 * CONCRETE.f_t) * (1 - 1e-12)


@pytest.mark.parametrize("alpha", [0.05, 0.24, 0.29, 0.6, 1.0])
def test_transition_angle(alpha):
    material = dataclasses.replace(CONCRETE, alpha=alpha)
    assert math.tan(transition_angle(material)) == pytest.approx(-1.0654 * math.sqrt(alpha), rel=1e-4)


def test_transition_angle_for_other_constants_is_where_the_surfaces_meet():
    material = dataclasses.replace(CONCRETE, mu=0.4, f_c=20 * CONCRETE.f_t, beta=1.3)
    omega0 = transition_angle(material)
    assert -math.atan(math.sqrt(material.alpha) / material.mu) < omega0 < 0
    omega = omega0 + np.array([1e-9, -1e-9])
    _, s_n, s_t = at_strength(omega, material)
    np.testing.assert_allclose(s_n[0], s_n[1], rtol=1e-7)
    shear = (material.f_t - s_n) * (material.f_s**2 / material.f_t - material.mu**2 * s_n)
    np.testing.assert_allclose(s_t**2, shear, rtol=1e-6)
    np.testing.assert_allclose(s_n**2 + s_t**2 / material.beta, material.f_c**2, rtol=1e-6)


def test_strength_in_tractions():
    omega0 = transition_angle(CONCRETE)
    upper = np.linspace(omega0, np.pi / 2, 400)
    _, s_n, s_t = at_strength(upper)
    f_t = CONCRETE.f_t
    np.testing.assert_allclose(s_t**2, (f_t - s_n) * (9 * f_t - 0.04 * s_n), rtol=1e-10, atol=1e-12 * f_t**2)
    lower = np.linspace(-np.pi / 2, omega0 - 1e-12, 200)
    _, s_n, s_t = at_strength(lower)
    np.testing.assert_allclose(np.hypot(s_n, s_t), 16 * f_t, rtol=1e-12)


def test_strength_equals_the_printed_form():
    """``f_t (4.52 s - sqrt(...)) / (0.04 s^2 - alpha c^2)``, away from its removable 0/0."""
    omega0 = transition_angle(CONCRETE)
    for omega in np.linspace(-1.57, 1.57, 301):
        if abs(0.04 * math.sin(omega) ** 2 - CONCRETE.alpha * math.cos(omega) ** 2) > 1e-4:
            value = CONCRETE.E / law_of(1).utilisation(direction(omega))[0]
            assert value == pytest.approx(reference.strength(omega, omega0, CONCRETE), rel=1e-9)


def test_damage_begins_at_the_strength():
    omega = np.linspace(-np.pi / 2, np.pi / 2, 181)
    strain, _, _ = at_strength(omega)
    _, below = virgin(strain * (1 - 1e-9))
    _, above = virgin(strain * (1 + 1e-6))
    assert not below[:, 0].any()
    assert above[:, 0].min() > 0


def test_random_strains_and_histories_against_a_second_implementation():
    rng = np.random.default_rng(3)
    n, length = 4000, 0.0125
    size = YIELD * 10 ** rng.uniform(-0.5, 2.0, (n, 1))
    strain = rng.normal(size=(n, 3)) * size
    law = law_of(n, length)
    _, history = law.response(rng.normal(size=(n, 3)) * size * rng.uniform(0, 1.5, (n, 1)), law.initial_history())
    traction, new = law.response(strain, history)
    for c in range(n):
        expected, *state = reference.response(strain[c], history[c], length, law.omega0, CONCRETE)
        if state[0] < 1 - 1e-8:  # a trace of stiffness stays in a broken contact
            np.testing.assert_allclose(traction[c], expected, rtol=1e-7, atol=1e-9 * CONCRETE.f_t)
        np.testing.assert_allclose(new[c], state, rtol=1e-12, atol=1e-8)
    assert (new[:, 0] > history[:, 0]).mean() > 0.3


@pytest.mark.parametrize("length", [0.005, 0.05])
def test_slope_of_the_boundary(length):
    """``K(pi/2) = -K_t``, ``K(0) = -K_s``, ``K(omega0) = 0``, ``K(-pi/2) = K_c``, from tractions alone."""
    law = law_of(1, length)
    k_t, k_s, _ = reference.softening(length, law.omega0, CONCRETE)
    for omega, expected in ((np.pi / 2, -k_t), (0.0, -k_s), (law.omega0, 0.0), (-np.pi / 2, CONCRETE.K_c)):
        strain = direction(omega)
        f = CONCRETE.E / law.utilisation(strain)[0]
        e = f / CONCRETE.E * 1.5
        traction, _ = law.response(strain * e, law.initial_history())
        slope = f * math.log(effective(traction)[0] / f) / (e - f / CONCRETE.E)
        assert slope == pytest.approx(expected, rel=1e-8, abs=1e-6 * k_t)


@pytest.mark.parametrize("known", [False, True])
@pytest.mark.parametrize("where", ["omega0", "zero"])
def test_tractions_do_not_jump(where, known):
    law = law_of(2)
    omega = law.omega0 if where == "omega0" else 0.0
    strain = direction(omega + np.array([1e-9, -1e-9]))
    history = law.initial_history()
    if known:
        _, history = law.response(np.tile([20.0, 5.0, -3.0], (2, 1)) * YIELD, history)
    for factor in (0.5, 3.0, 8.0, 20.0, 60.0):
        traction, new = law.response(factor * YIELD * strain, history)
        np.testing.assert_allclose(traction[0], traction[1], rtol=1e-6, atol=1e-7 * CONCRETE.f_t)
        assert new[0, 0] == pytest.approx(new[1, 0], abs=1e-7)


def test_unloading_is_secant_to_the_origin():
    rng = np.random.default_rng(8)
    law = law_of(50)
    strain = rng.normal(size=(50, 3)) * 4 * YIELD
    first, history = law.response(strain, law.initial_history())
    assert (history[:, 0] > 0).any()
    for factor in (0.8, 0.3, 0.0):
        traction, after = law.response(factor * strain, history)
        np.testing.assert_allclose(traction, factor * first, rtol=1e-13, atol=1e-12 * CONCRETE.f_t)
        np.testing.assert_array_equal(after, history)
    again, _ = law.response(strain, history)
    np.testing.assert_allclose(again, first, rtol=1e-13)


def test_history_of_tension_weakens_shear_but_not_pure_compression():
    law = law_of(1)
    _, history = law.response(np.array([[6.0, 0.0, 0.0]]) * YIELD, law.initial_history())
    shear = np.array([[0.0, 8.0, 0.0]]) * YIELD
    weak, _ = law.response(shear, history)
    strong, _ = law.response(shear, law.initial_history())
    assert abs(weak[0, 1]) < 0.9 * abs(strong[0, 1])
    # Under compression beyond the cap damage is what it is, the boundary does not look at e_max.
    press = np.array([[-500.0, 0.0, 0.0]]) * YIELD
    _, a = law.response(press, np.array([[0.0, history[0, 1], 0.0]]))
    _, b = law.response(press, law.initial_history())
    assert a[0, 0] == pytest.approx(b[0, 0], rel=1e-13)


@pytest.mark.parametrize("opened", [2.0, 50.0, 5000.0])
def test_a_crack_that_closes_keeps_its_damage(opened):
    """Contact is not restored: what has opened far carries next to nothing when it is pressed."""
    law = law_of(1)
    _, history = law.response(np.array([[opened, 0.0, 0.0]]) * YIELD, law.initial_history())
    closed = np.array([[-10.0, 0.0, 0.0]]) * YIELD
    traction, after = law.response(closed, history)
    np.testing.assert_array_equal(after[:, 0], history[:, 0])
    assert traction[0, 0] == pytest.approx((1.0 - history[0, 0]) * CONCRETE.E * closed[0, 0], rel=1e-13)
    assert (traction[0, 0] / (CONCRETE.E * closed[0, 0]) < 1e-3) == (opened == 5000.0)


def test_tangential_directions_are_alike():
    rng = np.random.default_rng(4)
    law = law_of(200)
    strain = rng.normal(size=(200, 3)) * 5 * YIELD
    _, history = law.response(0.7 * rng.normal(size=(200, 3)) * 5 * YIELD, law.initial_history())
    turn = 1.1
    q = np.array([[1, 0, 0], [0, math.cos(turn), -math.sin(turn)], [0, math.sin(turn), math.cos(turn)]])
    a, new_a = law.response(strain, history)
    b, new_b = law.response(strain @ q.T, history)
    np.testing.assert_allclose(b, a @ q.T, rtol=1e-9, atol=1e-9 * CONCRETE.f_t)
    np.testing.assert_allclose(new_b, new_a, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(
        law.tangent(strain @ q.T, history), q @ law.tangent(strain, history) @ q.T, atol=1e-8 * CONCRETE.E
    )


@pytest.mark.parametrize("factor", [0.6, 1.7])
def test_scale_goes_with_strength_and_its_square_with_energy(factor):
    """H: ``f_t`` goes with H, ``G_t`` with its square, everything else stays."""
    rng = np.random.default_rng(5)
    strain = rng.normal(size=(300, 3)) * 5 * YIELD
    m = CONCRETE
    scaled = dataclasses.replace(
        m, f_t=factor * m.f_t, f_s=factor * m.f_s, f_c=factor * m.f_c, G_t=factor**2 * m.G_t, G_s=factor**2 * m.G_s
    )
    a, new_a = virgin(strain, scale=np.full(300, factor))
    b, new_b = virgin(strain, material=scaled)
    np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-12 * m.f_t)
    np.testing.assert_allclose(new_a, new_b, rtol=1e-12, atol=1e-14)
    c, _ = virgin(strain / factor)
    np.testing.assert_allclose(a, factor * c, rtol=1e-9, atol=1e-12 * m.f_t)
    law = law_of(300, scale=np.full(300, factor))
    np.testing.assert_allclose(law.utilisation(strain), law_of(300).utilisation(strain) / factor, rtol=1e-12)


def test_contacts_do_not_see_each_other():
    rng = np.random.default_rng(6)
    length, scale = rng.uniform(0.004, 0.03, 40), rng.uniform(0.5, 1.5, 40)
    strain = rng.normal(size=(40, 3)) * 5 * YIELD
    law = CusatisCedolin.create(CONCRETE, length, scale)
    traction, new = law.response(strain, law.initial_history())
    for c in range(0, 40, 7):
        single = CusatisCedolin.create(CONCRETE, length[c : c + 1], scale[c : c + 1])
        one, state = single.response(strain[c : c + 1], single.initial_history())
        np.testing.assert_array_equal(one[0], traction[c])
        np.testing.assert_array_equal(state[0], new[c])


def test_no_strain_no_traction():
    law = law_of(1)
    traction, new = law.response(np.zeros((1, 3)), law.initial_history())
    assert not traction.any()
    assert not new.any()
    np.testing.assert_allclose(law.tangent(np.zeros((1, 3)), new)[0], np.diag(law.elastic))


def test_a_broken_contact_keeps_a_trace_of_stiffness():
    traction, history = virgin(np.array([[1e6 * YIELD, 0.0, 0.0]]))
    assert history[0, 0] == pytest.approx(1.0, abs=2e-9)
    assert 0 < traction[0, 0] < 1e-2 * CONCRETE.f_t


def test_no_contacts():
    law = CusatisCedolin.create(CONCRETE, np.empty(0))
    traction, _ = law.response(np.empty((0, 3)), law.initial_history())
    assert traction.shape == (0, 3)


def test_too_long_contact():
    """The message names the limit; here shear would soften as fast as tension."""
    limit = 7 / 9 * CONCRETE.alpha / (1 - CONCRETE.alpha) * 2 * CONCRETE.E * CONCRETE.G_t / CONCRETE.f_t**2
    with pytest.raises(InputError, match=f"{limit * 1e3:.4g} mm") as caught:
        CusatisCedolin.create(CONCRETE, np.array([0.01, 1.001 * limit]))
    law = CusatisCedolin.create(CONCRETE, np.array([0.999 * limit]))
    assert law.k_s[0] == pytest.approx(law.k_t[0], rel=0.01)
    assert caught.value.key == "discretization.l_f"
    assert caught.value.allowed


def test_limits_of_length_follow_the_theory():
    """``l_t = 2 E G_t / f_t^2`` and ``(16 alpha / 9) l_t`` with the default ratios."""
    limits = CusatisCedolin.limits(CONCRETE)
    assert limits["in tension"] == pytest.approx(2 * 60e9 * 35 / 2.2e6**2, rel=1e-14)
    assert limits["in shear"] == pytest.approx(16 * 0.29 / 9 * limits["in tension"], rel=1e-14)


def test_limits_are_where_softening_moduli_grow_without_bound():
    """``K_t -> infinity``: the softening branch becomes vertical in a contact of that length."""
    length = CusatisCedolin.limits(CONCRETE)["in tension"] * (1 - 1e-9)
    slope = 2 * CONCRETE.E * CONCRETE.G_t - CONCRETE.f_t**2 * length
    assert slope / (2 * CONCRETE.E * CONCRETE.G_t) == pytest.approx(1e-9, rel=1e-5)


def test_too_long_contact_when_tension_limits():
    material = dataclasses.replace(CONCRETE, alpha=0.9)
    limit = 2 * CONCRETE.E * CONCRETE.G_t / CONCRETE.f_t**2
    with pytest.raises(InputError, match=f"{limit * 1e3:.4g} mm"):
        CusatisCedolin.create(material, np.array([1.001 * limit]))
    CusatisCedolin.create(material, np.array([0.999 * limit]))


def test_compressive_cap_inside_the_shear_strength():
    with pytest.raises(InputError) as caught:
        transition_angle(dataclasses.replace(CONCRETE, f_c=2 * CONCRETE.f_t))
    assert caught.value.key == "material.f_c"


def test_shear_that_softens_faster_than_tension():
    with pytest.raises(InputError) as caught:
        CusatisCedolin.create(dataclasses.replace(CONCRETE, G_s=8 * CONCRETE.G_t), np.array([0.01]))
    assert caught.value.key == "material.G_s"


def test_law_of_a_case():
    assert law_from_case(beam()) is CusatisCedolin
    with pytest.raises(InputError, match="cusatis-cedolin") as caught:
        law_from_case(beam(material={"law": "rubber"}))
    assert caught.value.key == "material.law"


def test_material_with_many_other_constants_still_peaks_where_it_should():
    m = Material(45e9, 0.4, 3e6, 80.0, 7e6, 60e6, 900.0, 9e9, mu=0.3, beta=0.8, n_c=1.5)
    e = m.f_t / m.E
    traction, history = virgin(np.array([[e, 0, 0], [0, m.f_s / (m.alpha * m.E), 0]]), material=m)
    assert traction[0, 0] == pytest.approx(m.f_t, rel=1e-13)
    assert traction[1, 1] == pytest.approx(m.f_s, rel=1e-13)
    assert history[:, 0].max() < 1e-13


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"alpha": 1.0},
        {"f_s": 1.2 * CONCRETE.f_t},
        {"f_s": 0.9 * CONCRETE.f_t, "mu": 1.5},
        {"f_c": 1e7},
        {"mu": 0.05},
    ],
)
def test_lowest_strength_is_below_that_in_every_direction(changes):
    material = dataclasses.replace(CONCRETE, **changes)
    law = dataclasses.replace(law_of(20_001), material=material, omega0=transition_angle(material))
    strain = direction(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 20_001), material.alpha)
    strength = material.E / law.utilisation(strain)
    assert 0.5 * strength.min() < lowest_strength(material) < strength.min()


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_contacts_just_below_the_lowest_strength_answer_as_those_above(share):
    """One is answered without its strength, the other with it; neither is damaged anew."""
    rng = np.random.default_rng(5)
    omega = rng.uniform(0.1, 0.4, 200)  # far from tension, where the bound is far below the strength
    strain = share * lowest_strength(CONCRETE) / CONCRETE.E * direction(omega)
    law, history = law_of(200), np.zeros((200, 3))
    history[:, 0] = rng.uniform(size=200)
    traction, new = law.response(strain, history)
    np.testing.assert_array_equal(new[:, 0], history[:, 0])
    stiffness = (1.0 - history[:, :1]) * law.elastic
    np.testing.assert_allclose(traction, stiffness * strain, rtol=1e-14)
    np.testing.assert_allclose(law.tangent(strain, history), stiffness[:, :, None] * np.eye(3), rtol=1e-14)
