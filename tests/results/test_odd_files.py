"""Result folders with files that are damaged, of another kind, or not files at all."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fissura.errors import InputError
from fissura.files.archive import write_archive
from fissura.results import Result
from fissura.results.history import FILE, read_history
from fissura.results.history import FORMAT as SECTION

from .pictured import record


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("results") / "run"
    record(path)
    return path


@pytest.fixture
def folder(finished: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(finished, tmp_path / "run"))


def piped(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def endless(path: Path) -> None:
    path.unlink()
    path.symlink_to("/dev/zero")


def deep(path: Path) -> None:
    path.write_text("[" * 100_000)


def without_steps(path: Path) -> None:
    path.write_text(path.read_text().splitlines()[0] + "\n")


def another(path: Path) -> None:
    path.write_text('{"a.b": 1}')


def binary(path: Path) -> None:
    path.write_bytes(bytes(range(256)))


@pytest.mark.skipif(sys.platform == "win32", reason="kinds of files that Windows does not have")
@pytest.mark.parametrize(
    ("name", "change", "problem"),
    [
        *((name, piped, "is not a regular file") for name in ("curve.csv", "summary.json", "case.json")),
        *((name, endless, "is not a regular file") for name in ("curve.csv", "summary.json", "state_last.npz")),
        *((name, deep, "is nested too deeply") for name in ("summary.json", "case.json")),
        *((name, binary, "is not UTF-8 text") for name in ("curve.csv", "summary.json", "case.json")),
        ("state_last.npz", binary, "cannot be read"),
        ("curve.csv", without_steps, "has 0 steps, and summary.json tells of"),
        ("case.json", another, "unknown key"),
    ],
)
def test_what_is_no_result(folder: Path, name: str, change: Callable[[Path], None], problem: str) -> None:
    change(folder / name)
    with pytest.raises(InputError) as caught:
        Result.load(folder)
    assert caught.value.key.startswith(str(folder / name))
    assert problem in caught.value.problem


def test_the_key_of_a_case_stands_behind_its_file(folder: Path) -> None:
    another(folder / "case.json")
    with pytest.raises(InputError) as caught:
        Result.load(folder)
    assert caught.value.key == f'{folder / "case.json"}: "a.b"'


def test_a_section_whose_arrays_do_not_fit_together(folder: Path) -> None:
    with np.load(folder / FILE) as archive:
        arrays = {name: archive[name] for name in archive.files if not name.startswith("format")}
    arrays["steps.section"] = arrays["steps.section"] + 1000
    write_archive(folder / FILE, SECTION, 1, arrays)
    with pytest.raises(InputError, match="is damaged") as caught:
        read_history(folder)
    assert caught.value.key == str(folder / FILE)
