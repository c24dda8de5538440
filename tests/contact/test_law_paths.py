"""The contact law along random paths, and its tangent."""

import itertools

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from equilibrium.models import CONCRETE
from fissura.contact import CusatisCedolin

from .paths import LENGTH, PATHS, YIELD, answered, extrapolated, random_states, slopes

LAW = CusatisCedolin.create(CONCRETE, np.array([LENGTH]))


def followed(corners, parts=60):
    """Strains along straight pieces from the origin through the corners."""
    points = np.concatenate([np.zeros((1, 3)), np.array(corners, float)]) * YIELD
    share = np.arange(1, parts + 1)[:, None] / parts
    pieces = [a + share * (b - a) for a, b in itertools.pairwise(points)]
    return np.concatenate([np.zeros((1, 3)), *pieces])


@settings(deadline=None, max_examples=60, derandomize=True)
@given(PATHS)
@example([(30.0, 0.0, 0.0), (-40.0, 0.0, 0.0), (0.0, 40.0, 0.0)])
@example([(0.0, 40.0, 0.0), (0.0, -40.0, 0.0), (5.0, 0.0, 0.0)])
def test_damage_only_grows_and_energy_is_never_gained(corners):
    path = followed(corners)
    traction, history = answered(LAW, path)
    assert (np.diff(history, axis=0) >= 0).all()
    assert (history[:, 0] >= 0).all()
    assert (history[:, 0] < 1).all()
    before, after = slice(None, -1), slice(1, None)
    loss = 0.5 * (
        (traction[before] * path[after]).sum(axis=1) - (traction[after] * path[before]).sum(axis=1)
    )  # dissipated per volume in each small step
    unit = CONCRETE.f_t * YIELD
    same_way = (path[before] * path[after] * LAW.elastic).sum(axis=1) >= 0
    assert loss[same_way].min(initial=0.0) >= -1e-11 * unit
    # Work by the trapezoidal rule, less what is stored: the same number, so no energy is created.
    work = 0.5 * ((traction[before] + traction[after]) * np.diff(path, axis=0)).sum()
    stored = 0.5 * traction[-1] @ path[-1]
    assert work - stored == pytest.approx(loss.sum(), rel=1e-9, abs=1e-9 * unit)


@settings(deadline=None, max_examples=60, derandomize=True)
@given(PATHS)
def test_tractions_stay_along_the_strain_and_inside_the_elastic_ones(corners):
    path = followed(corners, parts=3)
    traction, history = answered(LAW, path)
    np.testing.assert_allclose(traction, (1 - history[:, :1]) * LAW.elastic * path, rtol=1e-12, atol=1e-9)


@settings(deadline=None, max_examples=40, derandomize=True)
@given(st.lists(st.floats(0.0, 60.0), min_size=2, max_size=8))
def test_tension_depends_on_the_largest_strain_alone(values):
    path = np.zeros((len(values), 3))
    path[:, 0] = np.array(values) * YIELD
    traction, history = answered(LAW, path)
    top = np.array([[path[:, 0].max(), 0.0, 0.0]])
    once, state = LAW.response(top, LAW.initial_history())
    assert history[-1, 0] == pytest.approx(state[0, 0], abs=1e-14)
    assert traction[-1, 0] * top[0, 0] == pytest.approx(once[0, 0] * path[-1, 0], rel=1e-12, abs=1e-12)


def away_from_kinks(law, strain, history):
    """Contacts whose answer is smooth near these strains."""
    e_t = np.hypot(strain[:, 1], strain[:, 2])
    omega = np.arctan2(strain[:, 0], np.sqrt(CONCRETE.alpha) * e_t)
    good = (np.abs(omega) > 1e-3) & (np.abs(omega - law.omega0) > 1e-3)
    for value, top in ((strain[:, 0], history[:, 1]), (e_t, history[:, 2])):
        good &= np.abs(value - top) > 1e-3 * np.abs(value)
    damage = np.stack([law.response(f * strain, history)[1][:, 0] for f in (0.999, 1.0, 1.001)])
    grows = damage > history[:, 0] + 1e-12
    return good & (grows.all(axis=0) | ~grows.any(axis=0)) & (damage.max(axis=0) < 1 - 1e-8), grows[1]


@pytest.mark.parametrize("known", [False, True])
def test_tangent_against_central_differences(known):
    rng = np.random.default_rng(12)
    law = CusatisCedolin.create(CONCRETE, np.full(3000, LENGTH))
    strain, history = random_states(law, rng, known=known)
    smooth, grows = away_from_kinks(law, strain, history)
    assert (smooth & grows).sum() > 300
    assert (smooth & ~grows).sum() > 100
    exact, coarse, fine, size = slopes(law, rng, strain, history)
    error = np.linalg.norm(extrapolated(coarse, fine) - exact, axis=1) / size
    assert error[smooth].max() < 1e-6


@pytest.mark.parametrize(
    "strain", [(5.0, 0.0, 0.0), (0.5, 0.0, 0.0), (-30.0, 0.0, 0.0)], ids=["softening", "elastic", "hardening"]
)
def test_tangent_along_the_normal_axis(strain):
    strain = np.array([strain]) * YIELD
    h = 1e-6 * YIELD
    step = np.array([[h, 0.0, 0.0]])
    plus, _ = LAW.response(strain + step, LAW.initial_history())
    minus, _ = LAW.response(strain - step, LAW.initial_history())
    tangent = LAW.tangent(strain, LAW.initial_history())[0]
    np.testing.assert_allclose(tangent[:, 0], (plus - minus)[0] / (2 * h), rtol=1e-6, atol=1e-6 * CONCRETE.E)


def test_tangent_of_unloading_is_the_secant():
    strain = np.array([[6.0, 4.0, -2.0]]) * YIELD
    _, history = LAW.response(strain, LAW.initial_history())
    tangent = LAW.tangent(0.5 * strain, history)[0]
    np.testing.assert_allclose(tangent, (1 - history[0, 0]) * np.diag(LAW.elastic), rtol=1e-12)
