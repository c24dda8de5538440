"""Places on the surface."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fissura.case import Notch as NotchPart
from fissura.case import Patch
from fissura.errors import InputError
from fissura.specimen import Domain, place_from_part
from fissura.specimen.assemble import complex_of
from fissura.specimen.cutting import cut_notches
from fissura.specimen.limits import SAMPLES
from fissura.specimen.shapes.prism import AXES, FACES, box
from fissura.specimen.slots import slot_from_part

SIZE = (0.12, 0.06, 0.04)
SPACING = 0.0016
BOX = Domain(*complex_of(box(SIZE)))


def place(domain=BOX, spacing=SPACING, **values):
    return place_from_part(Patch.model_validate(values), domain, SAMPLES * spacing, "load")


def notched(**values):
    part = NotchPart.model_validate({"position": 0.06, "depth": 0.03} | values)
    solid = box(SIZE)
    notches = cut_notches(solid, [slot_from_part(part, BOX, 5 * SPACING, "notch")])
    return Domain(*complex_of(solid), notches)


def check(p, domain=BOX):
    """Weights sum to one; points lie on the surface of the cells behind them."""
    cx = domain.complex
    assert_allclose(p.weights.sum(), 1.0, rtol=1e-12)
    assert (p.weights > 0.0).all()
    assert_allclose(np.linalg.norm(p.normals, axis=1), 1.0, rtol=1e-14)
    for x, normal, cell in zip(p.points, p.normals, p.cells, strict=True):
        rows = slice(cx.plane_start[cell], cx.plane_start[cell + 1])
        gap = cx.offset[rows] - cx.normal[rows] @ x
        assert gap.min() > -1e-12
        (face,) = np.flatnonzero((np.abs(gap) < 1e-12) & (cx.normal[rows] @ normal > 1 - 1e-12))
        assert face >= 0


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("where", [{}, {"at": 0.013}, {"at": 0.02, "width": 0.0101}, "along", "strip along"])
def test_points_on_the_face(face, where):
    axis, side = divmod(FACES.index(face), 2)
    if isinstance(where, str):
        other = {"left": "z", "right": "z", "bottom": "z", "top": "z", "front": "y", "back": "y"}[face]
        where = {"at": 0.02, "along": other, "width": 0.01 if "strip" in where else 0.0}
    p = place(face=face, **where)
    assert_allclose(p.outward, np.eye(3)[axis] * (1.0 if side else -1.0), atol=0)
    assert_allclose(p.points[:, axis], side * SIZE[axis], atol=0)
    assert (p.points >= 0.0).all()
    assert (p.points <= np.asarray(SIZE)).all()
    check(p)
    # The centroid is that of the line, strip or face.
    along = AXES[where.get("along", "y" if axis == 0 else "x")]
    expected = 0.5 * np.asarray(SIZE)
    expected[axis] = side * SIZE[axis]
    if "at" in where:
        expected[along] = where["at"]
    assert_allclose(p.centroid, expected, rtol=1e-12, atol=1e-15)
    # Second moment of the midpoint rule: that of the strip, short by 1/count^2.
    extent = np.ptp(p.points, axis=0)
    width = where.get("width", 0.0) if "at" in where else SIZE[along]
    assert extent[along] <= width
    assert extent[along] >= width - SPACING * (1 + 1e-9)
    across = 3 - axis - along
    assert_allclose(p.along, np.eye(3)[along], atol=0)
    assert_allclose(np.abs(p.hinge), np.eye(3)[across], atol=0)
    assert SIZE[across] - SPACING * (1 + 1e-9) <= extent[across] <= SIZE[across]


def test_points_no_farther_than_the_spacing():
    p = place(face="top", at=0.06, width=0.01)
    for axis in (0, 2):
        assert np.diff(np.unique(p.points[:, axis])).max() <= SPACING * (1 + 1e-9)


def test_point():
    p = place(face="top", point=[0.03, 0.06, 0.01])
    assert_allclose(p.points, [[0.03, 0.06, 0.01]])
    assert_allclose(p.weights, [1.0])


def test_not_over_the_mouth_of_a_notch():
    domain = notched(width=0.004)
    p = place(domain, face="bottom")
    check(p, domain)
    assert (np.abs(p.points[:, 0] - 0.06) > 0.002).all()
    with pytest.raises(InputError, match="mouth") as caught:
        place(domain, face="bottom", at=0.061)
    assert caught.value.key == "load.at"
    with pytest.raises(InputError, match="mouth") as caught:
        place(domain, face="bottom", point=[0.06, 0.0, 0.02])
    assert caught.value.key == "load.point"


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
    with pytest.raises(InputError, match="ideal cut") as caught:
        place(notched(), **values)
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
    assert len(place(notched(), **values).points) >= 1


def test_a_strip_over_an_ideal_cut_leaves_out_its_plane():
    """Its two sides are sampled each for itself."""
    domain = notched()
    p = place(domain, face="bottom", at=0.06, width=0.0079)
    check(p, domain)
    assert (np.abs(p.points[:, 0] - 0.06) > 1e-4).all()
    assert_allclose(p.centroid, [0.06, 0.0, 0.02], rtol=1e-12, atol=1e-15)


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
def test_places_that_do_not_fit(values, key):
    with pytest.raises(InputError) as caught:
        place(**values)
    assert caught.value.key == key
    assert caught.value.allowed


@pytest.mark.parametrize("at", [0.0, 0.12])
def test_edges_belong_to_the_face(at):
    assert_allclose(place(face="top", at=at).centroid, [at, 0.06, 0.02])
