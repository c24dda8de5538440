"""Blocks of code on pages of Markdown, and what a comment before each says about its test."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

__all__ = ["Block", "blocks"]

_BLOCK = re.compile(
    r"(?:^<!-- test: (?P<note>.*?) -->\n\n?)?"
    r'^(?P<indent> *)```(?P<language>\w*)(?: title="(?P<title>\S+)")?\n(?P<text>.*?)^(?P=indent)```$',
    re.M | re.DOTALL,
)


@dataclass(frozen=True)
class Block:
    """A block of code on a page.

    Attributes
    ----------
    language : str
        As after the backticks; empty for none.
    title : str or None
        The file that it is about.
    note : str
        Text of a comment ``<!-- test: ... -->`` right before it; see ``tests/test_pages.py``.
    text : str
        What is in it.
    start, end : int
        Where the text stands on the page.
    line : int
        Number of its first line on the page.
    """

    language: str
    title: str | None
    note: str
    text: str
    start: int
    end: int
    line: int


def blocks(page: str) -> Iterator[Block]:
    """All blocks of code of a page, in their order."""
    for found in _BLOCK.finditer(page):
        start, end = found.span("text")
        line = page.count("\n", 0, start)
        yield Block(found["language"], found["title"], found["note"] or "", found["text"], start, end, line)
