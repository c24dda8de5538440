"""Voronoi cells: against an independent construction, and exact for the most irregular nuclei."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial import Voronoi

from fissura.specimen.assemble import complex_of
from fissura.specimen.shapes.prism import box
from fissura.tessellation.measures import volume_of
from fissura.tessellation.polygon import areas_and_centroids
from fissura.tessellation.voronoi import Cells, voronoi_cells

from .build import SHAPES, shape

SIZE = (1.0, 0.8, 0.6)
EXTENT = np.array(SIZE)
BOX, SURFACES = complex_of(box(SIZE))


def guess(x) -> np.ndarray:
    return np.full(len(x), (EXTENT.prod() / len(x)) ** (1 / 3))


def cells_of(x) -> Cells:
    return voronoi_cells(np.asarray(x, float), np.zeros(len(x), int), BOX, len(SURFACES), guess(x))


def residuals(cells: Cells) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Volume of each cell, its surface, and how far it is from closed."""
    x, bodies = cells.x, cells.bodies
    i, j, body = bodies.inner.body, bodies.inner.other, bodies.outer.body
    inner, centroid = areas_and_centroids(bodies.inner.polygons.points, bodies.inner.polygons.offsets)
    outer, outer_centroid = areas_and_centroids(bodies.outer.polygons.points, bodies.outer.polygons.offsets)
    cells_, vectors = np.concatenate([i, j, body]), np.concatenate([inner, -inner, outer])
    arms = np.concatenate([centroid, centroid, outer_centroid]) - x[cells_]
    volume, skin, closure = np.zeros(len(x)), np.zeros(len(x)), np.zeros((len(x), 3))
    np.add.at(volume, cells_, np.einsum("ka,ka->k", vectors, arms) / 3.0)
    np.add.at(skin, cells_, np.linalg.norm(vectors, axis=1))
    np.add.at(closure, cells_, vectors)
    return volume, skin, closure


def by_reflection(x) -> dict[tuple[int, int], float]:
    """Areas of facets between nuclei: all of them are reflected in all faces."""
    images = [x]
    for axis in range(3):
        for face in (0.0, SIZE[axis]):
            image = x.copy()
            image[:, axis] = 2.0 * face - image[:, axis]
            images.append(image)
    diagram = Voronoi(np.concatenate(images))
    areas = {}
    for ends, corners in zip(diagram.ridge_points, diagram.ridge_vertices, strict=True):
        if max(ends) < len(x):
            vector, _ = areas_and_centroids(diagram.vertices[corners], np.array([0, len(corners)]))
            areas[tuple(sorted(map(int, ends)))] = float(np.linalg.norm(vector))
    return areas


def areas_of(cells: Cells) -> dict[tuple[int, int], float]:
    facets = cells.bodies.inner
    return {(int(i), int(j)): float(a) for i, j, a in zip(facets.body, facets.other, facets.area, strict=True)}


@given(st.integers(1, 150), st.integers(0, 2**32 - 1), st.floats(1.0, 3.0))
def test_the_same_as_by_reflection(count, seed, power):
    """Random nuclei, for large powers crowded at one edge."""
    x = np.random.default_rng(seed).uniform(0.0, 1.0, (count, 3)) ** power * SIZE
    own, other = areas_of(cells_of(x)), by_reflection(x)
    largest = max(own.values(), default=0.0)
    for pair in own.keys() | other.keys():
        assert_allclose(own.get(pair, 0.0), other.get(pair, 0.0), rtol=0, atol=1e-10 * largest)


def lattice(count: int, *basis: tuple[float, float, float]) -> np.ndarray:
    corners = np.stack(np.meshgrid(*[np.arange(count)] * 3, indexing="ij"), -1).reshape(-1, 3)
    return np.concatenate([corners + place for place in basis]) / count


CUBIC = lattice(6, (0.5, 0.5, 0.5))
FACE_CENTRED = lattice(4, (0.25, 0.25, 0.25), (0.75, 0.75, 0.25), (0.75, 0.25, 0.75), (0.25, 0.75, 0.75))
RNG = np.random.default_rng(0)
DIRECTIONS = RNG.normal(size=(300, 3))
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1)[:, None]
RING = np.stack([np.cos(np.arange(48) * np.pi / 24), np.sin(np.arange(48) * np.pi / 24), np.zeros(48)], axis=1)
HALF = RNG.uniform(0.0, 1.0, (200, 3)) * SIZE * [0.5, 1.0, 1.0]

IRREGULAR = {
    "one": [[0.1, 0.2, 0.3]],
    "two": [[0.1, 0.1, 0.1], [0.5, 0.7, 0.2]],
    "line": np.stack([np.linspace(0.01, 0.99, 30), np.full(30, 0.3), np.full(30, 0.3)], axis=1),
    "plane": RNG.uniform(0.0, 1.0, (100, 3)) * SIZE * [1.0, 0.0, 1.0] + [0.0, 0.3, 0.0],
    "cluster": np.concatenate([RNG.uniform(0, 1, (100, 3)) * SIZE, 0.3 + 1e-3 * RNG.normal(size=(300, 3))]),
    "many scales": 0.3 + 10 ** RNG.uniform(-6, -1, (300, 1)) * RNG.normal(size=(300, 3)) / 3,
    "cubic": CUBIC * SIZE,
    "face-centred": FACE_CENTRED * SIZE,
    "face-centred, shaken 1e-15": FACE_CENTRED * SIZE + 1e-15 * RNG.normal(size=FACE_CENTRED.shape),
    "face-centred, shaken 1e-13": FACE_CENTRED * SIZE + 1e-13 * RNG.normal(size=FACE_CENTRED.shape),
    "face-centred, shaken 1e-10": FACE_CENTRED * SIZE + 1e-10 * RNG.normal(size=FACE_CENTRED.shape),
    "lattice in a corner": 0.2 * FACE_CENTRED,
    "on faces, edges, corners": lattice(5, (0.0, 0.0, 0.0)) * 5 / 4 * SIZE,
    "sphere": [0.5, 0.4, 0.3] + 0.25 * DIRECTIONS,
    "sphere and its centre": np.concatenate([[[0.5, 0.4, 0.3]], [0.5, 0.4, 0.3] + 0.25 * DIRECTIONS]),
    "ring": [0.5, 0.4, 0.3] + 0.25 * RING,
    "mirrored": np.concatenate([HALF, HALF * [-1.0, 1.0, 1.0] + [1.0, 0.0, 0.0]]),
}


@pytest.mark.parametrize("x", IRREGULAR.values(), ids=IRREGULAR)
def test_irregular(x):
    cells = cells_of(x)
    volume, skin, closure = residuals(cells)
    assert_allclose(volume.sum(), EXTENT.prod(), rtol=1e-12)
    assert volume.min() > 0.0
    assert_allclose(closure / skin.max(), 0.0, atol=1e-12)
    inner, outer = cells.bodies.inner, cells.bodies.outer
    assert (inner.body < inner.other).all()
    assert (np.diff(inner.body * len(x) + inner.other) > 0).all()
    assert (np.diff(6 * outer.body + outer.other) > 0).all()
    assert_allclose(np.bincount(-1 - outer.other, minlength=6) > 0, True)


def test_many_facets():
    """More neighbours and corners than there is room for at first."""
    cells = cells_of(IRREGULAR["sphere and its centre"])
    assert (cells.bodies.inner.body == 0).sum() == 300


def test_corners_on_faces_are_exactly_there():
    bodies = cells_of(RNG.uniform(0.0, 1.0, (200, 3)) * SIZE).bodies
    face = np.repeat(-1 - bodies.outer.other, np.diff(bodies.outer.polygons.offsets))
    coordinate = bodies.outer.polygons.points[np.arange(len(face)), face // 2]
    assert_array_equal(coordinate, EXTENT[face // 2] * (face % 2))
    assert (bodies.inner.polygons.points >= 0.0).all()
    assert (bodies.inner.polygons.points <= EXTENT).all()


def test_neighbours_share_their_corners_bit_for_bit():
    """All corners of random nuclei belong to six facets between cells, or to fewer at the surface, not to one less."""
    bodies = cells_of(RNG.uniform(0.0, 1.0, (500, 3)) * SIZE).bodies
    points, times = np.unique(bodies.inner.polygons.points, axis=0, return_counts=True)
    inside = ((points > 0.0) & (points < EXTENT)).all(axis=1)
    assert_array_equal(times[inside], 6)


@pytest.mark.parametrize("factor", [1e-4, 0.3, 100.0])
def test_guess_of_spacing_does_not_matter(factor):
    x = RNG.uniform(0.0, 1.0, (300, 3)) ** 2 * SIZE
    one = cells_of(x).bodies
    other = voronoi_cells(x, np.zeros(len(x), int), BOX, len(SURFACES), factor * guess(x)).bodies
    assert_array_equal(one.inner.other, other.inner.other)
    assert_array_equal(one.inner.polygons.points, other.inner.polygons.points)
    assert_array_equal(one.outer.polygons.points, other.outer.polygons.points)
    assert_array_equal(one.reach2, other.reach2)


def test_coinciding_nuclei():
    with pytest.raises(ValueError, match="coincide"):
        cells_of([[0.1, 0.1, 0.1], [0.5, 0.5, 0.5], [0.1, 0.1, 0.1]])


@pytest.mark.parametrize("name", SHAPES)
def test_volume_of_a_complex(name):
    assert_allclose(volume_of(shape(name).complex), shape(name).volume, rtol=1e-12)
