"""The documentation: navigation and reference of the site are complete. Blocks of code: test_pages.py."""

from __future__ import annotations

import re
from pathlib import Path

import fissura

ROOT = Path(__file__).parents[1]


def page(name: str) -> str:
    return (ROOT / "docs" / name).read_text(encoding="utf-8")


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
