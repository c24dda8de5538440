"""Places on round surfaces, over several cells, on several surfaces, and on the sides of notches."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fissura.errors import InputError
from fissura.specimen import Domain, Solid
from fissura.specimen.assemble import complex_of
from fissura.specimen.sampling import sampled_polygon
from fissura.specimen.shapes.prism import box_half_spaces, cylinder

from .test_place import BOX, SPACING, check, notched, place

RADIUS, LENGTH = 0.075, 0.06
DISC = Domain(*complex_of(cylinder(2 * RADIUS, LENGTH, 2, 5 * SPACING)))


def second_moment(p):
    arm = p.points - p.centroid
    return np.einsum("k,ka,kb->ab", p.weights, arm, arm)


def test_strip_on_a_round_surface():
    p = place(DISC, on="lateral", toward=[0, 2.0, 0], width=0.01)
    check(p, DISC)
    assert_allclose(p.outward, [0, 1.0, 0], atol=1e-12)
    assert_allclose(np.abs(p.hinge), [0, 0, 1.0], atol=1e-12)
    assert_allclose(p.centroid[[0, 2]], [0.0, 0.03], atol=1e-12)
    assert np.abs(p.points[:, 0]).max() < 0.005
    assert (p.points[:, 1] > RADIUS - 0.001).all()
    assert_allclose(second_moment(p)[0, 0], 0.01**2 / 12, rtol=0.05)
    down = place(DISC, on="lateral", toward=[0, -1.0, 0], width=0.01)
    assert_allclose(down.outward, [0, -1.0, 0], atol=1e-12)
    oblique = place(DISC, on="lateral", toward=[0.6, 0.8, 0], width=0.01)
    assert oblique.outward @ [0.6, 0.8, 0] > 0.999
    across = oblique.points @ [0.8, -0.6, 0]
    assert_allclose(across.max() + across.min(), 0.0, atol=1e-3 * 0.01)


def test_all_of_a_round_surface_faces_nowhere():
    p = place(DISC, on="lateral", along="z")
    check(p, DISC)
    assert p.outward is None
    assert p.hinge is None
    assert_allclose(p.centroid, [0.0, 0.0, 0.03], atol=1e-12)


def test_point_and_line_on_a_round_surface():
    """The surface is a polygon: points on the circle are moved onto it."""
    p = place(DISC, on="lateral", point=[0.0, RADIUS, 0.02])
    check(p, DISC)
    assert np.linalg.norm(p.points[0] - [0.0, RADIUS, 0.02]) < 5 * SPACING * 0.1
    p = place(DISC, on="lateral", line=[[0.0, RADIUS, 0.0], [0.0, RADIUS, LENGTH]])
    check(p, DISC)
    assert_allclose(np.abs(p.hinge), [0, 0, 1.0], atol=1e-9)
    assert_allclose(p.centroid[2], 0.03, rtol=1e-12)
    with pytest.raises(InputError, match="not on the surface") as caught:
        place(DISC, on="lateral", point=[0.0, 0.07, 0.02])
    assert caught.value.key == "load.point"


def test_ends_of_a_cylinder():
    """Points of a round face stand for areas of all sizes; linear fields, and almost quadratic ones, are exact."""
    p = place(DISC, on="top")
    check(p, DISC)
    assert_allclose(p.centroid, [0.0, 0.0, LENGTH], atol=1e-15)
    assert_allclose(second_moment(p)[0, 0], RADIUS**2 / 4, rtol=2e-3)
    both = place(DISC, on=["bottom", "top"])
    check(both, DISC)
    assert_allclose(both.centroid, [0.0, 0.0, 0.03], atol=1e-15)
    line = place(DISC, on="top", at=0.02)
    check(line, DISC)
    assert_allclose(np.ptp(line.points[:, 1]), 2 * np.sqrt(RADIUS**2 - 0.02**2), rtol=0.03)


def test_part_in_a_box():
    p = place(on="top", box={"lower": [0.02, 0.06, 0.01], "upper": [0.05, 0.06, 0.02]})
    check(p)
    assert_allclose(p.centroid, [0.035, 0.06, 0.015], rtol=1e-12)
    p = place(on=["top", "right"], box={"lower": [0.11, 0.03, -1.0], "upper": [1.0, 1.0, 1.0]})
    check(p)
    assert {tuple(n) for n in p.normals} == {(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)}
    assert_allclose(p.weights[p.normals[:, 1] > 0.5].sum(), 0.25, rtol=1e-12)
    with pytest.raises(InputError, match="nothing of the surface") as caught:
        place(on="top", box={"lower": [0.02, 0.0, 0.01], "upper": [0.05, 0.05, 0.02]})
    assert caught.value.key == "load.box"


def test_what_looks_one_way():
    p = place(on=["top", "right", "left"], toward=[1.0, 0.5, 0])
    check(p)
    assert {tuple(n) for n in p.normals} == {(1.0, 0.0, 0.0)}
    p = place(DISC, on="lateral", toward=[1.0, 0, 0], box={"lower": [-1, 0, 0], "upper": [1, 1, 1]})
    check(p, DISC)
    assert (p.points[:, 1] > 0.0).all()
    assert (p.normals[:, 0] > 0.5).all()


def test_sides_of_an_ideal_cut():
    domain = notched()
    for side in (1.0, -1.0):
        p = place(domain, on="notch", toward=[side, 0, 0], along="y")
        check(p, domain)
        assert_allclose(p.outward, [side, 0, 0], atol=0)
        assert_allclose(p.centroid, [0.06, 0.015, 0.02], rtol=1e-12)
        middle = domain.complex.corner[:, slice(*domain.complex.corner_start[p.cells[0] : p.cells[0] + 2])].mean(axis=1)
        assert (middle[0] - 0.06) * side < 0.0
        p = place(domain, on="notch", toward=[side, 0, 0], point=[0.06, 0.01, 0.02])
        assert_allclose(p.outward, [side, 0, 0], atol=0)
    for where in ({}, {"point": [0.06, 0.01, 0.02]}):
        with pytest.raises(InputError, match="both sides of an ideal cut") as caught:
            place(domain, on="notch", **where)
        assert caught.value.key == "load.toward"
    check(place(notched(width=0.004), on="notch", along="y"), notched(width=0.004))


def test_places_over_several_cells():
    """An L of two cells: places on faces that are divided between them."""
    solid = Solid([0.0] * 3, [0.1, 0.1, 0.04])
    solid.add(box_half_spaces([0, 0, 0], [0.04, 0.06, 0.04]), ["a", "inner", "b", "c", "front", "back"])
    solid.add(box_half_spaces([0, 0.06, 0], [0.1, 0.1, 0.04]), ["a", "d", "under", "top", "front", "back"])
    domain = Domain(*complex_of(solid))
    p = place(domain, on="front")
    check(p, domain)
    assert set(p.cells) == {0, 1}
    area = 0.04 * 0.06 + 0.1 * 0.04
    expected = (0.04 * 0.06 * np.array([0.02, 0.03, 0]) + 0.1 * 0.04 * np.array([0.05, 0.08, 0])) / area
    assert_allclose(p.centroid, expected, rtol=1e-12, atol=1e-15)
    line = place(domain, on="front", at=0.02)
    check(line, domain)
    assert len(line.points) == int(np.ceil(0.1 / SPACING))
    assert_allclose(np.diff(np.sort(line.points[:, 1])), 0.1 / len(line.points), rtol=1e-9)
    assert_array_equal(line.cells, (line.points[:, 1] > 0.06).astype(int))
    edge = place(domain, on="front", at=0.06, along="y")
    check(edge, domain)
    assert_allclose(edge.points[:, 1], 0.06)


@pytest.mark.parametrize(
    ("domain", "values", "key"),
    [
        (DISC, {"on": "lateral", "toward": [0, 0, 1.0], "width": 0.01}, "load.toward"),
        (BOX, {"on": "top", "toward": [0, 1.0, 0], "width": 0.01}, "load.toward"),
        (BOX, {"on": "top", "toward": [0, -1.0, 0], "at": 0.01}, "load.toward"),
        (BOX, {"on": "top", "toward": [0, -1.0, 0], "width": 0.01}, "load.toward"),
        (DISC, {"on": "lateral", "toward": [0, 1.0, 0], "width": 0.2}, "load.width"),
        (DISC, {"on": ["top", "roof"]}, "load.on"),
        (BOX, {"on": "top", "line": [[0.0, 0.06, 0.0], [0.0, 0.06, 0.0]]}, "load.line"),
        (BOX, {"on": "top", "line": [[0.0, 0.06, 0.0], [0.2, 0.06, 0.0]]}, "load.line"),
    ],
)
def test_places_that_are_not_there(domain, values, key):
    with pytest.raises(InputError) as caught:
        place(domain, **values)
    assert caught.value.key == key
    assert caught.value.allowed


@pytest.mark.parametrize("count", [3, 5, 12])
def test_polygons_are_sampled_exactly(count):
    """Areas, centroids and, but for the size of the pieces, second moments of regular polygons in a skew plane."""
    t = 2 * np.pi * np.arange(count) / count
    normal = np.array([1.0, 2.0, 2.0]) / 3.0
    u = np.array([2.0, 1.0, -2.0]) / 3.0
    polygon = np.array([0.1, 0.2, 0.3]) + np.outer(np.cos(t), u) + np.outer(np.sin(t), np.cross(normal, u))
    for spacing in (10.0, 0.3, 0.05):
        points, area = sampled_polygon(polygon, normal, u, spacing)
        assert_allclose(area.sum(), 0.5 * count * np.sin(2 * np.pi / count), rtol=1e-12)
        assert_allclose(area @ points / area.sum(), [0.1, 0.2, 0.3], atol=1e-12)
        assert area.max() <= spacing**2 * (1 + 1e-9)
    moment = area @ ((points - [0.1, 0.2, 0.3]) @ u) ** 2
    exact = count / 24 * np.sin(2 * np.pi / count) * (2 + np.cos(2 * np.pi / count))
    assert_allclose(moment, exact, rtol=5e-3)
