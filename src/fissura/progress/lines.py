"""A line that tells how far something is and changes in place: in a terminal, or below the cell of a notebook."""

import time
from html import escape
from importlib import import_module
from typing import Any, Protocol

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn

EVERY = 0.2
"""Seconds between two changes in a notebook, which keeps every one of them until it is shown."""


class Line(Protocol):
    """A line that changes in place."""

    def begin(self, text: str, *, done: float = 0.0, total: float = 1.0) -> None:
        """Show it for the first time: what happens, and how far it is."""

    def change(self, text: str, done: float | None = None) -> None:
        """Show another text, and how far it is by now."""

    def end(self) -> None:
        """Take it away; twice does no harm."""


def line_on(console: Console, share: str) -> Line | None:
    """The line that suits a console; None where nothing can change in place.

    Parameters
    ----------
    console : Console
        Where to write.
    share : str
        How the line tells how far it is, in terms of ``task`` of Rich: ``percentage``, ``completed``, ``total``.
    """
    if console.is_jupyter:
        return NotebookLine()
    return TerminalLine(console, share) if console.is_terminal else None


class TerminalLine:
    """A moving line of Rich."""

    def __init__(self, console: Console, share: str) -> None:
        self._task = TaskID(0)
        self._bar = Progress(
            BarColumn(20),
            TextColumn(share),
            TextColumn("{task.description}", markup=False),
            console=console,
            transient=True,
        )

    def begin(self, text: str, *, done: float = 0.0, total: float = 1.0) -> None:
        """Show the line."""
        self._task = self._bar.add_task(text, total=total)
        self._bar.update(self._task, completed=done)
        self._bar.start()

    def change(self, text: str, done: float | None = None) -> None:
        """Show another text, and another share of what is done."""
        self._bar.update(self._task, description=text, completed=done)

    def end(self) -> None:
        """Remove the line."""
        self._bar.stop()


class NotebookLine:
    """An output of a cell that is replaced.

    Rich and tqdm need widgets for this, which are neither installed everywhere nor kept in the file.
    """

    def __init__(self) -> None:
        self._shown: Any = None
        self._done, self._total, self._at = 0.0, 1.0, 0.0

    def begin(self, text: str, *, done: float = 0.0, total: float = 1.0) -> None:
        """Show it below the cell."""
        self._done, self._total, self._at = done, total, time.monotonic()
        self._shown = import_module("IPython.display").display(self._page(text), raw=True, display_id=True)

    def change(self, text: str, done: float | None = None) -> None:
        """Replace it, unless it has just been."""
        self._done = self._done if done is None else done
        now = time.monotonic()
        if self._shown is not None and now - self._at >= EVERY:
            self._at = now
            self._shown.update(self._page(text), raw=True)

    def end(self) -> None:
        """Leave an empty output."""
        if self._shown is not None:
            self._shown.update({"text/plain": "", "text/html": ""}, raw=True)
            self._shown = None

    def _page(self, text: str) -> dict[str, str]:
        bar = f'<progress value="{self._done:.4g}" max="{self._total:.4g}" style="vertical-align:middle"></progress>'
        return {"text/plain": text, "text/html": f"{bar} <code>{escape(text)}</code>"}
