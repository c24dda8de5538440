"""What commands share: errors as a message and an exit status, warnings, tables."""

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from fissura.cli.machine import for_programs, is_for_programs, tell_error
from fissura.errors import FissuraError, InputError, RunStopped

#: Pictures that can be written.
_PICTURES = "a name that ends in .png, .pdf or .svg"

#: Exit status of a command that did not do what it was asked for.
BAD_INPUT, STOPPED, NOT_WRITTEN, INTERRUPTED = 2, 3, 4, 130


def say(message: str) -> None:
    """Write a message to the user on standard error, unwrapped."""
    typer.echo(message, err=True)


@contextmanager
def errors(*, json: bool = False) -> Iterator[None]:
    """Turn the errors a user can meet into a message, or into JSON, and an exit status."""
    with for_programs(json):
        try:
            yield
        except RunStopped as error:
            raise _ended(f"error: {error}{_saved(error)}", STOPPED, error) from None
        except FissuraError as error:
            raise _ended(f"error: {error}", BAD_INPUT, error) from None
        except MemoryError:
            message = "error: there is not enough memory for this; what was written before is kept"
            raise _ended(message, STOPPED) from None
        except KeyboardInterrupt as error:
            raise _ended(f"interrupted{_saved(error)}", INTERRUPTED) from None


def _ended(message: str, status: int, error: BaseException | None = None) -> typer.Exit:
    """Tell an error; what is returned ends the command."""
    tell_error(message, status, error)
    return typer.Exit(status)


def _saved(error: BaseException) -> str:
    """What was saved of a run that ended early."""
    result = getattr(error, "result", None)
    if result is None or result.folder is None:
        return "; nothing was saved"
    steps = len(result.curve["step"])
    done = result.summary.get("status") == "finished"
    which = f"while pictures were drawn; all {steps} steps are" if done else f"the {steps} steps before it are"
    # A run that stopped would stop there again.
    hint = go_on(result.folder) if isinstance(error, KeyboardInterrupt) and not done else ""
    return f"{' ' if done else '; '}{which} saved in {result.folder}: {file_names(result.folder)}{hint}"


def go_on(folder: Path) -> str:
    """How to go on with the run in a folder, as the end of a sentence; empty where it has no checkpoint."""
    return "; --resume goes on with it" if (folder / "checkpoint.npz").is_file() else ""


def file_names(folder: Path) -> str:
    """Names of the files in a folder, hidden ones left out."""
    return ", ".join(sorted(path.name for path in folder.glob("[!.]*") if path.is_file()))


def not_written(error: OSError, where: str | Path, kept: str = "") -> typer.Exit:
    """Say that a file could not be written; what is returned ends the command.

    Parameters
    ----------
    error : OSError
        What went wrong.
    where : str or Path
        The file or folder.
    kept : str, optional
        What is not lost.
    """
    message = f"error: {where}: cannot be written: {error.strerror or error}{'; ' if kept else ''}{kept}"
    return _ended(message, NOT_WRITTEN)


@contextmanager
def writing(picture: Path) -> Iterator[None]:
    """Turn what can go wrong in writing a picture into a message, and show warnings on the way.

    Parameters
    ----------
    picture : Path
        The file.
    """
    try:
        with warnings(Console(stderr=True)):
            yield
    except OSError as error:
        raise not_written(error, picture) from None


def check_ending(picture: Path, option: str) -> None:
    """Refuse a picture whose name has no ending, to which one would be added unasked, or one of no picture.

    Raises
    ------
    InputError
        There is none, or matplotlib does not know it.
    """
    from matplotlib.backend_bases import FigureCanvasBase

    if not picture.suffix:
        raise InputError(option, f"{picture}: no ending", _PICTURES)
    if picture.suffix[1:].lower() not in FigureCanvasBase.filetypes:
        raise InputError(option, f"{picture}: {picture.suffix} is no picture", _PICTURES)


class Warnings(logging.Handler):
    """Shows what Fissura's modules log as warnings, each once.

    Parameters
    ----------
    console : Console
        Where to write.
    """

    def __init__(self, console: Console) -> None:
        super().__init__(logging.WARNING)
        self.console = console
        self.shown: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Show what was logged, unless it is a note."""
        if not _is_note(record):
            self.show(record.getMessage())

    def show(self, message: str) -> None:
        """Show a warning, unless it was shown before."""
        if message not in self.shown:
            self.shown.add(message)
            self.console.print(f"warning: {message}", markup=False, highlight=False, soft_wrap=True)


class _Told(logging.Handler):
    """Shows some of what modules log, as it is: what a run does in detail, or what takes the user's time."""

    def __init__(self, console: Console, wanted: Callable[[logging.LogRecord], bool]) -> None:
        super().__init__(logging.INFO)
        self._console = console
        self.addFilter(wanted)

    def emit(self, record: logging.LogRecord) -> None:
        self._console.print(record.getMessage(), markup=False, highlight=False, soft_wrap=True)


def _is_note(record: logging.LogRecord) -> bool:
    """Whether a record is no warning, but tells of what takes the user's time."""
    return bool(getattr(record, "note", False))


@contextmanager
def verbosely(console: Console, *, wanted: bool) -> Iterator[None]:
    """Show what the package's loggers have to say below warnings, if that is wanted."""
    logger, handler = logging.getLogger("fissura"), _Told(console, lambda record: record.levelno < logging.WARNING)
    level = logger.level
    if wanted:
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(level)


@contextmanager
def warnings(console: Console, *, quiet: bool = False) -> Iterator[Warnings]:
    """Show warnings of the package's loggers on a console; unless quiet, that kernels are compiled, too."""
    if is_for_programs():
        console = Console(quiet=True)
    logger, handler = logging.getLogger("fissura"), Warnings(console)
    kernels, notes = logging.getLogger("fissura.kernels"), _Told(console, _is_note)
    logger.addHandler(handler)
    if not quiet:
        kernels.addHandler(notes)
    try:
        yield handler
    finally:
        logger.removeHandler(handler)
        kernels.removeHandler(notes)


def print_table(rows: Sequence[tuple[str, str]], title: str = "") -> None:
    """Print rows of name and value: a table in a terminal, plain lines elsewhere."""
    console = Console()
    if not console.is_terminal:
        from fissura.text.rows import aligned

        for line in aligned(rows):
            typer.echo(line)
        return
    table = Table(title=Text(title) if title else None, show_header=False)
    for name, value in rows:
        table.add_row(Text(name, style="bold"), Text(value))
    console.print(table)


def print_columns(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table with heads, columns aligned; wide ones are never wrapped."""
    widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]
    for row in (heads, *rows):
        typer.echo("  ".join(f"{text:<{width}}" for text, width in zip(row, widths, strict=True)).rstrip())
    typer.echo("")
