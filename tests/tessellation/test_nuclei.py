"""Nuclei of a case, and nuclei files."""

from __future__ import annotations

import os

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fissura.errors import InputError
from fissura.specimen import domain_from_case
from fissura.tessellation import discretize, nuclei_from_case
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
    box = domain_from_case(case)
    nuclei = nuclei_from_case(case, box)
    assert_array_equal(nuclei.x[0], X[0])
    assert (np.abs(nuclei.x - X[1]).max(axis=1) < 1e-15).any()


def test_nucleus_outside_the_specimen(tmp_path, small_case):
    np.savetxt(tmp_path / "x.txt", [*X, [0.01, 0.0601, 0.01]])
    case = small_case(tmp_path, discretization__nuclei="x.txt")
    with pytest.raises(InputError, match="nucleus 3") as caught:
        nuclei_from_case(case, domain_from_case(case))
    assert caught.value.key == KEY


@pytest.mark.parametrize("place", [[0.0, 0.03, 0.02], [0.05, 0.06, 0.04]], ids=["face", "edge"])
def test_nucleus_on_the_surface(tmp_path, small_case, place):
    """Not inside: refused, so that round-off does not decide."""
    np.savetxt(tmp_path / "x.txt", [place])
    case = small_case(tmp_path, discretization__nuclei="x.txt")
    with pytest.raises(InputError, match="nucleus 1") as caught:
        nuclei_from_case(case, domain_from_case(case))
    assert caught.value.key == KEY


def test_seed_of_the_case(small_case):
    cases = [small_case(seed=seed) for seed in (5, 5, 6)]
    a, b, c = (nuclei_from_case(case, domain_from_case(case)) for case in cases)
    assert_array_equal(a.x, b.x)
    assert not np.isin(a.x[:, 0], c.x[:, 0]).any()


def test_nuclei_do_not_depend_on_what_is_done_with_them(small_case):
    """Only the specimen, the spacings and the seed count."""
    plain = small_case()
    other = small_case(adaptivity={"gamma": 0.5, "r_f": 0.03}, control__target=2e-4, load__at=0.05)
    box = domain_from_case(plain)
    assert_array_equal(nuclei_from_case(plain, box).x, nuclei_from_case(other, domain_from_case(other)).x)


# All nuclei of a file are used, or it is refused


def placed(case):
    return nuclei_from_case(case, domain_from_case(case))


def saved(tmp_path, small_case, x, **changes):
    np.save(tmp_path / "x.npy", np.asarray(x))
    return small_case(tmp_path, discretization__nuclei="x.npy", **changes)


def grid(step, size=(0.12, 0.06, 0.04), jitter=0.0):
    """A regular grid, every point moved by up to a share of its step."""
    axes = [step * (0.5 + np.arange(int(length / step + 1e-9))) for length in size]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return x + jitter * step * np.random.default_rng(0).uniform(-0.5, 0.5, x.shape)


@pytest.mark.parametrize("scale", [1.0, 1.0 / 3.0, 7.0])
def test_a_regular_grid_is_used_as_it_is(tmp_path, small_case, scale):
    """Its step is l_f but for round-off."""
    size = [scale * length for length in (0.12, 0.06, 0.04)]
    x = grid(scale * 0.01, size)
    assert len(x) == 288
    changes = {"specimen__size": size, "notch": None, "discretization__l_f": scale * 0.01, "discretization__l_c": scale}
    nuclei = placed(saved(tmp_path, small_case, x, **changes))
    assert_array_equal(nuclei.x[:288], x)
    assert nuclei.given == 288


def test_a_jittered_grid_is_refused(tmp_path, small_case):
    case = saved(tmp_path, small_case, grid(0.01, jitter=0.4), notch=None, discretization__l_f=0.01)
    with pytest.raises(
        InputError, match=r"\d+ of 288 nuclei cannot be used; nucleus \d+ at .* less than l_f"
    ) as caught:
        placed(case)
    assert caught.value.key == KEY
    case = saved(tmp_path, small_case, grid(0.01, jitter=0.4), notch=None, discretization__l_f=0.006)
    assert placed(case).given == 288


@pytest.mark.parametrize(
    ("x", "notch", "problem"),
    [
        (
            [[0.01, 0.02, 0.02], [0.0179, 0.02, 0.02]],
            {},
            "1 of 2 .* nucleus 2 .* is 7.9 mm from nucleus 1, less than l_f",
        ),
        ([[0.01, 0.02, 0.02], [0.01, 0.02, 0.02]], {}, "1 of 2 .* nucleus 2 .* is 0 mm from nucleus 1"),
        ([[0.061, 0.01, 0.02]], {"width": 0.004}, "nucleus 1 at .* is not inside the specimen"),
        ([[0.06, 0.01, 0.02]], {}, "nucleus 1 at .* is not inside the specimen"),  # on a cut
    ],
)
def test_nuclei_that_cannot_be_used(tmp_path, small_case, x, notch, problem):
    changes = {f"notch__{key}": value for key, value in notch.items()}
    with pytest.raises(InputError, match=problem) as caught:
        placed(saved(tmp_path, small_case, x, **changes))
    assert caught.value.key == KEY


def test_nuclei_may_lie_anywhere_at_a_notch(tmp_path, small_case):
    """Close to its plane, in it ahead of the tip, and just beside its walls."""
    x = [[0.0601, 0.02, 0.02], [0.06, 0.031, 0.02], [0.0599, 0.012, 0.02]]
    nuclei = placed(saved(tmp_path, small_case, x))
    assert_array_equal(nuclei.x[:3], x)
    assert nuclei.given == 3


def test_regular_nuclei_on_open_faces(tmp_path, small_case):
    """On the level of the tip, and in the plane of the notch ahead of it."""
    axes = [np.arange(0.01, 0.12, 0.01), [0.01, 0.02, 0.03, 0.04, 0.05], [0.005, 0.015, 0.025, 0.035]]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    x = x[(np.abs(x[:, 0] - 0.06) > 1e-3) | (x[:, 1] > 0.031)]
    case = saved(tmp_path, small_case, x)
    nuclei = placed(case)
    assert_array_equal(nuclei.x[: len(x)], x)
    domain = domain_from_case(case)
    t = discretize(nuclei, domain, np.zeros(len(nuclei)))
    assert_allclose(t.volume.sum(), domain.volume, rtol=1e-10)


@pytest.mark.parametrize("notch", [{}, {"width": 0.004}, None])
def test_nuclei_of_another_run_are_all_used(tmp_path, small_case, notch):
    changes = {"notch": None} if notch is None else {f"notch__{key}": value for key, value in notch.items()}
    first = placed(small_case(seed=3, **changes))
    again = placed(saved(tmp_path, small_case, first.x, **changes))
    assert (again.given, len(again)) == (len(first), len(first))
    order = np.lexsort(first.x.T), np.lexsort(again.x.T)
    assert_allclose(again.x[order[1]], first.x[order[0]], atol=1e-15)


def test_counts_in_check_and_summary(tmp_path, small_case):
    from fissura.api.check import check
    from fissura.results.curve import columns
    from fissura.results.summary import build_summary
    from fissura.simulation.loop import Simulation

    first = placed(small_case(notch=None)).x
    case = saved(tmp_path, small_case, first[::2], notch=None, control__target=1e-5)
    found = check(case)
    assert found.nuclei_given == len(first[::2])
    rows = dict(found.table())
    assert rows["nuclei from the file"] == f"{len(first[::2])}, and {found.bodies_full - len(first[::2])} added"
    simulation = Simulation(case)
    summary = build_summary(simulation, columns([]), status="finished", message="", cpu_s=1.0, wall_s=1.0, memory=1e9)
    assert summary["nuclei_given"] == len(first[::2])
    assert summary["nuclei_given"] + summary["nuclei_added"] == summary["bodies_full"] == simulation.bodies_full
    assert "nuclei from the file" not in dict(check(small_case(notch=None)).table())
