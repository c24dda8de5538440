"""The command ``fissura report``, and the report at the end of ``fissura run``."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from fissura.cli.console import errors, not_written, warnings
from fissura.cli.machine import is_for_programs
from fissura.errors import RunStopped

if TYPE_CHECKING:
    from fissura.results.result import Result


def report(
    folder: Annotated[Path, typer.Argument(metavar="RESULT", help="Result folder.", show_default=False)],
    output: Annotated[
        Path | None, typer.Option(help="File to write, .html.", show_default="RESULT/report.html")
    ] = None,
    runs: Annotated[
        bool, typer.Option("--runs", help="Of an ensemble: write pages of all its runs, too, and link them.")
    ] = False,
) -> None:
    """Write one page about a run, or an ensemble: curves and a 3D view that move, warnings, where it comes from."""
    with errors():
        reported(folder, output, runs=runs)


def reported(source: Path | Result, output: Path | None = None, *, runs: bool = False) -> None:
    """Write a report, and say where it is."""
    from rich.progress import Progress

    from fissura.api.pages import NAME
    from fissura.api.pages import report as write

    console = Console(stderr=True)
    try:
        with warnings(console), Progress(console=console, transient=True, disable=not runs) as bar:
            task = bar.add_task("pages of runs", total=None)
            path = write(
                source, output, runs=runs, on_run=lambda done, count: bar.update(task, completed=done, total=count)
            )
    except OSError as error:
        raise not_written(error, error.filename or output or NAME) from None
    if not is_for_programs():
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
