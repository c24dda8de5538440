"""Patches of the surface."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fissura.case import Patch as PatchPart
from fissura.errors import InputError
from fissura.specimen import Box
from fissura.specimen.notch import AXES, FACES, notch_from_part
from fissura.specimen.patch import patch_from_part

SIZE = (0.12, 0.06, 0.04)
SPACING = 0.0016


def patch(box=None, spacing=SPACING, **values):
    return patch_from_part(PatchPart.model_validate(values), box or Box(SIZE), spacing, "load")


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("place", [{}, {"at": 0.013}, {"at": 0.02, "width": 0.0101}, "along", "strip along"])
def test_points_on_the_face(face, place):
    axis, side = FACES[face]
    if isinstance(place, str):
        other = {"left": "z", "right": "z", "bottom": "z", "top": "z", "front": "y", "back": "y"}[face]
        place = {"at": 0.02, "along": other, "width": 0.01 if "strip" in place else 0.0}
    p = patch(face=face, **place)
    assert p.axis == axis
    assert p.outward == (1.0 if side else -1.0)
    assert_allclose(p.points[:, axis], side * SIZE[axis], atol=0)
    assert (p.points >= 0.0).all()
    assert (p.points <= np.asarray(SIZE)).all()
    assert_allclose(p.weights.sum(), 1.0, rtol=1e-12)
    assert (p.weights > 0.0).all()
    # The centroid is that of the line, strip or face.
    along = AXES[place.get("along", "y" if axis == 0 else "x")]
    expected = 0.5 * np.asarray(SIZE)
    expected[axis] = side * SIZE[axis]
    if "at" in place:
        expected[along] = place["at"]
    assert_allclose(p.centroid, expected, rtol=1e-12, atol=1e-15)
    # Second moment of the midpoint rule: that of the strip, short by 1/count^2.
    extent = np.ptp(p.points, axis=0)
    width = place.get("width", 0.0) if "at" in place else SIZE[along]
    assert extent[along] <= width
    assert extent[along] >= width - SPACING * (1 + 1e-9)
    across = 3 - axis - along
    assert SIZE[across] - SPACING * (1 + 1e-9) <= extent[across] <= SIZE[across]


def test_points_no_farther_than_the_spacing():
    p = patch(face="top", at=0.06, width=0.01)
    for axis in (0, 2):
        assert np.diff(np.unique(p.points[:, axis])).max() <= SPACING * (1 + 1e-9)


def test_point():
    p = patch(face="top", point=[0.03, 0.06, 0.01])
    assert_allclose(p.points, [[0.03, 0.06, 0.01]])
    assert_allclose(p.weights, [1.0])


def test_not_over_the_mouth_of_a_notch():
    part = {"position": 0.06, "depth": 0.03, "width": 0.004}
    from fissura.case import Notch

    box = Box(SIZE, (notch_from_part(Notch.model_validate(part), SIZE, "notch"),))
    p = patch(box, face="bottom")
    assert box.contains(p.points).all()
    assert_allclose(p.weights.sum(), 1.0, rtol=1e-12)
    with pytest.raises(InputError, match="mouth") as caught:
        patch(box, face="bottom", at=0.061)
    assert caught.value.key == "load.at"
    with pytest.raises(InputError, match="mouth") as caught:
        patch(box, face="bottom", point=[0.06, 0.0, 0.02])
    assert caught.value.key == "load.point"


def notched(**values):
    from fissura.case import Notch

    part = {"position": 0.06, "depth": 0.03} | values
    return Box(SIZE, (notch_from_part(Notch.model_validate(part), SIZE, "notch"),))


@pytest.mark.parametrize(
    "values",
    [
        {"face": "bottom", "at": 0.06},
        {"face": "bottom", "point": [0.06, 0.0, 0.01]},
        {"face": "front", "point": [0.06, 0.01, 0.0]},  # on the crack's edge in the side of the beam
        {"face": "back", "point": [0.06, 0.03, 0.04]},  # at its tip
    ],
)
def test_not_in_the_plane_of_an_ideal_cut(values):
    with pytest.raises(InputError, match=r"x = 0\.06 m of an ideal cut") as caught:
        patch(notched(), **values)
    assert caught.value.key == ("load.at" if "at" in values else "load.point")


@pytest.mark.parametrize(
    "values",
    [
        {"face": "top", "at": 0.06},
        {"face": "bottom", "at": 0.06 + 1e-6},
        {"face": "front", "point": [0.06, 0.031, 0.0]},
        {"face": "bottom", "at": 0.06, "along": "z", "width": 0.0},
    ],
)
def test_beside_and_above_an_ideal_cut(values):
    values = values | ({"at": 0.02} if values.get("along") == "z" else {})
    assert len(patch(notched(), **values).points) >= 1


def test_a_strip_over_an_ideal_cut_leaves_out_its_plane():
    """An odd number of rows has one in the plane."""
    p = patch(notched(), face="bottom", at=0.06, width=0.0079)
    rows = np.unique(p.points[:, 0])
    assert_allclose(rows, 0.06 + 0.0079 * np.array([-0.4, -0.2, 0.2, 0.4]), rtol=1e-12)
    assert_allclose(p.centroid, [0.06, 0.0, 0.02], rtol=1e-12, atol=1e-15)
    assert_allclose(p.weights.sum(), 1.0, rtol=1e-12)


@pytest.mark.parametrize(
    ("values", "key"),
    [
        ({"face": "roof"}, "load.face"),
        ({"face": "top", "at": 0.121}, "load.at"),
        ({"face": "top", "at": -0.001}, "load.at"),
        ({"face": "top", "at": 0.118, "width": 0.005}, "load.at"),
        ({"face": "top", "at": 0.05, "along": "z"}, "load.at"),
        ({"face": "left", "at": 0.07}, "load.at"),
        ({"face": "top", "at": 0.05, "along": "y"}, "load.along"),
        ({"face": "top", "point": [0.05, 0.05, 0.02]}, "load.point"),
        ({"face": "top", "point": [0.13, 0.06, 0.02]}, "load.point"),
        ({"face": "bottom", "point": [0.05, 0.06, 0.02]}, "load.point"),
        ({"face": "top", "point": [0.05, 0.06, -0.01]}, "load.point"),
    ],
)
def test_patches_that_do_not_fit(values, key):
    with pytest.raises(InputError) as caught:
        patch(**values)
    assert caught.value.key == key
    assert caught.value.allowed


@pytest.mark.parametrize("at", [0.0, 0.12])
def test_edges_belong_to_the_face(at):
    assert_allclose(patch(face="top", at=at).centroid, [at, 0.06, 0.02])
