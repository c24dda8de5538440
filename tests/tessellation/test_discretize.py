"""Tessellations keep every exact identity, for all notches and all resolutions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from fissura.errors import InputError
from fissura.tessellation import discretize, tessellate

from .build import L_F, NOTCHES, SIZE, box_with, discretized, nuclei_in, region
from .exact import check_all, check_closed, check_contacts, check_surface, check_volumes, check_voronoi


@pytest.mark.parametrize("notches", NOTCHES.values(), ids=NOTCHES)
@pytest.mark.parametrize("seed", [0, 1])
def test_full_resolution(notches, seed):
    box = box_with(*notches)
    nuclei = nuclei_in(box, seed)
    t = discretized(nuclei, box, region(box, everywhere=True))
    assert_array_equal(t.nucleus, np.arange(len(nuclei)))
    assert t.fine.all()
    assert t.contacts.fine.all()
    check_all(t, box)


@pytest.mark.parametrize("notches", NOTCHES.values(), ids=NOTCHES)
@pytest.mark.parametrize("centers", [(), [(0.02, 0.05, 0.01)]], ids=["tips", "tips and ball"])
def test_graded(notches, centers):
    box = box_with(*notches)
    nuclei = nuclei_in(box, 2)
    t = discretized(nuclei, box, region(box, centers))
    assert len(t) < len(nuclei)
    assert_array_equal(t.x, nuclei.x[t.nucleus])
    if box.notches or centers:
        assert t.fine.any()
        assert not t.fine.all()
    check_all(t, box)


seeds = st.integers(0, 2**32 - 1)
depths = st.floats(0.002, 0.055)
widths = st.one_of(st.just(0.0), st.floats(1e-6, 0.03))
positions = st.floats(0.035, 0.085)
points = st.tuples(*(st.floats(0.0, side) for side in SIZE))


@given(seeds, depths, widths, positions, st.lists(points, max_size=3))
def test_any_bottom_notch(seed, depth, width, position, centers):
    box = box_with({"position": position, "depth": depth, "width": width})
    nuclei = nuclei_in(box, seed)
    check_all(discretized(nuclei, box, region(box, centers)), box)


@given(seeds, st.floats(0.0, 3.0), st.lists(points, max_size=2))
def test_any_spacing(seed, coarse, centers):
    """Also where spacing jumps without a ramp, and where a few bodies fill the specimen."""
    box = box_with()
    nuclei = nuclei_in(box, seed)
    spacing = np.full(len(nuclei), L_F * (1.0 + 5.0 * coarse))
    for center in centers:
        spacing[np.linalg.norm(nuclei.x - center, axis=1) < 0.02] = 0.0
    check_all(discretize(nuclei, box, spacing), box)


def test_one_body_is_the_box():
    box = box_with()
    t = tessellate(np.array([[0.01, 0.05, 0.03]]), box, np.array([0.2]))
    assert len(t.contacts) == 0
    assert_allclose(t.volume, [np.prod(SIZE)], rtol=1e-14)
    areas = np.bincount(t.surface.surface, t.surface.area)
    assert_allclose(areas, [0.0024, 0.0024, 0.0048, 0.0048, 0.0072, 0.0072], rtol=1e-12)


def test_two_bodies_by_hand():
    box = box_with()
    t = tessellate(np.array([[0.02, 0.03, 0.02], [0.06, 0.03, 0.02]]), box, np.full(2, 0.1))
    assert_allclose(t.volume, [0.04 * 0.0024, 0.08 * 0.0024], rtol=1e-12)
    c = t.contacts
    assert_array_equal(c.bodies, [[0, 1]])
    assert_allclose(c.area, [0.0024], rtol=1e-12)
    assert_allclose(c.centroid, [[0.04, 0.03, 0.02]], rtol=1e-12)
    assert_allclose(c.length, [0.04], rtol=1e-12)
    assert_allclose(c.normal, [[1.0, 0.0, 0.0]], atol=1e-12)


@pytest.mark.parametrize("guess", [1e-4, 1.0])
def test_spacing_is_only_a_guess(guess):
    """Which nuclei are reflected at the first try must not matter."""
    box = box_with(*NOTCHES["cut"])
    nuclei = nuclei_in(box, 4)
    t = tessellate(nuclei.x, box, np.full(len(nuclei), L_F))
    again = tessellate(nuclei.x, box, np.full(len(nuclei), guess * L_F))
    check_volumes(again, box)
    check_closed(again)
    assert_allclose(again.volume, t.volume, rtol=1e-9)


@pytest.mark.parametrize("width", [0.0, 0.004])
def test_notched_pair_by_hand(width):
    """Two mirrored bodies: one contact over the ligament, walls below."""
    box = box_with({"position": 0.06, "depth": 0.02, "width": width})
    t = tessellate(np.array([[0.03, 0.03, 0.02], [0.09, 0.03, 0.02]]), box, np.full(2, 0.1))
    assert_allclose(t.contacts.area, [0.04 * 0.04], rtol=1e-12)
    assert_allclose(t.contacts.centroid, [[0.06, 0.04, 0.02]], rtol=1e-12)
    assert_allclose(t.volume, [0.5 * box.volume] * 2, rtol=1e-12)
    walls = t.surface.surface == t.surface.names.index("notch")
    assert_allclose(t.surface.area[walls].sum(), 0.04 * (0.04 + width), rtol=1e-12)


@pytest.mark.parametrize("jitter", [0.0, 1e-13, 1e-9, 1e-5])
def test_lattices_of_nuclei(jitter):
    """Regular nuclei make every Voronoi corner degenerate."""
    axes = [np.arange(0.005, side, 0.01) for side in SIZE]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    x = x + jitter * np.random.default_rng(0).uniform(-1, 1, x.shape)
    box = box_with()
    t = tessellate(x, box, np.full(len(x), 0.01))
    check_volumes(t, box)
    check_closed(t)
    check_contacts(t)
    check_surface(t, box)
    check_voronoi(t)
    assert_allclose(t.volume, 1e-6, rtol=1e-9 + 600 * jitter)


@pytest.mark.parametrize("width", [0.0, 0.004])
def test_bodies_across_a_notch(width):
    """Without mirrored twins a body may hold the two sides of a notch together: refused, with the key."""
    box = box_with({"position": 0.06, "depth": 0.02, "width": width})
    with pytest.raises(InputError, match="across the notch") as caught:
        tessellate(np.array([[0.02, 0.03, 0.02], [0.061, 0.04, 0.02], [0.1, 0.03, 0.02]]), box, np.full(3, 0.03))
    assert caught.value.key == "discretization.l_c"


def test_notch_at_the_end_of_the_specimen():
    """No pair fits between the notch and the end."""
    box = box_with({"position": 0.003, "depth": 0.03})
    with pytest.raises(InputError) as caught:
        discretized(nuclei_in(box, 0), box, region(box, everywhere=True))
    assert caught.value.key == "discretization.l_c"


def test_renumbering_the_nuclei_changes_nothing_but_numbers():
    box = box_with(*NOTCHES["saw"])
    nuclei = nuclei_in(box, 3)
    order = np.random.default_rng(0).permutation(len(nuclei))
    spacing = np.full(len(nuclei), L_F)
    a, b = tessellate(nuclei.x, box, spacing), tessellate(nuclei.x[order], box, spacing)
    assert_allclose(a.volume[order], b.volume, rtol=1e-9)
    pairs_a, pairs_b = np.sort(a.contacts.bodies, axis=1), np.sort(order[b.contacts.bodies], axis=1)
    sort_a, sort_b = np.lexsort(pairs_a.T), np.lexsort(pairs_b.T)
    large = a.contacts.area[sort_a] > 1e-9 * L_F**2
    large_b = b.contacts.area[sort_b] > 1e-9 * L_F**2
    assert_array_equal(pairs_a[sort_a][large], pairs_b[sort_b][large_b])
    assert_allclose(a.contacts.area[sort_a][large], b.contacts.area[sort_b][large_b], rtol=1e-6)


def test_bulk_statistics():
    """About 15 contacts per inner body at saturation (theory section 1)."""
    box = box_with(size=(0.1, 0.1, 0.1))
    t = discretized(nuclei_in(box, 5), box, region(box, everywhere=True))
    inner = np.ones(len(t), bool)
    inner[t.surface.body] = False
    neighbours = np.bincount(t.contacts.bodies.ravel(), minlength=len(t))
    assert 14.3 < neighbours[inner].mean() < 15.7
    between = inner[t.contacts.bodies].all(axis=1)
    weighted = np.average(t.contacts.length[between], weights=t.contacts.area[between]) / L_F
    assert 1.15 < weighted < 1.3
