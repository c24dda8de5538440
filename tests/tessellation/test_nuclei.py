"""Nuclei of a case, and nuclei files."""

from __future__ import annotations

import os

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fissura.errors import InputError
from fissura.specimen import specimen_from_case
from fissura.tessellation import nuclei_from_case
from fissura.tessellation.nuclei import read_nuclei

KEY = "discretization.nuclei"
X = np.array([[0.01, 0.02, 0.02], [0.03, 0.01, 0.012]])


def test_text_and_npy(tmp_path):
    np.savetxt(tmp_path / "x.txt", X)
    np.save(tmp_path / "x.npy", X)
    (tmp_path / "one.dat").write_text("# a comment\n 0.01 0.02 0.02\n")
    assert_allclose(read_nuclei(tmp_path / "x.txt"), X, rtol=1e-15)
    assert_array_equal(read_nuclei(tmp_path / "x.npy"), X)
    assert_array_equal(read_nuclei(tmp_path / "one.dat"), X[:1])


def test_whole_numbers_become_floats(tmp_path):
    np.save(tmp_path / "x.npy", np.arange(6).reshape(2, 3))
    assert read_nuclei(tmp_path / "x.npy").dtype == np.float64


@pytest.mark.parametrize(
    "array",
    [
        np.zeros((2, 2)),
        np.zeros(3),
        np.zeros((1, 2, 3)),
        np.zeros((0, 3)),
        np.full((2, 3), np.nan),
        np.array([[0.0, np.inf, 0.0]]),
        np.array([["a", "b", "c"]]),
        np.zeros((2, 3), bool),
        np.zeros((2, 3), complex),
    ],
    ids=["two columns", "flat", "three axes", "none", "nan", "inf", "text", "bool", "complex"],
)
def test_bad_arrays(tmp_path, array):
    np.save(tmp_path / "x.npy", array)
    with pytest.raises(InputError) as caught:
        read_nuclei(tmp_path / "x.npy")
    assert caught.value.key == KEY
    assert caught.value.allowed


@pytest.mark.parametrize("suffix", ["txt", "npy"])
@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"1 2\n",
        b"1 2 3\n1 2\n",
        b"a b c\n",
        b"1 2 nan\n",
        b"\xff\xfe\x00",
        b"\x93NUMPY\x01\x00v\x00{'descr': '<f8'",
    ],
    ids=["empty", "two columns", "ragged", "words", "nan", "bytes", "broken npy"],
)
def test_bad_files(tmp_path, content, suffix):
    path = tmp_path / f"x.{suffix}"
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_nuclei(path)
    assert caught.value.key == KEY


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("x.txt.xz", b"\xfd7zXZ\x00garbage"),
        ("x.txt.gz", b"\x1f\x8bgarbage"),
        ("x.bz2", b"BZh9garbage"),
        ("x.txt", b"1 2 3\n" + b"\x00" * 100),
        ("x.txt", b"1 2 1e999\n"),
        ("x.txt", "1 2 3".encode("utf-16")),
        ("x.npy", b"\x93NUMPY\x01\x00v\x00" + b"{'descr': '<f8', 'fortran_order': False, 'shape': (10**15, 3)}"),
        ("x.npy", b"\x93NUMPY\x09\x00v\x00"),
    ],
)
def test_damaged_files(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_nuclei(path)
    assert caught.value.key == KEY
    assert caught.value.allowed


def test_no_memory_is_taken_for_what_a_file_does_not_hold(tmp_path):
    """The header promises 20 TB."""
    header = str({"descr": "<f8", "fortran_order": False, "shape": (10**12, 3)}).ljust(117) + "\n"
    path = tmp_path / "x.npy"
    path.write_bytes(b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode() + bytes(240))
    with pytest.raises(InputError, match="does not hold numbers") as caught:
        read_nuclei(path)
    assert caught.value.key == KEY


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="kinds of files that Windows does not have")
@pytest.mark.parametrize("suffix", ["txt", "npy"])
def test_what_is_no_file(tmp_path, suffix, small_case):
    os.mkfifo(tmp_path / f"pipe.{suffix}")
    (tmp_path / f"zero.{suffix}").symlink_to("/dev/zero")
    for name in (f"pipe.{suffix}", f"zero.{suffix}"):
        with pytest.raises(InputError, match="not a regular file") as caught:
            read_nuclei(tmp_path / name)
        assert caught.value.key == KEY
        with pytest.raises(InputError, match="not a file") as caught:
            small_case(tmp_path, discretization__nuclei=name)
        assert caught.value.key == KEY


def test_archive_named_npy(tmp_path):
    with open(tmp_path / "x.npy", "wb") as file:
        np.savez(file, x=X)
    with pytest.raises(InputError) as caught:
        read_nuclei(tmp_path / "x.npy")
    assert caught.value.key == KEY


def test_missing_and_folder(tmp_path, small_case):
    for path in (tmp_path / "none.txt", tmp_path):
        with pytest.raises(InputError) as caught:
            read_nuclei(path)
        assert caught.value.key == KEY
    with pytest.raises(InputError) as caught:
        small_case(tmp_path, discretization__nuclei="none.txt")
    assert caught.value.key == KEY


def test_file_of_a_case(tmp_path, small_case):
    np.savetxt(tmp_path / "x.txt", X)
    case = small_case(tmp_path, discretization__nuclei="x.txt")
    box = specimen_from_case(case)
    nuclei = nuclei_from_case(case, box)
    assert_array_equal(nuclei.x[0], X[0])
    assert (np.abs(nuclei.x - X[1]).max(axis=1) < 1e-15).any()


def test_nucleus_outside_the_specimen(tmp_path, small_case):
    np.savetxt(tmp_path / "x.txt", [*X, [0.01, 0.0601, 0.01]])
    case = small_case(tmp_path, discretization__nuclei="x.txt")
    with pytest.raises(InputError, match="nucleus 3") as caught:
        nuclei_from_case(case, specimen_from_case(case))
    assert caught.value.key == KEY


@pytest.mark.parametrize("place", [[0.0, 0.03, 0.02], [0.05, 0.06, 0.04]], ids=["face", "edge"])
def test_nucleus_on_the_surface(tmp_path, small_case, place):
    """Not inside: refused, so that round-off does not decide."""
    np.savetxt(tmp_path / "x.txt", [place])
    case = small_case(tmp_path, discretization__nuclei="x.txt")
    with pytest.raises(InputError, match="nucleus 1") as caught:
        nuclei_from_case(case, specimen_from_case(case))
    assert caught.value.key == KEY


def test_seed_of_the_case(small_case):
    cases = [small_case(seed=seed) for seed in (5, 5, 6)]
    a, b, c = (nuclei_from_case(case, specimen_from_case(case)) for case in cases)
    assert_array_equal(a.x, b.x)
    assert not np.isin(a.x[:, 0], c.x[:, 0]).any()


def test_nuclei_do_not_depend_on_what_is_done_with_them(small_case):
    """Only the specimen, the spacings and the seed count."""
    plain = small_case()
    other = small_case(adaptivity={"gamma": 0.5, "r_f": 0.03}, control__target=2e-4, load__at=0.05)
    box = specimen_from_case(plain)
    assert_array_equal(nuclei_from_case(plain, box).x, nuclei_from_case(other, specimen_from_case(other)).x)
