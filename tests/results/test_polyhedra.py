import numpy as np
import pytest

from fissura.results.polyhedra import polygon_normals, polyhedra
from fissura.tessellation.tessellation import Polygons

from .synthetic import random_points, stack, voronoi_structure

SIZE = np.array([0.12, 0.05, 0.05])


@pytest.fixture(scope="module")
def structure():
    return voronoi_structure(random_points(60, SIZE), SIZE)


def measured_volumes(solid, n):
    """Divergence theorem over the faces."""
    sizes = np.diff(solid.face_offsets)
    polygons = Polygons(solid.points[solid.corners], solid.face_offsets, np.arange(len(sizes)))
    first = polygons.points[polygons.offsets[:-1]]
    share = np.einsum("fc,fc->f", first, polygon_normals(polygons)) / 6
    return np.bincount(solid.face_body, share, minlength=n)


def test_normals_of_a_square_and_a_triangle():
    square = [[0, 0, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1]]
    triangle = [[0, 0, 0], [0, 0, 1], [0, 1, 0]]
    polygons = Polygons(np.array(square + triangle, float), np.array([0, 4, 7]), np.array([0, 1]))
    np.testing.assert_allclose(polygon_normals(polygons), [[0, 0, 8], [-1, 0, 0]])


def test_cubes():
    solid = polyhedra(stack())
    assert len(solid.points) == 16
    assert np.bincount(solid.face_body).tolist() == [6, 6]
    assert np.diff(solid.face_offsets).tolist() == [4] * 12
    assert solid.point_body.tolist() == [0] * 8 + [1] * 8


def test_volumes_are_those_of_the_bodies(structure):
    np.testing.assert_allclose(measured_volumes(polyhedra(structure), len(structure)), structure.volume, rtol=1e-9)


def test_every_edge_is_walked_once_in_each_direction(structure):
    solid = polyhedra(structure)
    following = np.arange(len(solid.corners)) + 1
    following[solid.face_offsets[1:] - 1] = solid.face_offsets[:-1]
    edges = np.column_stack([solid.corners, solid.corners[following]])
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert {tuple(e) for e in edges} == {tuple(e) for e in edges[:, ::-1]}


def test_bodies_share_no_points(structure):
    solid = polyhedra(structure)
    face = np.repeat(np.arange(len(solid.face_body)), np.diff(solid.face_offsets))
    np.testing.assert_array_equal(solid.point_body[solid.corners], solid.face_body[face])


def test_almost_equal_corners_are_one_point():
    t = stack()
    # A cut between rounding cells must not part two corners that differ by round-off.
    t.contacts.polygons.points[:] += 1e-16 * np.random.default_rng(3).normal(size=(4, 3))
    t.surface.polygons.points[:] += 1e-12 * np.random.default_rng(4).uniform(-1, 1, size=(40, 3))
    assert len(polyhedra(t).points) == 16


def test_corners_that_fall_together_are_dropped():
    t = stack()
    polygons = t.contacts.polygons
    twice = np.vstack([polygons.points, polygons.points[-1:]])
    sliver = np.tile(polygons.points[:1], (3, 1))
    changed = Polygons(np.vstack([twice, sliver]), np.array([0, 5, 8]), np.array([0, 0]))
    object.__setattr__(t.contacts, "polygons", changed)
    solid = polyhedra(t)
    assert np.diff(solid.face_offsets).tolist() == [4] * 12
    np.testing.assert_allclose(measured_volumes(solid, 2), t.volume)
