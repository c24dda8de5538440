"""Compiled functions on disk: where they are, that damage does no harm, and when they are made anew."""

from __future__ import annotations

import importlib.util
import inspect
import logging
import os
import re
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cli.fakes import TINY
from fissura.kernels import place, prepare_cache, stamp, state
from fissura.kernels.claims import Claims
from fissura.kernels.known import Known, dispatcher, known, signature, types_in_words
from fissura.kernels.place import PACKAGE
from fissura.kernels.state import State, process

CALLEE = "from fissura.kernels import njit\n@njit()\ndef twice(x):\n    return 2 * x\n"
CALLER = """
from fissura.kernels import njit
from {callee} import twice
SHIFT = 1
@njit(fastmath={{"contract"}})
def shifted(x):
    return twice(x) + SHIFT
"""


class Alone:
    """No helpers."""

    def start(self) -> int:
        return 1


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A cache of its own: as if the process had just begun, with a folder named by the user."""
    monkeypatch.setattr(place.config, "CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(state, "Helpers", Alone)
    process.cache_clear()
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    for name in ("callee", "caller"):
        sys.modules.pop(name, None)
    process.cache_clear()


def begin() -> State:
    """What a new process knows: nothing."""
    process.cache_clear()
    stamp._source.cache_clear()
    return process()


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


def test_what_is_compiled_is_found_again(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert loaded(here).shifted(3.0) == 7.0
    assert process().missed == 2
    files = sorted(prepare_cache().glob("*"))  # type: ignore[union-attr]
    assert [file.name.split("-")[0] for file in files] == ["callee.twice", "caller.shifted"]
    assert files[0].parents[1] == here / "cache"
    again = begin()
    assert loaded(here).shifted(3.0) == 7.0
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
    here: Path, monkeypatch: pytest.MonkeyPatch, callee: str, caller: str, result: float
) -> None:
    assert loaded(here).shifted(3.0) == 7.0
    begin()
    assert loaded(here, callee, caller).shifted(3.0) == result
    assert not process().told_damage


DAMAGE = {
    "empty": lambda data: b"",
    "garbage": lambda data: os.urandom(len(data)),
    "cut": lambda data: data[: len(data) // 2],
    "zeros": lambda data: bytes(len(data)),
    "one bit": lambda data: data[:-500] + bytes([data[-500] ^ 1]) + data[-499:],
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_damaged_files_are_made_anew_and_told_of_once(
    here: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, kind: str
) -> None:
    loaded(here).shifted(3.0)
    folder = prepare_cache()
    assert folder is not None
    for file in folder.glob("*"):
        file.write_bytes(DAMAGE[kind](file.read_bytes()))
    begin()
    assert loaded(here).shifted(3.0) == 7.0
    (message,) = [record.getMessage() for record in caplog.records if not hasattr(record, "note")]
    assert "damaged" in message
    assert f"delete the folder {folder}" in message
    begin()
    assert loaded(here).shifted(3.0) == 7.0
    assert process().missed == 0


def test_compiling_much_is_announced_once_and_only_then(
    here: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(state, "missing_seconds", lambda folder: 31.0)
    loaded(here).shifted(3.0)
    loaded(here).shifted(3)
    (record,) = caplog.records
    assert record.getMessage() == "compiling kernels (once, about 30 s)"
    assert record.levelno == logging.WARNING, "shown where nobody has asked for messages"
    begin()
    caplog.clear()
    prepare_cache()
    loaded(here).shifted(3.0)
    assert caplog.text == ""


def test_the_first_thing_that_is_said_of_an_empty_folder_is_that_it_will_be_filled(
    here: Path, caplog: pytest.LogCaptureFixture
) -> None:
    prepare_cache()
    (record,) = caplog.records
    assert re.fullmatch(r"compiling kernels \(once, about \d+ s\)", record.getMessage())


def test_compiling_little_is_not_worth_a_word(
    here: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(state, "missing_seconds", lambda folder: 1.0)
    loaded(here).shifted(3.0)
    loaded(here).shifted(3)
    assert caplog.text == ""


def test_a_function_that_another_process_compiles_is_waited_for(here: Path) -> None:
    folder = prepare_cache(say=False)
    assert folder is not None
    file = folder / "caller.shifted-0.kernel"
    ours, theirs = Claims(), Claims()
    assert not ours.take(file)
    assert theirs.is_taken(file)
    waiting = threading.Thread(target=theirs.take, args=(file,))
    waiting.start()
    waiting.join(0.1)
    assert waiting.is_alive()
    ours.give_up(file)
    waiting.join(10.0)
    assert not waiting.is_alive()
    assert ours.is_taken(file)
    theirs.give_up(file)
    assert list(folder.glob("*.lock")) == []


def test_a_number_that_is_written_out_is_of_the_same_type_as_others(here: Path) -> None:
    once = "from fissura.kernels import njit\n@njit()\ndef twice(x):\n    return 2 * x\n"
    caller = "from fissura.kernels import njit\nfrom {callee} import twice\n@njit()\ndef shifted(x):\n"
    module = loaded(here, once, caller + "    return twice(3) + twice(True) + twice(x)\n")
    assert module.shifted(4) == 16
    assert sorted(str(kind) for (kind,) in module.twice.overloads) == ["bool", "int64"]


SMALL = """
import numpy as np
from fissura.kernels import compiled_when_large, njit
from {callee} import twice
@compiled_when_large(len, 5)
@njit()
def shifted(x):
    total = 0.0
    for value in x:
        total += np.sqrt(twice(value)) / 3.0
    return total
"""


def test_python_runs_what_is_small_with_the_same_result(here: Path) -> None:
    module, x = loaded(here, caller=SMALL), np.array([0.1, 0.7, 1.3])
    small = module.shifted(x)
    assert process().missed == 0
    assert module.shifted(x) == small
    assert process().missed == 2


@pytest.mark.parametrize("one", known(), ids=lambda one: one.name)
def test_every_function_on_the_list_exists_and_its_types_can_be_written(one: Known) -> None:
    assert hasattr(dispatcher(one), "py_func")
    assert types_in_words(signature(one)) == one.types
    arguments = inspect.signature(dispatcher(one).py_func).parameters
    assert len(arguments) == len(one.types)


@pytest.mark.slow
def test_helpers_compile_what_a_run_needs(tmp_path: Path) -> None:
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    code = "from fissura.kernels import helping; helping._wait_for_the_end = lambda: None; helping.help_out()"
    subprocess.run([sys.executable, "-c", code], env=environment, check=True)
    count = "import sys, fissura; from fissura.kernels.state import process; fissura.run(sys.argv[1])"
    code = f"{count}; print(process().missed)"
    case = Path(__file__).parents[1] / "examples" / "gregoire_d50_halfnotch.toml"
    done = subprocess.run([sys.executable, "-c", code, case], env=environment, check=True, capture_output=True)
    assert int(done.stdout) <= 3, "the list is old: python benchmarks/kernels.py --write"
    assert b"compiling" not in done.stderr


def nowhere(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    """An installation and a home that cannot be written to, whoever asks: files stand where folders should be."""
    (folder / "package").mkdir()
    (folder / "package" / "__pycache__").write_text("")
    (folder / "home").write_text("")
    monkeypatch.setattr(place.config, "CACHE_DIR", "")
    monkeypatch.setattr(place, "PACKAGE", folder / "package")
    for name in ("HOME", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(name, str(folder / "home"))
    monkeypatch.setattr(place.tempfile, "tempdir", str(folder / "tmp"))
    (folder / "tmp").mkdir()


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="homes are found in another way")
def test_a_temporary_folder_where_nothing_else_can_be_written(
    here: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    nowhere(monkeypatch, here)
    assert loaded(here).shifted(3.0) == 7.0
    folder = prepare_cache()
    assert folder == here / "tmp" / f"fissura_kernels_{os.getuid()}"
    assert folder.stat().st_mode & 0o777 == 0o700
    (message,) = [record.getMessage() for record in caplog.records if not hasattr(record, "note")]
    assert f"kept in a temporary folder, {folder}" in message
    begin()
    loaded(here).shifted(3.0)
    assert process().missed == 0


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="homes are found in another way")
def test_a_temporary_folder_that_others_can_write_to_is_not_used(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nowhere(monkeypatch, here)
    theirs = here / "tmp" / f"fissura_kernels_{os.getuid()}"
    theirs.mkdir()
    theirs.chmod(0o777)
    folder = prepare_cache()
    assert folder is not None
    assert folder != theirs
    assert folder.parent == theirs.parent


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="homes are found in another way")
def test_no_folder_at_all_is_no_error(
    here: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    nowhere(monkeypatch, here)
    (here / "tmp").rmdir()
    assert loaded(here).shifted(3.0) == 7.0
    assert prepare_cache() is None
    assert "every start makes them anew" in caplog.text


def test_a_folder_that_fills_up_is_no_error(here: Path, caplog: pytest.LogCaptureFixture) -> None:
    folder = prepare_cache()
    assert folder is not None
    folder.rmdir()
    folder.write_text("in the way")
    assert loaded(here).shifted(3.0) == 7.0
    assert caplog.text.count(f"cannot be kept in {folder}") == 1


def test_every_kernel_of_the_package_is_kept_so() -> None:
    others = re.compile(r"^\s*(from numba import .*\bnjit|import numba\b)", re.MULTILINE)
    found = [path.name for path in PACKAGE.rglob("*.py") if others.search(path.read_text(encoding="utf-8"))]
    assert found == ["__init__.py", "cache.py"]


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
        command = [sys.executable, "-m", "fissura", "check", "--build", "tiny.toml"]
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert "Traceback" not in done.stderr
        return done.stderr

    folder = tmp_path / "tmp" / f"fissura_kernels_{os.getuid()}"
    first = check()
    assert first.count(f"kept in a temporary folder, {folder}") == 1
    assert first.count("compiling kernels (once, about") == 1
    files = list(folder.glob("*.kernel"))
    assert len(files) > 10
    assert "compiling" not in check()
    for damage, file in zip(cycle(DAMAGE.values()), files, strict=False):  # kernels within others are not loaded
        file.write_bytes(damage(file.read_bytes()))
    damaged = check()
    assert damaged.count(f"delete the folder {folder}") == 1
