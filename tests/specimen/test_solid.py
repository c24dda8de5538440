"""Solids by binary space partition, and the complexes that they become."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fissura.specimen.assemble import complex_of
from fissura.specimen.domain import Domain
from fissura.specimen.planes import Planes
from fissura.specimen.shapes.prism import FACES, box, box_half_spaces, prism_half_spaces
from fissura.specimen.solid import Solid
from fissura.specimen.tetrahedra import solid_of_tetrahedra

from .complexes import check, volume

SIZE = np.array([0.35, 0.1, 0.05])


def ring(radius, count, centre=(0.0, 0.0)):
    t = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    return np.asarray(centre) + radius * np.stack([np.cos(t), np.sin(t)], axis=1)


def ring_area(radius, count):
    return 0.5 * count * radius**2 * np.sin(2.0 * np.pi / count)


def domain(solid):
    cx, surfaces = complex_of(solid)
    check(cx)
    found = Domain(cx, surfaces)
    assert_allclose(volume(cx), found.volume, rtol=1e-12)
    return found


def areas(found):
    return {name: sum(part.area for part in found.faces(name)) for name in found.surfaces}


def test_box():
    found = domain(box(SIZE))
    assert found.surfaces == FACES
    assert_allclose(found.volume, SIZE.prod(), rtol=1e-15)
    assert_allclose(found.bounds, [np.zeros(3), SIZE], atol=0)
    assert areas(found) == pytest.approx(dict(zip(FACES, np.repeat(SIZE.prod() / SIZE, 2), strict=True)))
    for axis, name in enumerate(("left", "bottom", "front")):
        assert_allclose(found.faces(name)[0].normal, -np.eye(3)[axis])
    with pytest.raises(KeyError):
        found.faces("roof")


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_cylinder_is_one_cell(axis):
    solid = Solid([-0.3] * 3, [0.3] * 3)
    solid.add(prism_half_spaces(ring(0.075, 64), 0.0, 0.2, axis), ["lateral"] * 64 + ["bottom", "top"])
    found = domain(solid)
    assert len(found.complex.low) == 1
    assert found.surfaces == ("lateral", "bottom", "top")
    assert_allclose(found.volume, 0.2 * ring_area(0.075, 64), rtol=1e-12)
    assert areas(found)["top"] == pytest.approx(ring_area(0.075, 64), rel=1e-12)
    assert_allclose(found.faces("top")[0].normal, np.eye(3)[axis])


def test_cells_open_to_each_other():
    """Two boxes that share part of a face: a T."""
    solid = Solid([0.0] * 3, [0.3, 0.2, 0.1])
    solid.add(box_half_spaces([0, 0.1, 0], [0.3, 0.2, 0.1]), FACES)
    solid.add(box_half_spaces([0.1, 0, 0], [0.2, 0.1, 0.1]), ["leg", "leg", "foot", None, "front", "back"])
    found = domain(solid)
    cx = found.complex
    assert sorted(cx.part_to[cx.part_to >= 0]) == [0, 1]
    assert_allclose(found.volume, 0.004, rtol=1e-12)
    assert areas(found) == pytest.approx(
        {
            "left": 0.01,
            "right": 0.01,
            "bottom": 0.02,
            "top": 0.03,
            "front": 0.04,
            "back": 0.04,
            "leg": 0.02,
            "foot": 0.01,
        }
    )


@pytest.mark.parametrize("shift", [0.0, 1e-13, 3e-11])
def test_planes_that_coincide_are_one(shift):
    planes = Planes(np.zeros(3), 0.35)
    first = planes.find([0.0, 2.0, 0.0], 0.2)
    assert first == (0, 1)
    assert planes.find([0.0, -1.0, shift], -0.1 + shift) == (0, -1)
    assert planes.find([0.0, 1.0, 0.0], 0.1 + 1e-6)[0] == 1
    assert planes.find([0.0, 1.0, 1e-6], 0.1)[0] == 2
    assert len(planes) == 3
    with pytest.raises(ValueError, match="no length"):
        planes.find([0.0, 0.0, 0.0], 1.0)


def test_split_changes_nothing_but_cells():
    solid = box(SIZE)
    for normal, offset in (([1.0, 0, 0], 0.1), ([1.0, 1.0, 0.2], 0.2), ([0.3, -1.0, 0.5], 0.0), ([1.0, 0, 0], 0.1)):
        solid.split(solid.planes.find(normal, offset))
    found = domain(solid)
    assert len(found.complex.low) == 7
    assert_allclose(found.volume, SIZE.prod(), rtol=1e-12)
    assert areas(found) == pytest.approx(areas(domain(box(SIZE))))


def test_split_of_chosen_cells_leaves_faces_in_parts():
    """A plane that only one of two cells is divided by: the other's face opens to both halves."""
    solid = box(SIZE)
    solid.split(solid.planes.find([1.0, 0, 0], 0.1))
    solid.split(solid.planes.find([0, 1.0, 0.3], 0.06), lambda cell: cell.shape.corner[0].max() > 0.2)
    found = domain(solid)
    cx = found.complex
    assert len(cx.low) == 3
    assert len(cx.edge_offset) == 2  # one line, seen from the undivided cell
    assert_allclose(cx.edge_normal[0], -cx.edge_normal[1], atol=0)
    assert cx.edge_offset[0] == -cx.edge_offset[1]


@pytest.mark.parametrize("count", [6, 32])
def test_blind_hole(count):
    hole = prism_half_spaces(ring(0.012, count, (0.03, 0.15)), 0.06, 1.0, axis=1)
    solid = box([0.3, 0.1, 0.2])
    assert solid.minus(hole, ["hole"] * count + ["ground", None])
    found = domain(solid)
    assert_allclose(found.volume, 0.006 - 0.04 * ring_area(0.012, count), rtol=1e-12)
    side = 2.0 * 0.012 * np.sin(np.pi / count)
    expected = {"hole": count * side * 0.04, "ground": ring_area(0.012, count)}
    expected |= {"top": 0.06 - ring_area(0.012, count), "bottom": 0.06}
    assert {name: areas(found)[name] for name in expected} == pytest.approx(expected, rel=1e-9)


def test_void_that_touches_nothing():
    solid = box(SIZE)
    assert not solid.minus(box_half_spaces([0.1, 0.1, 0.0], [0.2, 0.2, 0.05]), ["void"] * 6)  # only touches the top
    assert domain(solid).surfaces == FACES
    assert len(solid.cells) == 1


def test_half_spaces_without_a_volume():
    solid = Solid([0.0] * 3, [1.0] * 3)
    with pytest.raises(ValueError, match="no bounded volume"):
        solid.add(box_half_spaces([0] * 3, [1] * 3)[:5], FACES[:5])
    with pytest.raises(ValueError, match="no volume"):
        solid.add([*box_half_spaces([0] * 3, [1] * 3), ([1.0, 1.0, 1.0], -0.1)], [*FACES, "cut"])


def cube_of_tetrahedra(many, rng):
    """A unit cube: small cubes of six tetrahedra around a diagonal, their inner corners moved."""
    grid = np.arange(many**3).reshape((many,) * 3)
    x = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, many)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    inner = np.all((x > 0.0) & (x < 1.0), axis=1)
    x[inner] += rng.uniform(-0.1, 0.1, (inner.sum(), 3)) / many
    tets = []
    for order in permutations(range(3)):
        place = np.zeros(3, int)
        corners = [grid[:-1, :-1, :-1].ravel()]
        for axis in order:
            place[axis] = 1
            i, j, k = place
            corners.append(grid[i : many - 1 + i, j : many - 1 + j, k : many - 1 + k].ravel())
        tets.append(np.stack(corners, axis=1))
    return x, rng.permutation(np.concatenate(tets))


def test_tetrahedra():
    x, tets = cube_of_tetrahedra(4, np.random.default_rng(1))
    low = {tuple(sorted(t)): "ground" for t in _triangles(tets) if (x[list(t), 2] == 0.0).all()}
    found = domain(solid_of_tetrahedra(x, tets, low))
    assert found.surfaces == ("ground", "surface")
    assert_allclose(found.volume, 1.0, rtol=1e-12)
    assert areas(found) == pytest.approx({"ground": 1.0, "surface": 5.0})
    assert len(found.complex.edge_offset) == 0
    assert_allclose(found.complex.corner.T, x[_turned(x, tets)].reshape(-1, 3), atol=0)


def test_tetrahedra_minus_a_void_and_split():
    x, tets = cube_of_tetrahedra(3, np.random.default_rng(2))
    solid = solid_of_tetrahedra(x, tets)
    solid.split(solid.planes.find([0.2, 1.0, 0.1], 0.6))
    assert solid.minus(box_half_spaces([0.4, 0.4, -1.0], [0.7, 0.8, 2.0]), ["hole"] * 6)
    found = domain(solid)
    assert_allclose(found.volume, 1.0 - 0.12, rtol=1e-11)
    assert areas(found)["hole"] == pytest.approx(1.4, rel=1e-6)


def _triangles(tets):
    return [tuple(np.delete(t, k)) for t in tets for k in range(4)]


def _turned(x, tets):
    tets = tets.copy()
    turned = np.linalg.det(x[tets[:, 1:]] - x[tets[:, :1]]) < 0.0
    tets[turned] = tets[turned][:, [1, 0, 2, 3]]
    return tets


def test_cell_of():
    rng = np.random.default_rng(3)
    solid = box(SIZE)
    solid.minus(prism_half_spaces(ring(0.02, 12, (0.1, 0.05)), -1.0, 1.0), ["hole"] * 14)
    found = domain(solid)
    x = rng.uniform(-0.01, SIZE + 0.01, (4000, 3))
    cells = found.cell_of(x)
    inside = np.all((x >= 0.0) & (x <= SIZE), axis=1)
    normal, offset = (np.array(v) for v in zip(*prism_half_spaces(ring(0.02, 12, (0.1, 0.05)), -1.0, 1.0), strict=True))
    inside &= (x @ normal.T > offset).any(axis=1)
    assert (found.contains(x) == inside).all()
    assert (cells[~inside] == -1).all()
    cx = found.complex
    for k in range(len(cx.low)):
        rows = slice(cx.plane_start[k], cx.plane_start[k + 1])
        assert (x[cells == k] @ cx.normal[rows].T <= cx.offset[rows]).all()
    assert found.contains(np.array([[0.0, 0.0, 0.0], SIZE])).all()
    assert not found.contains(np.array([[-1e-12, 0.01, 0.01], [0.05, 0.1001, 0.01]])).any()
