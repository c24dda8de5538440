import xml.etree.ElementTree as ElementTree

import meshio
import numpy as np
import pytest
import pyvista

from fissura.results.vtk import write_series, write_snapshot

from .synthetic import random_points, snapshot, stack, voronoi_structure

SIZE = np.array([0.12, 0.05, 0.05])
FORMULA = {"XX": (0, 0), "YY": (1, 1), "ZZ": (2, 2), "XY": (0, 1), "YZ": (1, 2), "XZ": (0, 2)}


@pytest.fixture(scope="module")
def shot():
    t = voronoi_structure(random_points(60, SIZE), SIZE, fine=np.arange(60) % 2 == 0)
    rng = np.random.default_rng(2)
    state = snapshot(t, displacement=rng.normal(size=(60, 6)) * 1e-4, opening=rng.uniform(size=len(t.contacts)))
    stress = rng.normal(size=(60, 3, 3))
    state.stress[:] = stress + stress.transpose(0, 2, 1)
    state.traction[:] = rng.normal(size=state.traction.shape)
    return state


@pytest.fixture(scope="module")
def files(shot, tmp_path_factory):
    folder = tmp_path_factory.mktemp("vtk")
    write_snapshot(folder, 12, shot)
    return pyvista.read(folder / "bodies_0012.vtu"), pyvista.read(folder / "contacts_0012.vtu")


def test_bodies_are_closed_polyhedra_of_the_right_volume(files, shot):
    bodies, _ = files
    assert bodies.n_cells == 60
    assert set(bodies.celltypes) == {pyvista.CellType.POLYHEDRON}
    # VTK's own volume of a polyhedron comes from a tetrahedralization that drops slivers here and there,
    # so its sizes get a looser bound than the closed surface.
    volumes = bodies.compute_cell_sizes()["Volume"]
    of_body = shot.tessellation.volume[bodies.cell_data["body"]]
    np.testing.assert_allclose(volumes, of_body, rtol=0.05)
    assert np.median(np.abs(volumes / of_body - 1)) < 1e-9
    for k in range(60):
        surface = bodies.extract_cells([k]).extract_surface(algorithm=None).triangulate()
        assert surface.n_open_edges == 0
        assert surface.volume == pytest.approx(of_body[k], rel=1e-6)


def test_meshio_reads_the_same_bodies(tmp_path, shot):
    write_snapshot(tmp_path, 12, shot)
    bodies = meshio.read(tmp_path / "bodies_0012.vtu")
    assert sum(len(block.data) for block in bodies.cells) == 60
    assert {block.type.rstrip("0123456789") for block in bodies.cells} == {"polyhedron"}
    for block, body, volume in zip(bodies.cells, bodies.cell_data["body"], bodies.cell_data["volume"], strict=True):
        np.testing.assert_array_equal(volume, shot.tessellation.volume[body])
        for k, faces in zip(body, block.data, strict=True):  # the data belong to the right bodies
            points = bodies.points[np.unique(np.concatenate(faces))]
            inside = shot.tessellation.x[k]
            assert (points.min(axis=0) < inside).all()
            assert (points.max(axis=0) > inside).all()
    contacts = meshio.read(tmp_path / "contacts_0012.vtu")
    owners = np.concatenate([np.ravel(values) for values in contacts.cell_data["contact"]])
    assert sorted(owners) == list(range(len(shot.tessellation.contacts)))


def test_cubes_have_exact_volumes(tmp_path):
    write_snapshot(tmp_path, 1, snapshot(stack()))
    bodies = pyvista.read(tmp_path / "bodies_0001.vtu")
    np.testing.assert_allclose(bodies.compute_cell_sizes()["Volume"], [1e-6, 1e-6], rtol=1e-12)


def test_body_arrays(files, shot):
    bodies, _ = files
    t, body = shot.tessellation, bodies.cell_data["body"]
    np.testing.assert_array_equal(np.sort(body), np.arange(60))
    np.testing.assert_allclose(bodies.cell_data["displacement"], shot.displacement[body, :3])
    np.testing.assert_allclose(bodies.cell_data["rotation"], shot.displacement[body, 3:])
    np.testing.assert_allclose(bodies.cell_data["volume"], t.volume[body])
    np.testing.assert_array_equal(bodies.cell_data["nucleus"], t.nucleus[body])
    np.testing.assert_array_equal(bodies.cell_data["fine"], t.fine[body])
    np.testing.assert_array_equal(bodies.cell_data["criterion"], shot.criterion[body])
    for component, (i, j) in enumerate(FORMULA.values()):
        np.testing.assert_allclose(bodies.cell_data["stress"][:, component], shot.stress[body, i, j])
    largest = [max(np.linalg.eigvals(s).real) for s in shot.stress[body]]
    np.testing.assert_allclose(bodies.cell_data["largest_principal_stress"], largest)


def test_warping_moves_every_body_rigidly(files, shot):
    bodies, _ = files
    for k in (0, 17, 59):
        cell = bodies.extract_cells(np.flatnonzero(bodies.cell_data["body"] == k))
        arm = cell.points - shot.tessellation.x[k]
        u, theta = shot.displacement[k, :3], shot.displacement[k, 3:]
        np.testing.assert_allclose(cell.point_data["displacement"], u + np.cross(theta, arm), atol=1e-15)


def test_contact_polygons_have_the_right_areas(files, shot):
    _, contacts = files
    c = shot.tessellation.contacts
    owner = contacts.cell_data["contact"]
    np.testing.assert_array_equal(np.sort(owner), np.arange(len(c)))
    areas = contacts.compute_cell_sizes()["Area"]
    np.testing.assert_allclose(areas, c.area[owner], rtol=1e-5, atol=1e-12)


def test_contact_arrays_follow_the_cells(files, shot):
    _, contacts = files
    c = shot.tessellation.contacts
    owner = contacts.cell_data["contact"]
    for name, expected in {
        "opening": shot.opening,
        "damage": shot.damage,
        "traction_NML": shot.traction,
        "strain_NML": shot.strain,
        "length": c.length,
        "area": c.area,
        "fine": c.fine,
    }.items():
        np.testing.assert_allclose(contacts.cell_data[name], expected[owner])
    frame = np.concatenate([c.normal[:, None], shot.tangents], axis=1)
    back = np.einsum("mkc,mc->mk", frame[owner], contacts.cell_data["traction"])
    np.testing.assert_allclose(back, shot.traction[owner], atol=1e-12)


def test_contacts_move_with_the_mean_of_their_bodies(tmp_path):
    q = np.zeros((2, 6))
    q[1, 0] = 2e-3
    write_snapshot(tmp_path, 1, snapshot(stack(), displacement=q))
    contacts = pyvista.read(tmp_path / "contacts_0001.vtu")
    np.testing.assert_allclose(contacts.point_data["displacement"], np.tile([1e-3, 0, 0], (4, 1)))


def test_a_facet_of_two_polygons_gives_two_cells(tmp_path):
    t = stack()
    p = t.contacts.polygons.points
    middle = (p[0] + p[1]) / 2, (p[2] + p[3]) / 2
    halves = np.array([p[0], middle[0], middle[1], p[3], middle[0], p[1], p[2], middle[1]])
    split = type(t.contacts.polygons)(halves, np.array([0, 4, 8]), np.array([0, 0]))
    object.__setattr__(t.contacts, "polygons", split)
    write_snapshot(tmp_path, 1, snapshot(t, opening=np.array([5e-6])))
    contacts = pyvista.read(tmp_path / "contacts_0001.vtu")
    assert contacts.cell_data["opening"].tolist() == [5e-6, 5e-6]
    assert contacts.compute_cell_sizes()["Area"].sum() == pytest.approx(1e-4)
    assert pyvista.read(tmp_path / "bodies_0001.vtu").n_cells == 2


def test_series_list_the_files_by_step_where_the_gauge_turns_back(tmp_path):
    for number in (3, 10, 12):
        write_snapshot(tmp_path, number, snapshot(stack()))
    write_series(tmp_path, {3: 2e-5, 10: 1e-5, 12: 3e-5})
    assert pyvista.get_reader(tmp_path / "bodies.pvd").time_values == [3, 10, 12]


def test_series_list_the_files_by_gauge(tmp_path):
    for number in (3, 10):
        write_snapshot(tmp_path, number, snapshot(stack()))
    write_series(tmp_path, {10: 2e-5, 3: 1e-5})
    reader = pyvista.get_reader(tmp_path / "bodies.pvd")
    assert reader.time_values == [1e-5, 2e-5]
    assert reader.read()[0].n_cells == 2
    entries = ElementTree.parse(tmp_path / "contacts.pvd").getroot().iter("DataSet")
    assert [e.get("file") for e in entries] == ["contacts_0003.vtu", "contacts_0010.vtu"]
