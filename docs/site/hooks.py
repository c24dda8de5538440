"""What the site needs beside pages: changelog and notebooks become pages, and every page must read as on GitHub.

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
    for file in [file for file in files if file.src_uri.endswith(".ipynb")]:
        for name, content in notebook(file).items():
            files.append(File.generated(config, name, content=content))
    return files


def notebook(file: File) -> dict[str, str | bytes]:
    """A page that shows a notebook as it is stored, and its pictures, by their paths."""
    import nbformat  # these are slow to load
    from nbconvert import MarkdownExporter

    assert file.abs_src_path is not None
    stored = nbformat.read(file.abs_src_path, as_version=4)
    for output in (output for cell in stored.cells for output in cell.get("outputs", ())):
        _restyle(output.get("data", {}))
    stem = file.src_uri.removesuffix(".ipynb")
    name = stem.rpartition("/")[2]
    resources = {"unique_key": name, "output_files_dir": f"{name}_files"}
    text, found = MarkdownExporter().from_notebook_node(stored, resources=resources)
    folder = stem.removesuffix(name)
    title, _, rest = text.partition("\n\n")
    pictures = {f"{folder}{path}": content for path, content in found["outputs"].items()}
    return {f"{stem}.md": f"{title}\n\n[Download this notebook]({name}.ipynb)\n\n{rest}", **pictures}


def _restyle(data: dict[str, str]) -> None:
    """Tables of pandas look as all others do; datasets of xarray, whose styles get lost on pages, are text."""
    if "xr-" in data.get("text/html", ""):
        del data["text/html"]
    elif "text/html" in data:
        plain = re.sub(r"<style.*?</style>\s*", "", data["text/html"], flags=re.DOTALL)
        data["text/html"] = plain.replace('<table border="1" class="dataframe">', "<table>")


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Lead to pages where sources name a notebook, which GitHub shows by itself; files of code are no pages."""
    markdown = re.sub(r"\[(`[^`]+`)\]\(\.\./src/[^)]+\)", r"\1", markdown)
    return re.sub(r"(?<!Download this notebook)\]\(([\w/.-]+)\.ipynb\)", r"](\1.md)", markdown)


def on_page_content(html: str, page: Page, config: MkDocsConfig, files: Files) -> None:
    """Compare the structure of a page with that on GitHub."""
    if "\n::: " in (page.markdown or "") or page.file.src_uri.startswith("notebooks/"):
        return  # most of it comes from docstrings, or is shown by GitHub in its own way
    here = Counter(_TAG.findall(html))
    there = Counter(_TAG.findall(MarkdownIt("commonmark").enable("table").render(page.markdown or "")))
    for tag in _TAGS:
        if here[tag] != there[tag]:
            counts = f"{here[tag]} <{tag}> on the site and {there[tag]} on GitHub"
            _log.warning("Doc file '%s' has %s: look at indentation and blank lines", page.file.src_uri, counts)
