"""The documentation: navigation and reference of the site are complete. Blocks of code: test_pages.py."""

from __future__ import annotations

import importlib
import json
import os
import re
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import pytest

import fissura

ROOT = Path(__file__).parents[1]


def page(name: str) -> str:
    return (ROOT / "docs" / name).read_text(encoding="utf-8")


def test_every_page_is_in_the_navigation() -> None:
    named = re.findall(r"^ +- (?:.*: )?(\S+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.MULTILINE)
    assert len(named) == len(set(named))
    there = {path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*")}
    pages = {name for name in there if name.endswith((".md", ".ipynb"))}
    # The site makes pages of the changelog and of notebooks: docs/site/hooks.py.
    assert set(named) == {name.replace(".ipynb", ".md") for name in pages} | {"changelog.md"}
    linked = set(re.findall(r"^\| \[(\S+\.(?:md|ipynb))\]", page("index.md"), re.MULTILINE))
    assert linked == pages - {"index.md"}


def test_code_that_pages_link_to_is_there() -> None:
    found = [
        (page.name, path)
        for page in sorted((ROOT / "docs").glob("*.md"))
        for path in re.findall(r"\]\(\.\./(src/[^)#]+)", page.read_text(encoding="utf-8"))
    ]
    assert len(found) >= 10  # the ten steps of a run
    assert [(page, path) for page, path in found if not (ROOT / path).is_file()] == []


def test_every_public_name_is_in_the_reference() -> None:
    shown = set(re.findall(r"^::: (\S+)$", page("api.md"), re.MULTILINE))
    assert {f"fissura.{name}" for name in fissura.__all__ if name != "__version__"} <= shown


def test_every_example_has_an_entry_and_every_entry_an_example(monkeypatch: pytest.MonkeyPatch) -> None:
    """With its picture, what a run has found, and what it shows in the words of its file."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    examples = importlib.import_module("examples")
    names = {path.stem for path in (ROOT / "examples").glob("*.toml")}
    text = page("examples.md")
    assert sorted(name for group in examples.GROUPS.values() for name in group) == sorted(names)
    assert set(re.findall(r"^### (\w+)$", text, re.MULTILINE)) == names
    assert set(json.loads(examples.FOUND.read_text(encoding="utf-8"))) == names
    assert {path.stem for path in examples.PICTURES.glob("*.png")} == names
    assert [name for name in sorted(names) if examples.about(name) not in text] == []
    assert examples.page(json.loads(examples.FOUND.read_text(encoding="utf-8"))).strip() in text


def test_what_is_completed_after_the_package_is_what_is_public() -> None:
    """Before anything is imported, and after much was; editors find types, too."""
    code = "import fissura; print(*(name for name in dir(fissura) if not name.startswith('_')))"
    bare = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert (
        bare
        == [name for name in dir(fissura) if not name.startswith("_")]
        == sorted(set(fissura.__all__) - {"__version__"})
    )
    assert files("fissura").joinpath("py.typed").is_file()


def test_the_page_of_commands_is_that_of_the_program() -> None:
    code = [sys.executable, str(ROOT / "benchmarks" / "command_line.py")]
    done = subprocess.run(code, capture_output=True, text=True, check=True, env=os.environ | {"COLUMNS": "200"})
    assert done.stdout.strip() in page("command-line.md"), "python benchmarks/command_line.py --write"
