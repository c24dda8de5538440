"""The rooms of the source: what may import what."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "fissura"

LATE = {
    "__main__.py": "what Python needs for it is set first",
    "api/check.py": "shown in a notebook",
    "batch/result.py": "shown in a notebook",
    "calibration/result.py": "drawn, shown in a notebook",
    "calibration/runner.py": "needs tomlkit, which is optional",
    "ensemble/result.py": "drawn, shown in a notebook",
    "linear/symmetric.py": "needs PyAMG, which is optional",
    "results/comparison.py": "drawn, saved, shown in a notebook",
    "results/result.py": "drawn, saved, reported, shown in a notebook",
    "results/views.py": "drawn, shown in a window",
    "running/storing.py": "Matplotlib takes long to import",
}
"""Files that import others of Fissura inside functions, and why; commands in ``cli`` do, to start quickly."""


def test_rooms_import_only_rooms_below_them() -> None:
    """The contract is in ``pyproject.toml``; an exception that is not needed any more fails, too."""
    lint = Path(sys.executable).with_name("lint-imports")
    done = subprocess.run([lint, "--no-cache", "--no-logo"], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 kept, 0 broken" in done.stdout


def test_imports_are_at_the_top_of_files() -> None:
    found = set()
    for path in SOURCE.rglob("*.py"):
        inside = [node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if _imports_ours(node)]
        name = path.relative_to(SOURCE).as_posix()
        if inside and not name.startswith("cli/"):
            found.add(name)
    assert found == set(LATE), "CONTRIBUTING.md says when an import inside a function is right"


def _imports_ours(node: ast.AST) -> bool:
    """Whether it is a function that imports something of Fissura."""
    return isinstance(node, ast.FunctionDef) and any(
        isinstance(one, ast.ImportFrom) and (one.module or "").startswith("fissura") for one in ast.walk(node)
    )


def test_the_page_shows_the_rooms_that_there_are() -> None:
    command = [sys.executable, ROOT / "benchmarks" / "architecture.py", "--check", ROOT / "docs" / "architecture.md"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
