"""Supports, load and gauge as functionals of displacements."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from numpy.testing import assert_allclose

from fissura.errors import InputError
from fissura.specimen import conditions_from_case, domain_from_case

from .motion import rigid, value, vectors


def conditions(case):
    return conditions_from_case(case, domain_from_case(case))


@pytest.fixture(scope="module")
def beam(small_case):
    return conditions(small_case(load__width=0.01, gauge__a__at=0.05))


@given(vectors, vectors)
def test_means_of_rigid_motions(beam, shift, turn):
    """The load's displacement is that of its centroid, downwards; the gauge opens by the turn of its base."""
    u = rigid(np.array([0.06, 0.06, 0.02]), shift, turn)
    assert_allclose(value(beam.loads[0], rigid(beam.loads[0].points, shift, turn)), -u[1], atol=1e-12)
    a, b = np.array([0.05, 0.0, 0.02]), np.array([0.065, 0.0, 0.02])
    opening = (rigid(b, shift, turn) - rigid(a, shift, turn))[0]
    assert_allclose(value(beam.gauges[0], rigid(beam.gauges[0].points, shift, turn)), opening, atol=1e-12)


def test_gauge_opens_positive(beam):
    """Both halves move apart by 1."""
    u = np.where(beam.gauges[0].points[:, :1] > 0.06, 0.5, -0.5) * [1.0, 0.0, 0.0]
    assert_allclose(value(beam.gauges[0], u), 1.0, rtol=1e-12)


@pytest.mark.parametrize("direction", [None, [0, 3.0, 4.0]])
@pytest.mark.parametrize("face", ["left", "right", "bottom", "top", "front", "back"])
def test_load_is_a_unit_force(small_case, face, direction):
    load = conditions(small_case(load={"face": face, "direction": direction} if direction else {"face": face})).loads[0]
    inward = {"left": [1, 0, 0], "right": [-1, 0, 0], "bottom": [0, 1, 0], "top": [0, -1, 0]}
    inward |= {"front": [0, 0, 1], "back": [0, 0, -1]}
    assert_allclose(load.coefficients.sum(axis=0), [0, 0.6, 0.8] if direction else inward[face], atol=1e-12)


def test_gauge_direction(small_case):
    (gauge,) = conditions(small_case(gauge__direction=[0, 2.0, 0])).gauges
    u = np.where(gauge.points[:, :1] > 0.06, 1.0, 0.0) * [5.0, 7.0, 11.0]
    assert_allclose(value(gauge, u), 7.0, rtol=1e-12)


def test_displacement_control(small_case):
    c = conditions(small_case(control__type="displacement", gauge=None))
    assert c.main.quantity == "displacement"
    assert c.main.gauge is None
    assert c.main.ratios.tolist() == [1.0]


def rows(small_case, *supports, **changes):
    """Supports as rows on the six rigid motions about the origin."""
    found = conditions(small_case(supports=list(supports), **changes)).supports
    return np.array(
        [np.concatenate([f.coefficients.sum(axis=0), np.cross(f.points, f.coefficients).sum(axis=0)]) for f in found]
    )


PIN = {"type": "pin", "face": "bottom", "at": 0.01}
ROLLER = {"type": "roller", "face": "bottom", "at": 0.11}


def test_pin_leaves_its_hinge(small_case):
    """A pin across the face stops all but the turn about its own line."""
    pin = rows(small_case, PIN, ROLLER)[:5]
    assert np.linalg.matrix_rank(pin) == 5
    about_the_line = np.concatenate([-np.cross([0, 0, 1.0], [0.01, 0, 0]), [0, 0, 1.0]])
    assert_allclose(pin @ about_the_line, 0.0, atol=1e-15)


BESIDE = {"left": "z", "right": "z", "bottom": "z", "top": "z", "front": "y", "back": "y"}


@pytest.mark.parametrize("width", [0.0, 1e-6, 0.01, 0.013, 0.02])
@pytest.mark.parametrize("thickness", [0.012, 0.013, 0.04])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("face", ["left", "right", "bottom", "top", "front", "back"])
def test_the_hinge_runs_across_whatever_its_shape(small_case, face, turned, thickness, width):
    """Longer along than across, shorter or equal: the axis is perpendicular to `along` and to the face."""
    usual = "y" if face in ("left", "right") else "x"
    along = BESIDE[face] if turned else usual
    place = {"type": "pin", "face": face, "at": 0.006, "along": along, "width": min(width, 0.008)}
    size = {"x": 0.12, "y": 0.06, "z": thickness}
    pin = rows(
        small_case,
        place,
        {"type": "clamp", "face": "right" if face != "right" else "left"},
        specimen__size=list(size.values()),
    )[: 4 if width == 0.0 else 5]
    normal = {"left": "x", "right": "x", "bottom": "y", "top": "y", "front": "z", "back": "z"}[face]
    middle = {axis: 0.5 * length for axis, length in size.items()} | {along: 0.006}
    middle[normal] = size[normal] if face in ("right", "top", "back") else 0.0
    hinge = np.eye(3)["xyz".index(next(iter(set("xyz") - {along, normal})))]
    about = np.concatenate([-np.cross(hinge, list(middle.values())), hinge])
    assert_allclose(pin @ about, 0.0, atol=1e-15)


def test_pins_on_whole_faces_and_points(small_case):
    """A whole face turns about the middle line across `along`; a point holds no turn at all."""
    for along, hinge in (("x", [0, 0, 1.0]), ("z", [1.0, 0, 0])):
        pin = rows(small_case, {"type": "pin", "face": "bottom", "along": along}, {"type": "clamp", "face": "top"})[:5]
        assert np.linalg.matrix_rank(pin) == 5
        turn = np.concatenate([-np.cross(hinge, [0.06, 0, 0.02]), hinge])
        assert_allclose(pin @ turn, 0.0, atol=1e-14)  # weights are areas, their sum has round-off
    point = {"type": "pin", "face": "bottom", "point": [0.01, 0, 0.02]}
    found = conditions(small_case(supports=[point, {"type": "clamp", "face": "left"}])).supports
    assert [len(f.points) for f in found[:4]] == [1, 1, 1, len(found[4].points)]
    assert len(found[4].points) > 1


def test_rollers_stop_the_normal_only(small_case):
    roller = rows(small_case, PIN, ROLLER)[5:]
    assert_allclose(roller, [[0, 1.0, 0, -0.02, 0, 0.11]], atol=1e-12)


def test_clamp_holds_alone(small_case):
    clamp = rows(small_case, {"type": "clamp", "face": "left"})
    assert clamp.shape == (6, 6)
    assert np.linalg.matrix_rank(clamp) == 6


def test_guides_hold_turns_only(small_case):
    """The rows of a clamp without its translations."""
    found = rows(small_case, {"type": "clamp", "face": "left"}, {"type": "guide", "face": "left"})
    assert_allclose(found[6:], found[3:6], atol=0.0)
    assert_allclose(found[6:, :3], 0.0, atol=1e-12)
    with pytest.raises(InputError, match="3 of the 6"):
        conditions(small_case(supports=[{"type": "guide", "face": "left"}]))


@pytest.mark.parametrize("width", [1e-3, 0.2e-3, 1e-6])
def test_clamps_of_narrow_strips_hold_all_turns(small_case, width):
    """Narrower than a fifth of l_f, 1.6 mm, they are one row of samples: its turn is that of the strip."""
    clamp = {"type": "clamp", "face": "bottom", "at": 0.02, "width": width}
    assert np.linalg.matrix_rank(rows(small_case, clamp), tol=1e-12) == 6
    found = conditions(small_case(supports=[clamp])).supports
    spread = found[0].points[:, 0] - 0.02
    assert_allclose(np.mean(spread**2), width**2 / 12.0, rtol=1e-9)


@given(vectors, vectors)
def test_clamp_measures_turns_about_its_centroid(small_case, shift, turn):
    """Rotations times the radius of gyration: a length, like displacements."""
    found = conditions(small_case(supports=[{"type": "clamp", "face": "left"}])).supports
    centre = np.array([0.0, 0.03, 0.02])
    values = [value(f, rigid(f.points, shift, turn)) for f in found]
    assert_allclose(values[:3], rigid(centre, shift, turn), atol=1e-12)
    points = found[0].points - centre
    for axis in range(3):
        gyration = np.sqrt(np.mean(np.sum(np.delete(points, axis, axis=1) ** 2, axis=1)))
        assert_allclose(values[3 + axis], gyration * turn[axis], atol=1e-12)


@pytest.mark.parametrize(
    "supports",
    [
        [ROLLER],
        [PIN],
        [ROLLER, ROLLER | {"at": 0.01}],
        [{"type": "clamp", "face": "bottom", "point": [0.01, 0.0, 0.02]}, ROLLER],
        [PIN, PIN],
        [PIN | {"type": "roller", "face": f} for f in ("left", "bottom", "front")],
    ],
    ids=["roller", "pin", "two rollers", "points", "pin twice", "three rollers"],
)
def test_mechanisms(small_case, supports):
    with pytest.raises(InputError, match="of the 6 rigid motions") as caught:
        conditions(small_case(supports=supports))
    assert caught.value.key == "supports"


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"supports__1__at": 0.13}, "supports[1].at"),
        ({"supports__0__at": -0.01}, "supports[0].at"),
        ({"supports__1__face": "ground"}, "supports[1].face"),
        ({"load__at": 0.13}, "load.at"),
        ({"gauge__a__at": 0.13}, "gauge.a.at"),
        ({"gauge__b": {"face": "bottom", "point": [0.065, 0.01, 0.02]}}, "gauge.b.point"),
        ({"gauge__b__at": 0.055}, "gauge.b"),
        ({"gauge__b__at": 0.055, "gauge__direction": [1, 0, 0]}, "gauge.b"),
    ],
)
def test_errors_name_the_key(small_case, changes, key):
    with pytest.raises(InputError) as caught:
        conditions(small_case(**changes))
    assert caught.value.key == key
