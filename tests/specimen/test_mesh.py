"""Specimens from meshes of other programs."""

from __future__ import annotations

import importlib.util

import meshio
import numpy as np
import pytest
from numpy.testing import assert_allclose

from fissura.case import case_from_dict
from fissura.errors import InputError
from fissura.specimen import domain_from_case
from fissura.specimen.shapes import mesh as mesh_shape
from fissura.specimen.tetrahedra import OPPOSITE, triangles_of

from .complexes import check
from .test_solid import areas, cube_of_tetrahedra


@pytest.fixture
def domain(small_case, tmp_path):
    def build(file, minus=(), notch=(), l_f=0.008, **specimen):
        changes = {"minus": list(minus), "notch": list(notch), "discretization": {"l_f": l_f}}
        case = small_case(folder=tmp_path, specimen={"mesh": str(file), **specimen}, **changes)
        return domain_from_case(case)

    return build


def cube(many=3):
    return cube_of_tetrahedra(many, np.random.default_rng(5))


def skin(x, tets):
    """Triangles of the surface, and those on which the first coordinate is 0."""
    triangles, _, count = triangles_of(tets)
    outer = triangles[count == 1]
    return outer, (x[outer][:, :, 0] == 0.0).all(axis=1)


def test_physical_groups_name_surfaces(domain, tmp_path):
    x, tets = cube()
    outer, left = skin(x, tets)
    tags = [np.ones(len(tets), int), np.where(left, 7, 8)]
    cells = [("tetra", tets), ("triangle", outer)]
    groups = {"left": np.array([7, 2]), "rest": np.array([8, 2]), "concrete": np.array([1, 3])}
    found = meshio.Mesh(
        120.0 * x, cells, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=groups
    )
    meshio.gmsh.write(tmp_path / "cube.msh", found, fmt_version="2.2", binary=False)
    built = domain("cube.msh", unit="mm")
    check(built.complex)
    assert set(built.surfaces) == {"left", "rest"}
    assert_allclose(built.volume, 0.12**3, rtol=1e-9)
    assert areas(built) == pytest.approx({"left": 0.12**2, "rest": 5 * 0.12**2}, rel=1e-9)
    assert built.notices == ()
    assert built.smallest_section == pytest.approx(0.12**2, rel=1e-6)


def test_sets_of_cells_name_surfaces(domain, tmp_path):
    x, tets = cube()
    outer, left = skin(x, tets)
    sets = {"end": [np.empty(0, int), np.flatnonzero(left)]}
    meshio.write(tmp_path / "cube.inp", meshio.Mesh(0.1 * x, [("tetra", tets), ("triangle", outer)], cell_sets=sets))
    assert areas(domain("cube.inp")) == pytest.approx({"end": 0.01, "surface": 0.05}, rel=1e-9)


def test_the_unit_is_that_of_the_mesh(domain, tmp_path):
    x, tets = cube(2)
    meshio.write(tmp_path / "cube.vtu", meshio.Mesh(100.0 * x, [("tetra", tets)]))
    assert_allclose(domain("cube.vtu", unit="mm").volume, 1e-3, rtol=1e-9)
    (notice,) = domain("cube.vtu", scale=2.0).notices
    assert "200 m large" in notice.problem
    assert notice.key == "specimen.mesh"
    (notice,) = domain("cube.vtu", l_f=1e-5, scale=1e-6).notices
    assert "below 1 mm" in notice.problem


def test_curved_tetrahedra_have_corners(domain, tmp_path):
    x, tets = cube(2)
    middles = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
    extra = np.concatenate([0.5 * (x[tets[:, a]] + x[tets[:, b]]) for a, b in middles])
    numbers = len(x) + np.arange(len(extra)).reshape(6, -1).T
    ten = np.concatenate([tets, numbers], axis=1)
    meshio.write(tmp_path / "cube.vtu", meshio.Mesh(0.1 * np.concatenate([x, extra]), [("tetra10", ten)]))
    assert_allclose(domain("cube.vtu").volume, 1e-3, rtol=1e-9)


def test_notches_and_voids_in_a_mesh(domain, tmp_path):
    x, tets = cube(3)
    meshio.write(tmp_path / "cube.vtu", meshio.Mesh(0.1 * x, [("tetra", tets)]))
    hole = {"cylinder": {"diameter": 0.03, "through": [0.05, 0.05, 0.05]}, "name": "hole"}
    found = domain("cube.vtu", minus=[hole])
    check(found.complex)
    assert_allclose(found.volume, 1e-3 - np.pi * 0.015**2 * 0.1, rtol=1e-9)
    for width in (0.0, 0.002):
        notch = {"on": "surface", "at": [0.05, 0.0, 0.05], "depth": 0.03, "width": width}
        found = domain("cube.vtu", notch=[notch])
        check(found.complex)
        assert_allclose(found.volume, 1e-3 - width * 0.03 * 0.1, rtol=1e-9)
        assert areas(found)["notch"] == pytest.approx(0.1 * (2 * 0.03 + width), rel=1e-6)
        ruled = np.diff(found.complex.rule_start)
        low, high = found.complex.low[:, 1], found.complex.high[:, 1]
        assert (ruled[high <= 0.03 + 1e-9] == 1).all()
        assert (ruled[low >= 0.03 - 1e-9] == 0).all()
        assert ((high <= 0.03 + 1e-9) | (low >= 0.03 - 1e-9)).all()


def test_slivers_are_a_warning(domain, tmp_path):
    x, tets = cube(3)
    x[13] = x[0] + [1e-4, 1e-4, 5e-5]  # the middle of the cube almost on an edge
    volume = np.linalg.det(x[tets[:, 1:]] - x[tets[:, :1]])
    assert abs(volume).min() > 0
    meshio.write(tmp_path / "cube.vtu", meshio.Mesh(0.1 * x, [("tetra", tets)]))
    found = domain("cube.vtu")
    assert [notice.key for notice in found.notices] == ["specimen.mesh"]
    assert "almost flat" in found.notices[0].problem


def spoiled(kind):
    x, tets = cube(3)
    if kind == "no volume":
        tets = np.concatenate([tets, [[0, 1, 2, 2]]])
    elif kind == "inverted":
        inner = 13  # the middle corner, moved out through the opposite side
        x[inner] = [1.6, 0.5, 0.5]
    elif kind == "overlap":
        moved = 0.3 + 0.5 * x
        tets = np.concatenate([tets, tets + len(x)])
        x = np.concatenate([x, moved])
    elif kind == "thrice":
        tets = np.concatenate([tets, [[*sorted(tets[0, :3]), len(x)], [*sorted(tets[0, :3]), len(x) + 1]]])
        x = np.concatenate([x, [[0.4, 0.1, 3.0], [0.2, 0.1, -3.0]]])
    elif kind == "apart":
        tets = np.concatenate([tets, tets + len(x)])
        x = np.concatenate([x, x + np.array([2.0, 0.0, 0.0])])
    elif kind == "unmerged":  # two halves that only seem to touch: the corners between them are there twice
        tets = np.concatenate([tets, tets + len(x)])
        x = np.concatenate([x, x + np.array([1.0, 0.0, 0.0])])
    elif kind == "not finite":
        x[13] = np.nan
    elif kind == "missing corner":
        tets[0, 0] = 10**6
    return x, tets


@pytest.mark.parametrize(
    ("kind", "problem"),
    [
        ("no volume", "have no volume"),
        ("inverted", "inverted or overlap"),
        ("overlap", "overlap at"),
        ("thrice", "more than two tetrahedra share"),
        ("apart", "falls into 2 parts"),
        ("unmerged", "falls into 2 parts"),
        ("not finite", "not finite"),
    ],
)
def test_meshes_that_cannot_be_used(domain, tmp_path, kind, problem):
    x, tets = spoiled(kind)
    meshio.write(tmp_path / "cube.vtu", meshio.Mesh(0.1 * x, [("tetra", tets)]))
    with pytest.raises(InputError, match=problem) as caught:
        domain("cube.vtu")
    assert caught.value.key == "specimen.mesh"
    assert caught.value.allowed


def test_too_many_tetrahedra(domain, tmp_path, monkeypatch):
    monkeypatch.setattr(mesh_shape, "MOST_TETRAHEDRA", 10)
    x, tets = cube(3)
    meshio.write(tmp_path / "cube.vtu", meshio.Mesh(0.1 * x, [("tetra", tets)]))
    with pytest.raises(InputError, match="48 tetrahedra") as caught:
        domain("cube.vtu")
    assert "10" in caught.value.allowed


@pytest.mark.parametrize(
    ("name", "content", "problem"),
    [
        ("part.msh", "no mesh at all", "cannot be read"),
        ("part.vtu", "", "cannot be read"),
        ("part.unknown", "x", "cannot be read"),
        ("part.inp", "*NODE\n1, 0., 0., 0.\n", "no tetrahedra"),
    ],
)
def test_files_that_hold_no_mesh(domain, tmp_path, name, content, problem, capfd):
    (tmp_path / name).write_text(content)
    with pytest.raises(InputError, match=problem) as caught:
        domain(name)
    assert caught.value.key == "specimen.mesh"
    assert capfd.readouterr() == ("", "")


def test_surfaces_alone(domain, tmp_path):
    x, tets = cube(2)
    outer, _ = skin(x, tets)
    meshio.write(tmp_path / "shell.vtu", meshio.Mesh(x, [("triangle", outer)]))
    with pytest.raises(InputError, match="no tetrahedra, but triangle"):
        domain("shell.vtu")


@pytest.mark.parametrize("ending", ["stl", "STEP"])
def test_a_surface_needs_a_mesher(domain, tmp_path, ending, monkeypatch):
    (tmp_path / f"part.{ending}").write_text("solid part\nendsolid part\n")
    monkeypatch.setattr(mesh_shape.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match="gmsh, which would mesh it, is not installed") as caught:
        domain(f"part.{ending}")
    assert caught.value.key == "specimen.mesh"
    assert "pip install gmsh" in caught.value.allowed


@pytest.mark.skipif(importlib.util.find_spec("gmsh") is None, reason="needs gmsh")
def test_a_closed_surface_is_meshed(domain, tmp_path):
    x, tets = cube(2)
    outer = np.concatenate([_turned(x, tets)[:, f] for f in OPPOSITE])
    key = np.sort(outer, axis=1)
    _, first, count = np.unique(key, axis=0, return_index=True, return_counts=True)
    meshio.write(tmp_path / "cube.stl", meshio.Mesh(100 * x, [("triangle", outer[first[count == 1]])]))
    assert_allclose(domain("cube.stl", unit="mm").volume, 1e-3, rtol=1e-6)
    meshio.write(tmp_path / "open.stl", meshio.Mesh(100 * x, [("triangle", outer[first[count == 1]][1:])]))
    with pytest.raises(InputError, match="gmsh"):
        domain("open.stl", unit="mm")


@pytest.mark.skipif(importlib.util.find_spec("gmsh") is None, reason="needs gmsh")
def test_a_model_is_meshed(domain, tmp_path):
    import gmsh

    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, 60, 75)
    gmsh.model.occ.synchronize()
    gmsh.write(str(tmp_path / "disc.step"))
    gmsh.finalize()
    found = domain("disc.step", unit="mm")
    check(found.complex)
    assert_allclose(found.volume, np.pi * 0.075**2 * 0.06, rtol=0.03)
    assert len(found.complex.low) < 20_000


def _turned(x, tets):
    tets = tets.copy()
    turned = np.linalg.det(x[tets[:, 1:]] - x[tets[:, :1]]) < 0.0
    tets[turned] = tets[turned][:, [1, 0, 2, 3]]
    return tets


def test_a_case_with_a_mesh_is_read_again_from_its_values(small_case, tmp_path):
    x, tets = cube(2)
    meshio.write(tmp_path / "cube.vtu", meshio.Mesh(100.0 * x, [("tetra", tets)]))
    case = small_case(folder=tmp_path, specimen={"mesh": "cube.vtu", "unit": "mm"}, notch=[])
    again = case_from_dict(case.model_dump(mode="json"))
    assert again == case
    assert again.specimen.scale == 1e-3
