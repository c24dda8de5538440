"""The documentation: every page is in the navigation of the site, every public name in the reference."""

import re
from pathlib import Path

import fissura

ROOT = Path(__file__).parents[1]


def test_every_page_is_in_the_navigation() -> None:
    named = re.findall(r"^ +- (?:.*: )?(\S+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.MULTILINE)
    assert len(named) == len(set(named))
    pages = {path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md")}
    assert set(named) == pages | {"changelog.md"}  # the changelog of the repository; docs/site/hooks.py brings it in


def test_every_public_name_is_in_the_reference() -> None:
    shown = set(re.findall(r"^::: (\S+)$", (ROOT / "docs" / "api.md").read_text(encoding="utf-8"), re.MULTILINE))
    assert {f"fissura.{name}" for name in fissura.__all__ if name != "__version__"} <= shown
