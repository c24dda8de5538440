"""The command ``fissura report``, and the report at the end of ``fissura run``."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from fissura.cli.console import errors, not_written, warnings
from fissura.errors import RunStopped

if TYPE_CHECKING:
    from fissura.results.result import Result

__all__ = ["report", "report_at_end", "reported"]


def report(
    folder: Annotated[Path, typer.Argument(metavar="RESULT", help="Result folder.", show_default=False)],
    output: Annotated[
        Path | None, typer.Option(help="File to write, .html.", show_default="RESULT/report.html")
    ] = None,
) -> None:
    """Write one page about a run: its curve, bodies and cracks in 3D step by step, warnings, where it comes from."""
    with errors():
        reported(folder, output)


def reported(source: Path | Result, output: Path | None = None) -> None:
    """Write a report, and say where it is."""
    from fissura.pages import NAME
    from fissura.pages import report as write

    try:
        with warnings(Console(stderr=True)):
            path = write(source, output)
    except OSError as error:
        raise not_written(error, error.filename or output or NAME) from None
    typer.echo(f"report: {path}, {path.stat().st_size / 1e6:.1f} MB")


@contextmanager
def report_at_end(*, wanted: bool) -> Iterator[None]:
    """Refuse a report that cannot be made, before anything is computed; write that of a run that stops early.

    Raises
    ------
    InputError
        The extra ``report`` is not installed.
    """
    if not wanted:
        yield
        return
    from fissura.reports.libraries import require_libraries

    require_libraries()
    try:
        yield
    except RunStopped as error:
        result = getattr(error, "result", None)
        if result is not None and result.folder is not None:
            reported(result)
        raise
