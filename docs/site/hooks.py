"""What the site needs beside pages: the changelog becomes one, and every page must read as it does on GitHub.

GitHub follows CommonMark, MkDocs does not: lists and code in lists, say, need other indentation there. Both are asked
for the structure of every page, and a difference is a warning, which ends ``mkdocs build --strict``.
"""

from __future__ import annotations

import logging
import re
from collections import Counter
from pathlib import Path

from markdown_it import MarkdownIt
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

_log = logging.getLogger("mkdocs.hooks.fissura")

_TAGS = ("h1", "h2", "h3", "h4", "ul", "ol", "li", "pre", "code", "table", "tr", "img", "em", "strong", "blockquote")
_TAG = re.compile(rf"<({'|'.join(_TAGS)})[ >]")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Make a page of the changelog."""
    text = Path(config.config_file_path).with_name("CHANGELOG.md").read_text(encoding="utf-8")
    files.append(File.generated(config, "changelog.md", content=text))
    return files


def on_page_content(html: str, page: Page, config: MkDocsConfig, files: Files) -> None:
    """Compare the structure of a page with that on GitHub."""
    if "\n::: " in (page.markdown or ""):
        return  # most of it comes from docstrings
    here = Counter(_TAG.findall(html))
    there = Counter(_TAG.findall(MarkdownIt("commonmark").enable("table").render(page.markdown or "")))
    for tag in _TAGS:
        if here[tag] != there[tag]:
            counts = f"{here[tag]} <{tag}> on the site and {there[tag]} on GitHub"
            _log.warning("Doc file '%s' has %s: look at indentation and blank lines", page.file.src_uri, counts)
