"""What commands with many runs say when they end early: what is kept, and how to go on."""

from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import typer

from fissura.cli.console import INTERRUPTED, STOPPED, not_written, say
from fissura.errors import FissuraError


class Resumable:
    """Turns every way in which a command with many runs can end early into a message that says how to go on.

    Before the first run may begin nothing can be resumed, and most errors pass through.

    Parameters
    ----------
    folder : Path
        Where the runs are kept.
    how : str
        What to do to go on, as the end of a sentence.
    """

    def __init__(self, folder: Path, how: str) -> None:
        self._folder = folder
        self._go_on = f"what has ended is saved in {folder}; {how}"
        self._begun = False

    def beginning(self, tell: Callable[..., None] | None) -> Callable[..., None]:
        """What is to be called when the folder is ready and runs begin; it calls `tell` if there is one."""

        def begin(*arguments: Any) -> None:
            self._begun = True
            if tell is not None:
                tell(*arguments)

        return begin

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Say how to go on.

        Raises
        ------
        typer.Exit
            In place of errors that a user can meet. Others pass through, once it is said what is kept.
        """
        if isinstance(error, OSError):
            kept = self._go_on if self._begun else ""
            raise not_written(error, error.filename or f"a file in {self._folder}", kept) from None
        if error is None or not self._begun:
            return
        if isinstance(error, KeyboardInterrupt):
            say(f"interrupted; {self._go_on}")
            raise typer.Exit(INTERRUPTED) from None
        if isinstance(error, FissuraError | MemoryError):
            reason = "out of memory" if isinstance(error, MemoryError) else error
            say(f"error: {reason}; {self._go_on}")
            raise typer.Exit(STOPPED) from None
        if isinstance(error, Exception):
            say(self._go_on)
