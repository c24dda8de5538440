"""Compiled functions on disk: where they are, that damage does no harm, and when they are made anew."""

from __future__ import annotations

import importlib.util
import logging
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from itertools import cycle
from pathlib import Path
from typing import Any

import pytest

import fissura.kernels as kernels
from cli.fakes import TINY
from fissura.kernels import PACKAGE, prepare_cache

CALLEE = "from fissura.kernels import njit\n@njit()\ndef twice(x):\n    return 2 * x\n"
CALLER = """
from fissura.kernels import njit
from {callee} import twice
SHIFT = 1
@njit(fastmath={{"contract"}})
def shifted(x):
    return twice(x) + SHIFT
"""


@pytest.fixture
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A cache of its own: as if the process had just begun, with a folder named by the user."""
    monkeypatch.setattr(kernels.config, "CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(kernels, "_state", kernels._State())
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    for name in ("callee", "caller"):
        sys.modules.pop(name, None)


def begin(monkeypatch: pytest.MonkeyPatch) -> Any:
    """What a new process knows: nothing."""
    monkeypatch.setattr(kernels, "_state", kernels._State())
    kernels._source.cache_clear()
    return kernels._state


def loaded(folder: Path, callee: str = CALLEE, caller: str = CALLER) -> Any:
    """A module with a compiled function that calls one of another module."""
    for name, text in (("callee", callee), ("caller", caller.format(callee="callee"))):
        (folder / f"{name}.py").write_text(text)
        spec = importlib.util.spec_from_file_location(name, folder / f"{name}.py")
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        exec(compile(text, str(folder / f"{name}.py"), "exec"), vars(module))
    return module


def test_what_is_compiled_is_found_again(state: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert loaded(state).shifted(3.0) == 7.0
    assert kernels._state.missed == 2
    files = sorted(prepare_cache().glob("*"))  # type: ignore[union-attr]
    assert [file.name.split("-")[0] for file in files] == ["callee.twice", "caller.shifted"]
    assert files[0].parents[1] == state / "cache"
    again = begin(monkeypatch)
    assert loaded(state).shifted(3.0) == 7.0
    assert again.missed == 0


@pytest.mark.parametrize(
    ("callee", "caller", "result"),
    [
        (CALLEE.replace("2 * x", "3 * x"), CALLER, 10.0),
        (CALLEE, CALLER.replace("SHIFT = 1", "SHIFT = 5"), 11.0),
    ],
    ids=["a function that is called", "a constant"],
)
def test_what_has_changed_is_compiled_anew(
    state: Path, monkeypatch: pytest.MonkeyPatch, callee: str, caller: str, result: float
) -> None:
    assert loaded(state).shifted(3.0) == 7.0
    begin(monkeypatch)
    assert loaded(state, callee, caller).shifted(3.0) == result
    assert not kernels._state.told_damage


DAMAGE = {
    "empty": lambda data: b"",
    "garbage": lambda data: os.urandom(len(data)),
    "cut": lambda data: data[: len(data) // 2],
    "zeros": lambda data: bytes(len(data)),
    "one bit": lambda data: data[:-500] + bytes([data[-500] ^ 1]) + data[-499:],
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_damaged_files_are_made_anew_and_told_of_once(
    state: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, kind: str
) -> None:
    loaded(state).shifted(3.0)
    folder = prepare_cache()
    assert folder is not None
    for file in folder.glob("*"):
        file.write_bytes(DAMAGE[kind](file.read_bytes()))
    begin(monkeypatch)
    assert loaded(state).shifted(3.0) == 7.0
    (message,) = [record.getMessage() for record in caplog.records if record.levelno == logging.WARNING]
    assert "damaged" in message
    assert f"delete the folder {folder}" in message
    begin(monkeypatch)
    assert loaded(state).shifted(3.0) == 7.0
    assert kernels._state.missed == 0


def test_compiling_much_is_announced_once_and_only_then(
    state: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO, "fissura.kernels")
    loaded(state).shifted(3.0)
    loaded(state).shifted(3)
    assert caplog.text.count("compiling kernels") == 1
    begin(monkeypatch)
    caplog.clear()
    prepare_cache()
    loaded(state).shifted(3.0)
    assert caplog.text == ""


def nowhere(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    """An installation and a home that cannot be written to, whoever asks: files stand where folders should be."""
    (folder / "package").mkdir()
    (folder / "package" / "__pycache__").write_text("")
    (folder / "home").write_text("")
    monkeypatch.setattr(kernels.config, "CACHE_DIR", "")
    monkeypatch.setattr(kernels, "PACKAGE", folder / "package")
    for name in ("HOME", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(name, str(folder / "home"))
    monkeypatch.setattr(kernels.tempfile, "tempdir", str(folder / "tmp"))
    (folder / "tmp").mkdir()


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="homes are found in another way")
def test_a_temporary_folder_where_nothing_else_can_be_written(
    state: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    nowhere(monkeypatch, state)
    assert loaded(state).shifted(3.0) == 7.0
    folder = prepare_cache()
    assert folder == state / "tmp" / f"fissura_kernels_{os.getuid()}"
    assert folder.stat().st_mode & 0o777 == 0o700
    (message,) = [record.getMessage() for record in caplog.records if record.levelno == logging.WARNING]
    assert f"kept in a temporary folder, {folder}" in message
    begin(monkeypatch)
    loaded(state).shifted(3.0)
    assert kernels._state.missed == 0


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="homes are found in another way")
def test_a_temporary_folder_that_others_can_write_to_is_not_used(state: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nowhere(monkeypatch, state)
    theirs = state / "tmp" / f"fissura_kernels_{os.getuid()}"
    theirs.mkdir()
    theirs.chmod(0o777)
    folder = prepare_cache()
    assert folder is not None
    assert folder != theirs
    assert folder.parent == theirs.parent


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="homes are found in another way")
def test_no_folder_at_all_is_no_error(
    state: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    nowhere(monkeypatch, state)
    (state / "tmp").rmdir()
    assert loaded(state).shifted(3.0) == 7.0
    assert prepare_cache() is None
    assert "every start makes them anew" in caplog.text


def test_a_folder_that_fills_up_is_no_error(state: Path, caplog: pytest.LogCaptureFixture) -> None:
    folder = prepare_cache()
    assert folder is not None
    folder.rmdir()
    folder.write_text("in the way")
    assert loaded(state).shifted(3.0) == 7.0
    assert caplog.text.count(f"cannot be kept in {folder}") == 1


def test_every_kernel_of_the_package_is_kept_so() -> None:
    others = re.compile(r"^\s*(from numba import .*\bnjit|import numba\b)", re.MULTILINE)
    found = [path.name for path in PACKAGE.rglob("*.py") if others.search(path.read_text(encoding="utf-8"))]
    assert found == ["kernels.py"]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="homes are found in another way")
def test_a_run_of_a_read_only_installation_without_a_home(tmp_path: Path) -> None:
    shutil.copytree(PACKAGE, tmp_path / "lib" / "fissura", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "lib" / "fissura" / "__pycache__").write_text("")
    (tmp_path / "tmp").mkdir()
    (tmp_path / "home").write_text("")
    (tmp_path / "tiny.toml").write_text(TINY)
    environment = {key: value for key, value in os.environ.items() if not key.startswith("NUMBA_")} | {
        "PYTHONPATH": str(tmp_path / "lib"),
        "HOME": str(tmp_path / "home"),
        "XDG_CACHE_HOME": str(tmp_path / "home"),
        "MPLCONFIGDIR": str(tmp_path / "tmp"),
        "TMPDIR": str(tmp_path / "tmp"),
    }

    def check() -> str:
        command = [sys.executable, "-m", "fissura", "check", "tiny.toml"]
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert "Traceback" not in done.stderr
        return done.stderr

    folder = tmp_path / "tmp" / f"fissura_kernels_{os.getuid()}"
    first = check()
    assert first.count(f"kept in a temporary folder, {folder}") == 1
    assert first.count("compiling kernels") == 1
    files = list(folder.glob("*.kernel"))
    assert len(files) > 10
    assert "compiling" not in check()
    for damage, file in zip(cycle(DAMAGE.values()), files, strict=False):  # kernels within others are not loaded
        file.write_bytes(damage(file.read_bytes()))
    damaged = check()
    assert damaged.count(f"delete the folder {folder}") == 1
