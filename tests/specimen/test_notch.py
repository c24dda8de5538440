"""Boxes and notches."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fissura.case import Notch as NotchPart
from fissura.errors import InputError
from fissura.specimen import Box, specimen_from_case
from fissura.specimen.notch import AXES, FACES, notch_from_part

SIZE = (0.12, 0.06, 0.04)
ALL = [(face, normal) for face, (axis, _) in FACES.items() for normal in "xyz" if AXES[normal] != axis]


def notch(**values):
    return notch_from_part(NotchPart.model_validate(values), SIZE, "notch")


@pytest.mark.parametrize(("face", "normal"), ALL)
@pytest.mark.parametrize("width", [0.0, 0.004])
def test_every_face_and_normal(face, normal, width):
    cut = notch(face=face, normal=normal, position=0.02, depth=0.01, width=width)
    axis, side = FACES[face]
    through = 3 - axis - AXES[normal]
    assert (cut.axis, cut.side, cut.normal, cut.through) == (axis, side, AXES[normal], through)
    assert cut.root == pytest.approx(0.01 if side == 0 else SIZE[axis] - 0.01, rel=1e-15)
    assert cut.void_volume == pytest.approx(width * 0.01 * SIZE[through], rel=1e-15)
    lines = cut.tip_lines()
    assert lines.shape == ((1 if width == 0.0 else 2), 2, 3)
    assert_allclose(lines[:, :, axis], cut.root)
    assert_allclose(sorted(lines[:, 0, AXES[normal]]), [0.02] if width == 0.0 else [0.018, 0.022], rtol=1e-14)
    assert_allclose(lines[:, 0, AXES[normal]], lines[:, 1, AXES[normal]])
    assert_allclose(lines[:, :, through], [[0.0, SIZE[through]]] * len(lines))
    # One point just inside the void, one just above the root.
    point = 0.5 * np.asarray(SIZE)
    point[AXES[normal]] = 0.02
    inward = 1.0 if side == 0 else -1.0
    below, above = point.copy(), point.copy()
    below[axis], above[axis] = cut.root - 1e-6 * inward, cut.root + 1e-6 * inward
    assert_allclose(cut.height(np.array([below, above])), [-1e-6, 1e-6], rtol=1e-6)
    assert list(cut.in_void(np.array([below, above]))) == [width > 0.0, False]


@pytest.mark.parametrize("face", FACES)
def test_default_normal(face):
    expected = {"left": 1, "right": 1}.get(face, 0)
    assert notch(face=face, position=0.02, depth=0.01).normal == expected


@given(st.floats(0.03, 0.09), st.floats(0.001, 0.059), st.floats(1e-4, 0.04))
def test_void_volume_is_what_contains_leaves_out(position, depth, width):
    """Midpoints of a fine grid, to its resolution."""
    cut = notch(position=position, depth=depth, width=width)
    box = Box(SIZE, (cut,))
    n = 200
    x, y = ((np.arange(n) + 0.5) / n * side for side in SIZE[:2])
    grid = np.stack(np.broadcast_arrays(x[:, None], y, 0.02), axis=-1)
    share = box.contains(grid).mean()
    error = (width / SIZE[0] + depth / SIZE[1] + 1.0 / n) / n
    assert abs(share - box.volume / np.prod(SIZE)) <= error


def test_contains_the_surface_but_not_beyond():
    box = Box(SIZE)
    assert box.contains(np.array([[0.0, 0.0, 0.0], list(SIZE), [0.05, 0.06, 0.0]])).all()
    assert not box.contains(np.array([[-1e-12, 0.01, 0.01], [0.05, 0.0601, 0.01]])).any()
    assert box.volume == pytest.approx(0.12 * 0.06 * 0.04, rel=1e-15)


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
    ],
)
def test_notches_that_do_not_fit(small_case, values, key):
    part = {"position": 0.06, "depth": 0.03} | values
    with pytest.raises(InputError) as caught:
        specimen_from_case(small_case(notch=part))
    assert caught.value.key == key
    assert caught.value.allowed
    if key != "notch.face" or values:
        with pytest.raises(InputError) as caught:
            specimen_from_case(small_case(notch=[{"position": 0.01, "depth": 0.001}, part]))
        assert caught.value.key == key.replace("notch", "notch[1]")


@pytest.mark.parametrize(
    "second",
    [
        {"face": "top", "position": 0.06, "depth": 0.035},
        {"face": "bottom", "position": 0.06, "depth": 0.02},
        {"face": "front", "normal": "x", "position": 0.06, "depth": 0.01},
    ],
    ids=["cut in two", "twice", "corner"],
)
@pytest.mark.parametrize("width", [0.0, 0.004])
def test_notches_that_overlap(small_case, second, width):
    """Their walls and volumes would be counted twice."""
    first = {"position": 0.06, "depth": 0.03, "width": width}
    with pytest.raises(InputError) as caught:
        specimen_from_case(small_case(notch=[first, second | {"width": width}]))
    assert caught.value.key.startswith("notch")


def test_shape_by_name(small_case):
    box = specimen_from_case(small_case())
    assert box.size == SIZE
    assert len(box.notches) == 1
    assert specimen_from_case(small_case(notch=None)).notches == ()
    with pytest.raises(InputError, match="box") as caught:
        specimen_from_case(small_case(specimen__shape="sphere"))
    assert caught.value.key == "specimen.shape"
