"""Specimens from cases: every shape, voids, notches, and what is wrong with them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fissura.errors import InputError
from fissura.specimen import domain_from_case
from fissura.specimen.shapes.prism import AXES, FACES

from .complexes import check

SIZE = (0.12, 0.06, 0.04)
AXIS_OF = {face: k // 2 for k, face in enumerate(FACES)}
ALL = [(face, normal) for face in FACES for normal in "xyz" if AXES[normal] != AXIS_OF[face]]


def notched(small_case, **values):
    return domain_from_case(small_case(notch=values))


# --- boxes and short forms of notches --------------------------------------------------------------------------------


@pytest.mark.parametrize(("face", "normal"), ALL)
@pytest.mark.parametrize("width", [0.0, 0.004])
def test_every_face_and_normal(small_case, face, normal, width):
    found = notched(small_case, face=face, normal=normal, position=0.02, depth=0.01, width=width)
    check(found.complex)
    (notch,) = found.notches
    axis, side = AXIS_OF[face], FACES.index(face) % 2
    through = 3 - axis - AXES[normal]
    assert_allclose(np.abs(notch.normal), np.eye(3)[AXES[normal]], atol=0)
    assert_allclose(notch.direction, np.eye(3)[axis] * (1.0 - 2.0 * side), atol=0)
    root = 0.01 if side == 0 else SIZE[axis] - 0.01
    assert_allclose(notch.point[[AXES[normal], axis]], [0.02, root], rtol=1e-15)
    assert_allclose(found.volume, np.prod(SIZE) - width * 0.01 * SIZE[through], rtol=1e-12)
    lines = notch.tip_lines()
    assert lines.shape == ((1 if width == 0.0 else 2), 2, 3)
    assert_allclose(lines[:, :, axis], root)
    assert_allclose(sorted(lines[:, 0, AXES[normal]]), [0.02] if width == 0.0 else [0.018, 0.022], rtol=1e-14)
    assert_allclose(np.sort(lines[:, :, through], axis=1), [[0.0, SIZE[through]]] * len(lines), atol=1e-15)
    point = 0.5 * np.asarray(SIZE)
    point[AXES[normal]] = 0.02
    inward = 1.0 - 2.0 * side
    behind, ahead = point.copy(), point.copy()
    behind[axis], ahead[axis] = root - 1e-6 * inward, root + 1e-6 * inward
    assert_allclose(notch.ahead(np.array([behind, ahead])), [-1e-6, 1e-6], rtol=1e-6)
    assert list(found.contains(np.array([behind, ahead]))) == [width == 0.0, True]


@pytest.mark.parametrize("face", FACES)
def test_default_normal(small_case, face):
    expected = {"left": 1, "right": 1}.get(face, 0)
    assert_allclose(np.abs(notched(small_case, face=face, position=0.02, depth=0.01).notches[0].normal)[expected], 1.0)


@given(st.floats(0.03, 0.09), st.floats(0.001, 0.059), st.floats(1e-4, 0.04))
def test_volume_is_what_contains_holds(small_case, position, depth, width):
    """Midpoints of a fine grid, to its resolution."""
    found = notched(small_case, position=position, depth=depth, width=width)
    n = 100
    x, y = ((np.arange(n) + 0.5) / n * side for side in SIZE[:2])
    grid = np.stack(np.broadcast_arrays(x[:, None], y, 0.02), axis=-1).reshape(-1, 3)
    share = found.contains(grid).mean()
    error = (width / SIZE[0] + depth / SIZE[1] + 1.0 / n) / n
    assert abs(share - found.volume / np.prod(SIZE)) <= error


def test_smallest_section(small_case):
    """Notches of one plane count together; those beside it do not."""
    assert domain_from_case(small_case(notch=None)).smallest_section == pytest.approx(0.06 * 0.04, rel=1e-12)
    for width in (0.0, 0.004):
        two = [{"position": 0.06, "depth": 0.02}, {"face": "top", "position": 0.06, "depth": 0.01}]
        found = domain_from_case(small_case(notch=[part | {"width": width} for part in two]))
        assert found.smallest_section == pytest.approx(0.03 * 0.04, rel=1e-12)
        apart = domain_from_case(small_case(notch=[two[0] | {"width": width}, two[1] | {"position": 0.08}]))
        assert apart.smallest_section == pytest.approx(0.04 * 0.04, rel=1e-12)


def test_outline_of_sections(small_case):
    """Around the material, in along one side of a cut and out along the other."""
    found = notched(small_case, position=0.06, depth=0.03)
    for z in (0.0, 0.02, 0.04):
        (loop,) = found.outline(np.array([0.0, 0.0, 1.0]), z)
        assert_allclose(loop[:, 2], z, atol=1e-12)
        assert_allclose(area_of(loop[:, :2]), 0.12 * 0.06, rtol=1e-12)
        assert sum(np.allclose(p[:2], [0.06, 0.0]) for p in loop) == 2
    loops = found.outline(np.array([0.0, 1.0, 0.0]), 0.01)  # across the cut: two parts
    assert sorted(abs(area_of(loop[:, [2, 0]])) for loop in loops) == pytest.approx([0.06 * 0.04] * 2, rel=1e-9)


def area_of(polygon):
    x, y = polygon.T
    return 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))


@pytest.mark.parametrize(
    ("values", "key"),
    [
        ({"depth": 0.06}, "notch.depth"),
        ({"depth": 0.07}, "notch.depth"),
        ({"face": "left", "position": 0.03, "depth": 0.12}, "notch.depth"),
        ({"position": 0.0}, "notch.position"),
        ({"position": 0.12}, "notch.position"),
        ({"position": 0.2}, "notch.position"),
        ({"position": -0.01}, "notch.position"),
        ({"position": 0.001, "width": 0.002}, "notch.position"),
        ({"position": 0.119, "width": 0.004}, "notch.position"),
        ({"face": "bottom", "normal": "y"}, "notch.normal"),
        ({"face": "left", "normal": "x"}, "notch.normal"),
        ({"face": "ground"}, "notch.face"),
        ({"face": None, "position": None, "on": "top", "at": [0.06, 0.05, 0.02]}, "notch.at"),
        ({"face": None, "position": None, "on": "roof", "at": [0.06, 0.06, 0.02]}, "notch.on"),
        ({"position": None, "on": "top", "at": [0.06, 0.06, 0.02], "direction": [0, 1, 0]}, "notch.direction"),
        ({"position": None, "on": "top", "at": [0.06, 0.06, 0.02], "direction": [1, 0, 0]}, "notch.direction"),
        ({"position": None, "on": "top", "at": [0.06, 0.06, 0.02], "along": [0, 1, 0]}, "notch.along"),
        ({"position": None, "on": "back", "at": [0.06, 0.03, 0.04]}, "notch.along"),
        ({"position": None, "on": "top", "at": [0.06, 0.06, 0.02], "depth": 0.06}, "notch.depth"),
    ],
)
def test_notches_that_do_not_fit(small_case, values, key):
    part = {k: v for k, v in ({"position": 0.06, "depth": 0.03} | values).items() if v is not None}
    with pytest.raises(InputError) as caught:
        domain_from_case(small_case(notch=part))
    assert caught.value.key == key
    assert caught.value.allowed
    with pytest.raises(InputError) as caught:
        domain_from_case(small_case(notch=[{"position": 0.01, "depth": 0.001}, part]))
    assert caught.value.key == key.replace("notch", "notch[1]")


@pytest.mark.parametrize("width", [0.0, 0.004])
@pytest.mark.parametrize(
    ("second", "problem"),
    [
        ({"face": "top", "position": 0.06, "depth": 0.035}, "falls into 2 parts"),
        ({"face": "bottom", "position": 0.06, "depth": 0.02}, "inside another"),
        ({"face": "bottom", "position": 0.06, "depth": 0.03}, "inside another"),
    ],
)
def test_notches_that_leave_nothing_between_them(small_case, second, problem, width):
    first = {"position": 0.06, "depth": 0.03, "width": width}
    with pytest.raises(InputError, match=problem) as caught:
        domain_from_case(small_case(notch=[first, second | {"width": width}]))
    assert caught.value.key.startswith("notch[1]")


def test_notches_of_one_plane_that_meet(small_case):
    """From the bottom and from the front: an L-shaped cut, or slit."""
    for width in (0.0, 0.004):
        first = {"position": 0.06, "depth": 0.03, "width": width}
        second = {"face": "front", "normal": "x", "position": 0.06, "depth": 0.01, "width": width}
        found = domain_from_case(small_case(notch=[first, second]))
        check(found.complex)
        cut = 0.03 * 0.04 + 0.01 * 0.06 - 0.03 * 0.01
        assert_allclose(found.volume, np.prod(SIZE) - width * cut, rtol=1e-12)
        assert found.smallest_section == pytest.approx(0.06 * 0.04 - cut, rel=1e-9)
