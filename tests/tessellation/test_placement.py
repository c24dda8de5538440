"""Placement of nuclei: saturated, apart, mirrored along notches, repeatable."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from scipy.spatial import cKDTree

from fissura.errors import InputError
from fissura.tessellation import discretize, expected_count, mirror_zones, placement

from .build import L_F, NOTCHES, box_with, nuclei_in


def nearest_of_corners(nuclei, box):
    """Corners of all cells, where the distance to the nearest nucleus is largest, and that distance in spacings."""
    t = discretize(nuclei, box, np.zeros(len(nuclei)))
    corners = np.concatenate([t.contacts.polygons.points, t.surface.polygons.points])
    return corners, cKDTree(nuclei.x).query(corners)[0] / nuclei.spacing


@pytest.mark.parametrize("notches", NOTCHES.values(), ids=NOTCHES)
def test_apart_everywhere(notches):
    """Mirrored twins included."""
    nuclei = nuclei_in(box_with(*notches), 0)
    distance, _ = cKDTree(nuclei.x).query(nuclei.x, k=2)
    assert distance[:, 1].min() >= L_F * (1 - 1e-12)


@pytest.mark.parametrize("notches", NOTCHES.values(), ids=NOTCHES)
def test_saturated(notches):
    """No room for another nucleus: 1 spacing, and 1.5 where pairs keep clear of a notch plane."""
    box = box_with(*notches)
    corners, distance = nearest_of_corners(nuclei_in(box, 1), box)
    zone = mirror_zones(box, L_F).zone_of(corners)
    assert distance[zone < 0].max() <= 1.0 + 1e-6
    assert distance.max() <= 1.5


@given(st.integers(0, 2**32 - 1))
def test_saturated_without_notch(seed):
    box = box_with(size=(0.05, 0.04, 0.03))
    _, distance = nearest_of_corners(nuclei_in(box, seed), box)
    assert 0.9 < distance.max() <= 1.0 + 1e-6


@pytest.mark.parametrize("size", [(0.1, 0.1, 0.1), (0.3, 0.1, 0.04), (0.4, 0.06, 0.05)], ids=["cube", "plate", "prism"])
def test_count(size):
    counts = [len(nuclei_in(box_with(size=size), seed)) for seed in range(4)]
    assert abs(np.mean(counts) / expected_count(size, L_F) - 1.0) < 0.02


def test_expected_count():
    assert expected_count((1.0, 2.0, 3.0), 0.5) == pytest.approx(0.734 * 2.6 * 4.6 * 6.6, rel=1e-12)


def test_seed_decides():
    box = box_with(*NOTCHES["saw"])
    first, same, other = nuclei_in(box, 7), nuclei_in(box, 7), nuclei_in(box, 8)
    for name in ("x", "priority", "twin"):
        assert_array_equal(getattr(first, name), getattr(same, name))
    assert not np.isin(first.x[:, 0], other.x[:, 0]).any()


@pytest.mark.parametrize("name", [name for name in NOTCHES if name != "none"])
def test_twins_are_mirror_images(name):
    box = box_with(*NOTCHES[name])
    nuclei = nuclei_in(box, 2)
    zones = mirror_zones(box, L_F)
    paired = np.flatnonzero(nuclei.twin >= 0)
    assert len(paired)
    assert_array_equal(paired, np.flatnonzero(zones.zone_of(nuclei.x) >= 0))
    twin = nuclei.twin[paired]
    assert_array_equal(nuclei.twin[twin], paired)
    assert (twin != paired).all()
    np.testing.assert_allclose(nuclei.x[twin], zones.mirrored(nuclei.x[paired]), atol=1e-16, rtol=1e-15)
    assert_array_equal(nuclei.priority[twin], nuclei.priority[paired])
    for notch in box.notches:
        zone = nuclei.x[paired, notch.normal] - notch.position
        assert np.abs(zone).min() >= 0.5 * L_F * (1 - 1e-12)


def test_priorities_are_ranks():
    """Distinct among singles and pairs."""
    nuclei = nuclei_in(box_with(*NOTCHES["cut"]), 0)
    singles = nuclei.priority[nuclei.twin < 0]
    pairs = nuclei.priority[nuclei.twin > np.arange(len(nuclei))]
    together = np.concatenate([singles, pairs])
    assert len(np.unique(together)) == len(together)
    assert together.min() == 0
    assert together.max() < len(nuclei)


@pytest.mark.parametrize("name", ["saw", "wide", "left saw", "top saw", "back saw along y", "double edge"])
def test_none_in_a_saw_cut(name):
    box = box_with(*NOTCHES[name])
    for seed in range(3):
        x = nuclei_in(box, seed).x
        assert box.contains(x).all()


def test_wide_saw_cut_is_saturated_at_its_root():
    """The strip without nuclei above the root is half a spacing wide on either side, however wide the cut."""
    box = box_with({"position": 0.06, "depth": 0.03, "width": 0.03})
    for seed in range(3):
        _, distance = nearest_of_corners(nuclei_in(box, seed), box)
        assert distance.max() <= 1.5


def test_given_nuclei_stay():
    box = box_with()
    given_x = nuclei_in(box, 0, l_f=1.5 * L_F).x
    nuclei = nuclei_in(box, 1, given=given_x)
    assert_array_equal(nuclei.x[: len(given_x)], given_x)
    assert len(nuclei) > 1.5 * len(given_x)
    _, distance = nearest_of_corners(nuclei, box)
    assert distance.max() <= 1.0 + 1e-6


def test_given_saturated_nuclei_stay_alone():
    box = box_with()
    first = nuclei_in(box, 0)
    assert_array_equal(nuclei_in(box, 1, given=first.x).x, first.x)


def test_given_nuclei_too_close_are_left_out():
    box = box_with(*NOTCHES["saw"])
    kept, too_close = [0.02, 0.02, 0.02], [0.02 + 0.9 * L_F, 0.02, 0.02]
    at_the_plane, in_the_cut, beside = [0.061, 0.035, 0.02], [0.061, 0.01, 0.02], [0.067, 0.02, 0.02]
    nuclei = nuclei_in(box, 0, given=np.array([kept, too_close, at_the_plane, in_the_cut, beside]))
    there = cKDTree(nuclei.x).query([kept, too_close, at_the_plane, in_the_cut, beside])[0] == 0.0
    assert_array_equal(there, [True, False, False, False, True])
    assert cKDTree(nuclei.x).query([0.053, 0.02, 0.02])[0] < 1e-15  # the mirror image of the last


@pytest.mark.parametrize("name", ["cut", "saw", "top"])
def test_zones_mirror_themselves(name):
    box = box_with(*NOTCHES[name])
    zones = mirror_zones(box, L_F)
    x = np.random.default_rng(0).uniform(0.0, 1.0, (500, 3)) * box.size
    image = zones.mirrored(x)
    np.testing.assert_allclose(zones.mirrored(image), x, atol=1e-16)
    assert_array_equal(zones.zone_of(image), zones.zone_of(x))
    outside = zones.zone_of(x) < 0
    assert_array_equal(image[outside], x[outside])
    assert not outside.all()
    assert (image[~outside, 0] != x[~outside, 0]).all()


@pytest.mark.parametrize("depth", [0.01, 0.018, 0.02], ids=["apart", "touching", "overlapping"])
def test_zones_of_opposite_notches(depth, monkeypatch):
    """Between opposite notches no space stays open for ever: nine halvings of the voxels leave next to nothing."""
    box = box_with({"position": 0.06, "depth": depth}, {"face": "top", "position": 0.06, "depth": depth})
    left, original = [], placement._place

    def watched(*arguments):
        result = original(*arguments)
        left.append(result[2])
        return result

    monkeypatch.setattr(placement, "_MAX_LEVEL", 9)
    monkeypatch.setattr(placement, "_place", watched)
    nuclei_in(box, 0)
    assert left[0] < 1000


@pytest.mark.parametrize(
    "second",
    [{"position": 0.1, "depth": 0.02}, {"face": "left", "position": 0.02, "depth": 0.05}],
    ids=["parallel", "crossing"],
)
def test_zones_in_different_planes_must_not_overlap(second):
    with pytest.raises(InputError, match=r"too close to notch\[0\]") as caught:
        mirror_zones(box_with({"position": 0.06, "depth": 0.03}, second), L_F)
    assert caught.value.key == "notch[1].position"


def test_zones_far_apart():
    box = box_with({"position": 0.06, "depth": 0.03}, {"position": 0.18, "depth": 0.02}, size=(0.24, 0.06, 0.04))
    zones = mirror_zones(box, L_F)
    np.testing.assert_allclose(zones.plane, [0.06, 0.18])
    np.testing.assert_allclose(zones.lower[:, 0], [0.06 - 6 * L_F, 0.18 - 6 * L_F])
    np.testing.assert_allclose(zones.upper[:, 0], [0.06 + 6 * L_F, 0.18 + 6 * L_F])
    np.testing.assert_allclose(zones.upper[:, 1], [0.03 + 1.5 * L_F, 0.02 + 1.5 * L_F])


@pytest.mark.slow
def test_hundred_thousand_nuclei():
    size = (0.43, 0.43, 0.37)
    box = box_with(size=size)
    nuclei = nuclei_in(box, 0)
    assert len(nuclei) > 98_000
    assert abs(len(nuclei) / expected_count(size, L_F) - 1.0) < 0.02
    distance, _ = cKDTree(nuclei.x).query(nuclei.x, k=2)
    assert distance[:, 1].min() >= L_F * (1 - 1e-12)
    _, farthest = nearest_of_corners(nuclei, box)
    assert farthest.max() <= 1.0 + 1e-6
