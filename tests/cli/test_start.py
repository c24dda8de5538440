"""The command line as a whole: it starts lightly, and no room below imports it."""

from __future__ import annotations

import ast
import gc
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import fissura
from fissura.cli import start_light

from .fakes import EXAMPLE, call

PACKAGE = Path(fissura.__file__).parent


def test_a_light_start_keeps_what_the_user_set(monkeypatch: pytest.MonkeyPatch) -> None:
    thresholds = gc.get_threshold()
    monkeypatch.setenv("OPENBLAS_THREAD_TIMEOUT", "26")
    try:
        start_light()
        assert os.environ["OPENBLAS_THREAD_TIMEOUT"] == "26"
        assert gc.isenabled()
        assert gc.get_threshold() > thresholds
    finally:
        gc.set_threshold(*thresholds)


def test_reading_a_case_of_common_units_needs_no_pint_and_no_solver() -> None:
    code = f"import sys, fissura; fissura.load_case({str(EXAMPLE)!r}); print({{'pint', 'numpy'}} & set(sys.modules))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "set()"


def test_version() -> None:
    done = call("--version")
    assert done.exit_code == 0
    assert done.stdout == f"fissura {fissura.__version__}\n"


@pytest.mark.parametrize(
    "name", ["run", "check", "new", "compare", "moments", "animate", "elastic", "ensemble", "study"]
)
def test_every_command_has_help(name: str) -> None:
    assert name in call("--help").stdout
    done = call(name, "--help")
    assert done.exit_code == 0
    assert "Usage" in done.stdout


def test_help_imports_nothing_heavy() -> None:
    code = """
import contextlib, io, sys
from fissura.cli import app
with contextlib.redirect_stdout(io.StringIO()):
    app(["--help"], standalone_mode=False)
print(sorted({"numpy", "scipy", "numba", "pydantic", "matplotlib", "dask"} & set(sys.modules)))
print(sorted(name for name in sys.modules if name.startswith("fissura.") and not name.startswith("fissura.cli")))
"""
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.splitlines() == ["[]", "['fissura.errors', 'fissura.machine', 'fissura.machine.interrupts']"]


def imports(path: Path) -> Iterator[tuple[str, str]]:
    """Modules that a file imports, and names from them."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield from ((node.module, alias.name) for alias in node.names)


def test_no_room_imports_the_command_line() -> None:
    below = [path for path in PACKAGE.rglob("*.py") if path.parent.name != "cli" and path.name != "__main__.py"]
    assert len(below) > 100
    assert [path.name for path in below for module, _ in imports(path) if module.startswith("fissura.cli")] == []


def test_files_share_no_private_names() -> None:
    found = [(path.name, *pair) for path in PACKAGE.rglob("*.py") for pair in imports(path)]
    shared = [
        one for one in found if one[1].startswith("fissura") and one[2].startswith("_") and one[2] != "__version__"
    ]
    assert shared == []
