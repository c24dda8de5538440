"""The documentation: navigation and reference of the site are complete, and the tutorial prints what it says."""

from __future__ import annotations

import importlib
import re
import tomllib
from importlib.resources import files
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import fissura
from fissura.case import case_from_dict
from fissura.specimen import conditions_from_case, domain_from_case

ROOT = Path(__file__).parents[1]


def page(name: str) -> str:
    return (ROOT / "docs" / name).read_text(encoding="utf-8")


@pytest.fixture
def tutorial(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The script that runs pages."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    return importlib.import_module("tutorial")


def test_every_page_is_in_the_navigation() -> None:
    named = re.findall(r"^ +- (?:.*: )?(\S+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.MULTILINE)
    assert len(named) == len(set(named))
    pages = {path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md")}
    assert set(named) == pages | {"changelog.md"}  # the changelog of the repository; docs/site/hooks.py brings it in
    linked = set(re.findall(r"^\| \[(\S+\.md)\]", page("index.md"), re.MULTILINE))
    assert linked == pages - {"index.md"}


def test_every_public_name_is_in_the_reference() -> None:
    shown = set(re.findall(r"^::: (\S+)$", page("api.md"), re.MULTILINE))
    assert {f"fissura.{name}" for name in fissura.__all__ if name != "__version__"} <= shown


def test_the_tutorial_changes_lines_that_are_there(tutorial: ModuleType, tmp_path: Path) -> None:
    text = (files("fissura") / "templates" / "beam.toml").read_text(encoding="utf-8")
    (change,) = [block for block in tutorial.blocks(page("tutorial.md")) if block.language == "diff"]
    (tmp_path / change.title).write_text(tutorial.changed(text, change.text), encoding="utf-8")
    case = fissura.load_case(tmp_path / change.title)
    assert case.specimen.size == (0.7, 0.2, 0.05)
    assert [support.at for support in case.supports] == [0.1, 0.6]
    with pytest.raises(ValueError, match="0 times"):
        tutorial.changed(text, "-no such line\n+another")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["index.md", "tutorial.md"])
def test_pages_run_and_print_what_they_say(name: str, tutorial: ModuleType, tmp_path: Path) -> None:
    """All commands, changes of files and Python, one after another; rows of times and memory aside."""
    text = page(name)
    assert tutorial.differences(text, tutorial.worked(text, tmp_path)) == []
    if name == "tutorial.md":
        assert all((tmp_path / source).is_file() for source in tutorial.PICTURES.values())
        assert all(f"images/{picture}" in text for picture in tutorial.PICTURES)


#: What a page's case leaves out, because it is about something else.
REST = {
    "specimen": {"size": [0.2, 0.2, 0.05]},
    "supports": [{"type": "clamp", "face": "bottom"}],
    "material": {"E": 60e9, "alpha": 0.29, "f_t": 2.2e6, "G_t": 35.0},
    "discretization": {"l_f": 0.02},
}


@pytest.mark.parametrize(
    ("name", "more"), [("loading", {}), ("platens", {"control": {"type": "displacement", "target": 1e-4}})]
)
def test_cases_on_pages_are_cases(name: str, more: dict[str, Any]) -> None:
    """The first one of a page, with what it leaves out."""
    found = re.search(r"```toml\n(.*?)```", page(f"{name}.md"), flags=re.DOTALL)
    assert found is not None
    given = tomllib.loads(found[1])
    assert set(given) - set(REST)
    conditions_from_case(case := case_from_dict({**REST, **more, **given}), domain_from_case(case))
