"""Notches: closed faces or removed volume, and rules of sides behind their tips."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fissura.errors import InputError
from fissura.specimen.assemble import complex_of
from fissura.specimen.cutting import cut_notches
from fissura.specimen.domain import Domain
from fissura.specimen.notches import Slot
from fissura.specimen.shapes.prism import box, box_half_spaces, prism_half_spaces
from fissura.specimen.solid import Solid

from .complexes import check, volume
from .test_solid import areas, ring

SIZE = np.array([0.12, 0.06, 0.04])
X, Y, Z = np.eye(3)


def slot(at, direction, along, depth, width=0.0):
    return Slot(np.asarray(at, float), np.asarray(direction, float), np.asarray(along, float), depth, width)


def notched(solid, *slots):
    notches = cut_notches(solid, slots)
    cx, surfaces = complex_of(solid)
    check(cx)
    found = Domain(cx, surfaces, notches)
    assert_allclose(volume(cx), found.volume, rtol=1e-12)
    return found


def rules(found, k):
    cx = found.complex
    rows = slice(cx.rule_start[k], cx.rule_start[k + 1])
    return cx.rule_normal[rows], cx.rule_offset[rows]


def middle(found, k):
    a, b = found.complex.corner_start[k : k + 2]
    return found.complex.corner[:, a:b].mean(axis=1)


def check_rules(found, box_like=True):
    """A cell obeys its own rules; behind the tip of a notch it has that notch's, ahead of it not."""
    for k in range(len(found.complex.low)):
        normal, offset = rules(found, k)
        x = middle(found, k)
        assert (normal @ x > offset).all()
        for notch in found.notches:
            mine = (np.abs(normal @ notch.normal) > 1 - 1e-12) & np.isclose(
                np.abs(offset), abs(notch.normal @ notch.point), atol=1e-12
            )
            assert mine.sum() <= 1
            if notch.ahead(x) <= 0:
                assert mine.any() or not box_like
            elif not any(n.ahead(x) <= 0 for n in found.notches if abs(n.normal @ notch.normal) > 0.99):
                assert not mine.any()


@pytest.mark.parametrize("along", [Z, [0.0, 0.3, 1.0]], ids=["straight", "oblique front"])
@pytest.mark.parametrize("direction", [Y, [0.5, 1.0, 0.0], [-0.2, 1.0, 0.1]], ids=["upright", "inclined", "skew"])
@pytest.mark.parametrize("width", [0.0, 0.004])
def test_box_in_three_parts(direction, along, width):
    at = np.array([0.06, 0.0, 0.02])
    found = notched(box(SIZE), slot(at, direction, along, 0.02, width))
    cx = found.complex
    (notch,) = found.notches
    direction = np.asarray(direction) / np.linalg.norm(direction)
    assert_allclose(notch.point, at + 0.02 * direction, rtol=1e-14)
    assert abs(notch.direction @ along) < 1e-14
    assert abs(notch.normal @ notch.direction) < 1e-14
    assert notch.direction @ direction > 0.9
    assert_allclose(notch.front[:, 2], [0.0, SIZE[2]], atol=1e-14)
    assert len(cx.low) == 3
    assert len(cx.rule_offset) == 2
    check_rules(found)
    # The removed volume is the width times the area of the notch: half of its two walls, the root taken off.
    root = width * np.linalg.norm(np.diff(found.notches[0].front, axis=0))
    wall = 0.5 * (areas(found)["notch"] - root)
    assert_allclose(found.volume, SIZE.prod() - width * wall, rtol=1e-12)
    # Behind the tip nothing leads from one side to the other; both lead ahead.
    for k in range(3):
        rows = slice(cx.part_start[cx.plane_start[k]], cx.part_start[cx.plane_start[k + 1]])
        to = cx.part_to[rows]
        ahead = notch.ahead(middle(found, k)) > 0
        assert sorted(to[to >= 0]) == ([j for j in range(3) if j != k] if ahead else [0])


def test_points_beside_the_notch():
    found = notched(box(SIZE), slot([0.06, 0.0, 0.0], Y, Z, 0.02, 0.004))
    e = 1e-9
    x = np.array([[0.06, 0.01, 0.01], [0.058 + e, 0.01, 0.01], [0.058 - e, 0.01, 0.01], [0.06, 0.02 + e, 0.01]])
    assert_array_equal(found.contains(x), [False, False, True, True])
    lines = found.notches[0].tip_lines()
    assert_allclose(np.sort(lines[:, 0, 0]), [0.058, 0.062])
    assert_allclose(lines[:, :, 1], 0.02)
    assert lines.shape == (2, 2, 3)


def test_notches_of_the_same_plane():
    found = notched(box(SIZE), slot([0.06, 0, 0], Y, Z, 0.02), slot([0.06, 0.06, 0], -Y, Z, 0.015))
    assert areas(found)["notch"] == pytest.approx(2 * 0.035 * 0.04, rel=1e-12)
    check_rules(found)
    assert len(found.complex.low) == 5


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 2, 0)])
def test_notches_side_by_side(order):
    """Behind all tips, whatever the order, only nuclei between the same notches may own material."""
    slots = [slot([0.03, 0, 0], Y, Z, 0.03), slot([0.06, 0, 0], Y, Z, 0.02), slot([0.09, 0, 0], Y, Z, 0.03, 0.002)]
    found = notched(box(SIZE), *(slots[k] for k in order))
    check_rules(found, box_like=False)
    assert_allclose(found.volume, SIZE.prod() - 0.03 * 0.002 * 0.04, rtol=1e-12)
    x = np.random.default_rng(0).uniform(0, SIZE, (3000, 3))
    nuclei = np.random.default_rng(1).uniform(0, SIZE, (50, 3))
    cells = found.cell_of(x)
    between = np.searchsorted([0.03, 0.06, 0.09], x[:, 0])
    for k in range(len(found.complex.low)):
        normal, offset = rules(found, k)
        admitted = (nuclei @ normal.T > offset).all(axis=1)
        deep = x[cells == k]
        if len(deep) and (deep[:, 1] < 0.02).all():
            place = int(between[cells == k][0])
            assert_array_equal(admitted, np.searchsorted([0.03, 0.06, 0.09], nuclei[:, 0]) == place)


@pytest.mark.parametrize("width", [0.0, 0.004])
def test_crossing(width):
    found = notched(
        box([0.1, 0.1, 0.1]), slot([0.05, 0, 0.05], Y, X, 0.03, width), slot([0.05, 0, 0.05], Y, Z, 0.02, width)
    )
    assert_allclose(found.volume, 1e-3 - width * 0.1 * 0.05 + width**2 * 0.02, rtol=1e-12)
    check_rules(found)
    quarters = [k for k in range(len(found.complex.low)) if middle(found, k)[1] < 0.02]
    assert len(quarters) == 4
    assert all(len(rules(found, k)[1]) == 2 for k in quarters)


def test_only_what_hangs_together_with_the_mouth():
    """A U: the plane of a notch in one leg meets the other leg, which stays whole."""
    solid = Solid([0.0] * 3, [0.3, 0.3, 0.1])
    solid.add(box_half_spaces([0, 0.2, 0], [0.3, 0.3, 0.1]), ["a"] * 6)
    solid.add(box_half_spaces([0, 0, 0], [0.1, 0.2, 0.1]), ["a"] * 6)
    solid.add(box_half_spaces([0.2, 0, 0], [0.3, 0.2, 0.1]), ["a"] * 6)
    found = notched(solid, slot([0.0, 0.1, 0.0], X, Z, 0.04, 0.01))
    assert_allclose(found.volume, 0.003 + 0.004 - 0.00004, rtol=1e-12)
    assert areas(found)["notch"] == pytest.approx(0.1 * (2 * 0.04 + 0.01), rel=1e-12)
    ruled = [k for k in range(len(found.complex.low)) if len(rules(found, k)[1])]
    assert len(ruled) >= 2
    assert all(middle(found, k)[0] < 0.04 for k in ruled)


@pytest.mark.parametrize("width", [0.0, 0.002])
def test_from_a_hole(width):
    """Behind the hole the plane of the notch meets material again: no rule there."""
    solid = box([0.2, 0.2, 0.05])
    solid.minus(prism_half_spaces(ring(0.03, 16, (0.1, 0.1)), -1.0, 1.0), ["hole"] * 18)
    whole = Domain(*complex_of(solid)).volume
    mouth = 0.1 + 0.03 * np.cos(np.pi / 16)
    found = notched(solid, slot([mouth, 0.1, 0.0], X, Z, 0.02, width))
    assert_allclose(found.volume, whole - width * 0.02 * 0.05, rtol=1e-12)
    assert areas(found)["notch"] == pytest.approx(0.05 * (2 * 0.02 + width), rel=1e-9)
    assert len(found.complex.rule_offset) > 0
    for k in range(len(found.complex.low)):
        if len(rules(found, k)[1]):
            assert found.complex.low[k, 0] >= mouth - 1e-12
            assert found.complex.high[k, 0] <= mouth + 0.02 + 1e-12
    # All of the slab between mouth and tip has it.
    x = np.array([[mouth + 0.01, 0.03, 0.02], [mouth + 0.01, 0.17, 0.02], [mouth + 0.01, 0.101, 0.02]])
    assert all(len(rules(found, k)[1]) == 1 for k in found.cell_of(x))


def test_starter_notch_in_a_groove():
    solid = box([0.2, 0.2, 0.1])
    solid.minus(box_half_spaces([0.085, 0.17, -1], [0.115, 1, 1]), ["groove"] * 6)
    found = notched(solid, slot([0.1, 0.17, 0.0], -Y, Z, 0.05))
    assert_allclose(found.volume, 0.004 - 0.03 * 0.03 * 0.1, rtol=1e-12)
    assert areas(found) == pytest.approx(areas(found) | {"notch": 2 * 0.05 * 0.1, "groove": 0.1 * 0.09})
    assert_allclose(found.notches[0].front, [[0.1, 0.12, 0.0], [0.1, 0.12, 0.1]], atol=1e-14)


def test_plane_between_two_cells():
    """The plane of the notch is one that already divides the specimen."""
    for width in (0.0, 0.004):
        solid = box(SIZE)
        solid.split(solid.planes.find(X, 0.06))
        found = notched(solid, slot([0.06, 0, 0], Y, Z, 0.02, width))
        assert areas(found)["notch"] == pytest.approx(0.04 * (2 * 0.02 + width), rel=1e-12)
        check_rules(found)
        assert_allclose(found.volume, SIZE.prod() - width * 0.02 * 0.04, rtol=1e-12)


def test_tip_at_a_plane_of_the_solid():
    for width in (0.0, 0.004):
        solid = box(SIZE)
        solid.split(solid.planes.find(Y, 0.02))
        found = notched(solid, slot([0.06, 0, 0], Y, Z, 0.02, width))
        assert len(found.complex.low) == 3
        assert areas(found)["notch"] == pytest.approx(0.04 * (2 * 0.02 + width), rel=1e-12)
        check_rules(found)


@pytest.mark.parametrize(
    ("given", "key"),
    [
        (slot([0.06, 0, 0], Y, Z, 0.06), "notch.depth"),
        (slot([0.06, 0, 0], Y, Z, 0.5), "notch.depth"),
        (slot([0.06, 0, 0], -Y, Z, 0.01), "notch.at"),
        (slot([0.2, 0, 0], Y, Z, 0.01), "notch.at"),
        (slot([0.06, -0.01, 0], Y, Z, 0.02), "notch.at"),
    ],
)
def test_notches_that_do_not_fit(given, key):
    with pytest.raises(InputError) as caught:
        cut_notches(box(SIZE), [given])
    assert caught.value.key == key
    assert caught.value.allowed
