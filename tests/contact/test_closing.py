"""The law with cracks that close: identities with the published law, energy, tangent."""

import itertools

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from equilibrium.models import CONCRETE
from fissura.contact import ClosingCusatisCedolin, CusatisCedolin

from .paths import LENGTH, PATHS, YIELD, answered, extrapolated, random_states, slopes

LAW = ClosingCusatisCedolin.create(CONCRETE, np.array([LENGTH]))
PUBLISHED = CusatisCedolin.create(CONCRETE, np.array([LENGTH]))


def followed(corners, parts):
    """Strains along straight pieces from the origin through the corners, with a point wherever one opens or closes."""
    points = np.concatenate([np.zeros((1, 3)), np.array(corners, float)]) * YIELD
    path = [points[:1]]
    for a, b in itertools.pairwise(points):
        share = np.arange(1, parts + 1) / parts
        if a[0] * b[0] < 0.0:
            share = np.sort(np.append(share, a[0] / (a[0] - b[0])))
        piece = a + share[:, None] * (b - a)
        piece[np.abs(piece[:, 0]) < 1e-12 * np.abs(points).max(), 0] = 0.0
        path.append(piece)
    return np.concatenate(path)


@settings(max_examples=60)
@given(PATHS)
def test_it_is_the_published_law_but_for_the_pressure(corners):
    """Damage, shear and whatever is open are the same, bit for bit; a pressed contact has its elastic pressure."""
    path = followed(corners, 10)
    (traction, history), (published, known) = answered(LAW, path), answered(PUBLISHED, path)
    np.testing.assert_array_equal(history[:, :3], known)
    np.testing.assert_array_equal(traction[:, 1:], published[:, 1:])
    pressed = path[:, 0] < 0.0
    np.testing.assert_array_equal(traction[~pressed, 0], published[~pressed, 0])
    np.testing.assert_array_equal(traction[pressed, 0], CONCRETE.E * path[pressed, 0])
    np.testing.assert_array_equal(LAW.damage(history), PUBLISHED.damage(known))


@settings(max_examples=60)
@given(PATHS)
def test_tractions_are_what_the_history_leaves(corners):
    path = followed(corners, 5)
    traction, history = answered(LAW, path)
    np.testing.assert_allclose(traction, LAW.intact(history) * LAW.elastic * path, rtol=1e-12, atol=1e-9)


@settings(max_examples=60)
@given(PATHS)
@example([(30.0, 0.0, 0.0), (-40.0, 0.0, 0.0), (30.0, 0.0, 0.0), (-5.0, 40.0, 0.0)])
@example([(5.0, 5.0, 0.0), (-5.0, 5.0, 0.0)] * 3)
def test_work_is_stored_or_dissipated_and_nothing_is_gained(corners):
    """Dissipated is what growing damage takes from the energy of opening and shear; pressure takes no part in it."""
    path = followed(corners, 60)
    traction, history = answered(LAW, path)
    before, after = slice(None, -1), slice(1, None)
    taken = np.maximum(path, [0.0, -np.inf, -np.inf])
    energy = 0.5 * (taken[before] * taken[after] * LAW.elastic).sum(axis=1)
    dissipated = energy * np.diff(history[:, 0])
    unit = CONCRETE.f_t * YIELD
    work = 0.5 * ((traction[before] + traction[after]) * np.diff(path, axis=0)).sum()
    stored = 0.5 * traction[-1] @ path[-1]
    assert work == pytest.approx(stored + dissipated.sum(), rel=1e-9, abs=1e-9 * unit)
    assert dissipated[energy >= 0.0].min(initial=0.0) >= 0.0


@settings(max_examples=40)
@given(PATHS, st.floats(-30.0, 30.0), st.floats(-30.0, 30.0))
def test_tractions_are_continuous_where_a_contact_closes(corners, e_m, e_l):
    _, history = answered(LAW, followed(corners, 5))
    tiny = 1e-9
    strain = np.array([[tiny, e_m, e_l], [-tiny, e_m, e_l]]) * YIELD
    ends = [LAW.response(row[None], history[-1:])[0][0] for row in strain]
    np.testing.assert_allclose(ends[0], ends[1], atol=20.0 * tiny * CONCRETE.f_t)


def test_a_cycle_that_closes_comes_back_to_the_envelope():
    top = np.array([[10.0, 3.0, 0.0]]) * YIELD
    _, history = LAW.response(top, LAW.initial_history())
    at_top, _ = LAW.response(top, history)
    for strain in ([[-3.0, 1.0, 0.0]], [[0.0, 0.0, 0.0]], [[-3.0, 0.0, 1.0]]):
        _, history = LAW.response(np.array(strain) * YIELD, history)
    again, _ = LAW.response(top, history)
    np.testing.assert_allclose(again, at_top, rtol=1e-14)


@pytest.mark.parametrize("known", [False, True])
def test_tangent_against_central_differences(known):
    rng = np.random.default_rng(12)
    law = ClosingCusatisCedolin.create(CONCRETE, np.full(3000, LENGTH))
    strain, history = random_states(law, rng, known=known)
    exact, coarse, fine, size = slopes(law, rng, strain, history)
    smooth = np.linalg.norm(coarse - fine, axis=1) < 1e-4 * size  # no kink in between
    grows = law.response(strain, history)[1][:, 0] > history[:, 0]
    assert (smooth & (strain[:, 0] < 0.0) & grows).sum() > 50
    assert (smooth & (strain[:, 0] > 0.0) & grows).sum() > 300
    assert smooth.mean() > 0.95
    error = np.linalg.norm(extrapolated(coarse, fine) - exact, axis=1) / size
    assert error[smooth].max() < 1e-5


def test_unloaded_history_knows_what_is_pressed_and_nothing_else():
    _, history = LAW.response(np.array([[10.0, 3.0, 0.0]]) * YIELD, LAW.initial_history())
    left = 1.0 - history[0, 0]
    closed = LAW.unloaded(np.array([[-1.0, 0.0, 0.0]]) * YIELD, history)
    np.testing.assert_array_equal(closed[:, :3], history[:, :3])
    np.testing.assert_array_equal(LAW.intact(closed), [[1.0, left, left]])
    np.testing.assert_array_equal(LAW.unloaded(np.array([[1.0, 0.0, 0.0]]) * YIELD, closed), history)
    np.testing.assert_array_equal(LAW.intact(history), [[left, left, left]])
