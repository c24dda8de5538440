"""Placement of nuclei: saturated, apart, inside, repeatable, in any specimen."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial import cKDTree

from fissura.specimen.assemble import complex_of
from fissura.specimen.shapes.prism import box
from fissura.tessellation.placement import place

from .build import L_F, SHAPES, SIZE, box_with, expected_count, farthest, nuclei_in, shape


@pytest.mark.parametrize("name", SHAPES)
def test_apart_and_inside(name):
    """Nuclei keep away from each other and from nothing else."""
    domain = shape(name)
    nuclei = nuclei_in(domain, 0)
    distance, _ = cKDTree(nuclei.x).query(nuclei.x, k=2)
    assert distance[:, 1].min() >= L_F * (1 - 1e-12)
    c = domain.complex
    for k in np.unique(nuclei.home):
        rows = slice(c.plane_start[k], c.plane_start[k + 1])
        assert (nuclei.x[nuclei.home == k] @ c.normal[rows].T - c.offset[rows]).max() <= 1e-15
    assert_array_equal(domain.cell_of(nuclei.x), nuclei.home)


@pytest.mark.parametrize("name", SHAPES)
def test_saturated(name):
    """No room for another nucleus, also at notches, corners and curved surfaces."""
    assert farthest(nuclei_in(shape(name), 1), shape(name)) <= 1.0 + 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", SHAPES)
def test_saturated_for_ten_seeds(name):
    for seed in range(10):
        assert farthest(nuclei_in(shape(name), seed), shape(name)) <= 1.0 + 1e-6


@given(st.integers(0, 2**32 - 1))
def test_saturated_boxes(seed):
    domain = box_with(size=(0.05, 0.04, 0.03))
    assert 0.9 < farthest(nuclei_in(domain, seed), domain) <= 1.0 + 1e-6


@pytest.mark.parametrize("size", [(0.1, 0.1, 0.1), (0.3, 0.1, 0.04), (0.4, 0.06, 0.05)], ids=["cube", "plate", "prism"])
def test_count(size):
    counts = [len(nuclei_in(box_with(size=size), seed)) for seed in range(4)]
    assert abs(np.mean(counts) / expected_count(size, L_F) - 1.0) < 0.02


def test_a_notch_does_not_change_the_nuclei():
    """Nothing is mirrored, and nothing keeps clear of a cut."""
    assert_array_equal(nuclei_in(shape("cut"), 3).x, nuclei_in(shape("none"), 3).x)


def test_convex_cells_do_not_change_the_nuclei():
    solid = box(SIZE)
    for normal, offset in (((1, 0, 0), 0.05), ((0.3, 1, 0), 0.04)):
        solid.split(solid.planes.find(np.array(normal, float), offset))
    cut, _ = complex_of(solid)
    x, home = place(cut, L_F, np.random.default_rng(3))
    assert_array_equal(x, nuclei_in(shape("none"), 3).x)
    assert len(np.unique(home)) == len(cut.low)


def test_where_it_lies_does_not_matter():
    """The same specimen moved: the same nuclei, moved."""
    c = shape("cylinder").complex
    shift = np.array([1.0, -2.0, 0.5])
    moved = c._replace(
        corner=c.corner + shift[:, None], offset=c.offset + c.normal @ shift, low=c.low + shift, high=c.high + shift
    )
    x, _ = place(moved, L_F, np.random.default_rng(3))
    assert_allclose(x - shift, nuclei_in(shape("cylinder"), 3).x, atol=1e-12)


def test_seed_decides():
    first, same, other = (nuclei_in(shape("saw"), seed) for seed in (7, 7, 8))
    for name in ("x", "home", "priority"):
        assert_array_equal(getattr(first, name), getattr(same, name))
    assert not np.isin(first.x[:, 0], other.x[:, 0]).any()


def test_priorities_are_ranks():
    nuclei = nuclei_in(shape("cut"), 0)
    assert_array_equal(np.sort(nuclei.priority), np.arange(len(nuclei)))


@pytest.mark.parametrize("name", ["none", "dog-bone", "cylinder"])
def test_given_nuclei_stay(name):
    domain = shape(name)
    given_x = nuclei_in(domain, 0, l_f=1.5 * L_F).x
    nuclei = nuclei_in(domain, 1, given=given_x)
    assert_array_equal(nuclei.x[: len(given_x)], given_x)
    assert len(nuclei) > 1.5 * len(given_x)
    assert farthest(nuclei, domain) <= 1.0 + 1e-6


def test_given_saturated_nuclei_stay_alone():
    first = nuclei_in(shape("saw"), 0)
    assert_array_equal(nuclei_in(shape("saw"), 1, given=first.x).x, first.x)


def test_given_nuclei_too_close_or_outside_are_left_out():
    kept, too_close = [0.02, 0.02, 0.02], [0.02 + 0.9 * L_F, 0.02, 0.02]
    in_the_cut, beside = [0.061, 0.01, 0.02], [0.0621, 0.02, 0.02]
    nuclei = nuclei_in(shape("saw"), 0, given=np.array([kept, too_close, in_the_cut, beside]))
    there = cKDTree(nuclei.x).query([kept, too_close, in_the_cut, beside])[0] == 0.0
    assert_array_equal(there, [True, False, False, True])


@pytest.mark.slow
def test_hundred_thousand_nuclei():
    size = (0.43, 0.43, 0.37)
    domain = box_with(size=size)
    nuclei = nuclei_in(domain, 0)
    assert len(nuclei) > 98_000
    assert abs(len(nuclei) / expected_count(size, L_F) - 1.0) < 0.02
    distance, _ = cKDTree(nuclei.x).query(nuclei.x, k=2)
    assert distance[:, 1].min() >= L_F * (1 - 1e-12)
    assert farthest(nuclei, domain) <= 1.0 + 1e-6
