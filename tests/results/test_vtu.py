import meshio
import numpy as np
import pytest
import pyvista

from fissura.files.archive import SAMPLE, level
from fissura.results.vtu import BLOCK, POLYGON, Grid, write_vtu


def triangles(count, **changes):
    points = np.random.default_rng(5).normal(size=(3 * count, 3))
    values = {
        "points": points,
        "cell_type": POLYGON,
        "corners": np.arange(3 * count),
        "ends": 3 * np.arange(1, count + 1),
        "point_data": {"vector": 2.0 * points},
        "cell_data": {"number": np.arange(count), "large": np.arange(count) + 2**40, "flag": np.ones(count, np.uint8)},
    }
    return Grid(**(values | changes))


@pytest.mark.parametrize("count", [1, 20_000, BLOCK // 24], ids=["one", "last block shorter", "whole blocks"])
def test_arrays_come_back_bit_for_bit(tmp_path, count):
    grid = triangles(count)
    write_vtu(tmp_path / "a.vtu", grid)
    back = pyvista.read(tmp_path / "a.vtu")
    assert back.n_cells == count
    np.testing.assert_array_equal(back.points, grid.points)
    np.testing.assert_array_equal(back.cell_connectivity, grid.corners)
    np.testing.assert_array_equal(back.point_data["vector"], grid.point_data["vector"])
    for name, values in grid.cell_data.items():
        np.testing.assert_array_equal(back.cell_data[name], values)


def test_meshio_reads_polygons(tmp_path):
    grid = triangles(50)
    write_vtu(tmp_path / "a.vtu", grid)
    back = meshio.read(tmp_path / "a.vtu")
    np.testing.assert_array_equal(back.points, grid.points)
    (block,) = back.cells
    np.testing.assert_array_equal(block.data.ravel(), grid.corners)
    np.testing.assert_array_equal(back.point_data["vector"], grid.point_data["vector"])
    for name, values in grid.cell_data.items():
        np.testing.assert_array_equal(back.cell_data[name][0], values)


def test_a_file_is_there_as_a_whole_or_not_at_all(tmp_path):
    write_vtu(tmp_path / "a.vtu", triangles(1))
    good = (tmp_path / "a.vtu").read_bytes()
    with pytest.raises(KeyError):
        write_vtu(tmp_path / "a.vtu", triangles(1, cell_data={"words": np.array(["a"])}))
    assert [path.name for path in tmp_path.iterdir()] == ["a.vtu"]
    assert (tmp_path / "a.vtu").read_bytes() == good


def test_integers_take_32_bits_where_they_fit(tmp_path):
    write_vtu(tmp_path / "a.vtu", triangles(2))
    head = (tmp_path / "a.vtu").read_bytes().partition(b"AppendedData")[0].decode()
    assert 'type="Int32" Name="number"' in head
    assert 'type="Int64" Name="large"' in head
    assert 'type="UInt8" Name="flag"' in head


def test_names_are_escaped(tmp_path):
    write_vtu(tmp_path / "a.vtu", triangles(2, cell_data={'a < "b" & c': np.zeros(2)}))
    assert pyvista.read(tmp_path / "a.vtu").cell_data.keys() == ['a < "b" & c']


def test_arrays_without_values(tmp_path):
    write_vtu(tmp_path / "a.vtu", triangles(0))
    assert pyvista.read(tmp_path / "a.vtu").n_cells == 0


def test_noise_is_stored_and_order_is_compressed():
    assert level(np.random.default_rng(1).normal(size=1000)) == 0
    assert level(np.arange(1000)) == 1
    assert level(np.zeros((50, 3))) == 1


def test_only_the_start_is_looked_at():
    values = np.zeros(3 * SAMPLE // 8)
    values[: SAMPLE // 8] = np.random.default_rng(1).normal(size=SAMPLE // 8)
    assert level(values) == 0
