import numpy as np
import pytest

from fissura.errors import InputError
from fissura.results.state import FIELDS, read_state, write_state

from .synthetic import random_points, snapshot, step, voronoi_structure

SIZE = np.array([0.12, 0.05, 0.05])


@pytest.fixture
def path(tmp_path):
    return tmp_path / "state_last.npz"


def test_round_trip(path):
    t = voronoi_structure(random_points(20, SIZE), SIZE, fine=np.arange(20) < 8)
    shot = snapshot(t, displacement=np.random.default_rng(1).normal(size=(20, 6)))
    write_state(path, step(17, 3e-5, 120.0, shot))
    number, read = read_state(path)
    assert number == 17
    for name in FIELDS:
        np.testing.assert_array_equal(getattr(read, name), getattr(shot, name))
    again = read.tessellation
    assert again.surface.names == t.surface.names
    for owner in ("contacts", "surface"):
        for name, value in vars(getattr(t, owner)).items():
            if isinstance(value, np.ndarray):
                copy = getattr(getattr(again, owner), name)
                np.testing.assert_array_equal(copy, value)
                assert copy.dtype == value.dtype
        for name, value in vars(getattr(t, owner).polygons).items():
            np.testing.assert_array_equal(getattr(getattr(again, owner).polygons, name), value)


def test_nothing_is_pickled_and_the_version_is_stored(path):
    write_state(path, step(1, 1e-6, 1.0))
    with np.load(path, allow_pickle=False) as archive:
        assert archive["format"] == "fissura-state"
        assert archive["format_version"] == 1
        assert all(archive[name].dtype != object for name in archive.files)


def test_broken_files(path):
    with pytest.raises(InputError, match="cannot be read"):
        read_state(path)
    np.savez(path, a=1)
    with pytest.raises(InputError, match="version unknown"):
        read_state(path)
    np.savez(path, format="fissura-state", format_version=99)
    with pytest.raises(InputError, match="version 99"):
        read_state(path)
    np.savez(path, format="fissura-state", format_version=1)
    with pytest.raises(InputError, match="lacks the array"):
        read_state(path)
    write_state(path, step(1, 1e-6, 1.0))
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(InputError, match=r"damaged|cannot be read"):
        read_state(path)
