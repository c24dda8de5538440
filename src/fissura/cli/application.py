"""The program ``fissura``: its commands together, and how it starts."""

import gc
import os
import sys
from typing import Annotated

import typer

from fissura.cli.calibrate import calibrate
from fissura.cli.console import NOT_WRITTEN, say
from fissura.cli.elastic import elastic
from fissura.cli.ensemble import ensemble
from fissura.cli.pictures import animate, compare, moments, show
from fissura.cli.report import report
from fissura.cli.running import check, new, run, schema
from fissura.cli.streams import forgiving, unwritten
from fissura.cli.study import study

app = typer.Typer(
    help="Simulates the fracture of concrete with adaptive discrete models.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)

# In the order in which the help lists them.
for command in (run, check, new, schema, show, report, compare, moments, animate, elastic, ensemble, calibrate, study):
    app.command()(command)


def main() -> None:
    """Run the command line; errors of the user end it with one message, never with a traceback.

    Output that nobody reads any more does not end it; output for which a disk has no room makes it fail at its end.
    """
    start_light()
    sys.stdout, sys.stderr = forgiving(sys.stdout), forgiving(sys.stderr)
    try:
        app()
    finally:
        problem = unwritten(sys.stdout)
        if problem:
            say(f"error: standard output: cannot be written: {problem}")
            raise SystemExit(NOT_WRITTEN)


def start_light() -> None:
    """Settings of the process that make its start cheaper; they change no result."""
    # Threads of OpenBLAS, of which NumPy and SciPy bring one copy each, spin after loading unless told to sleep.
    os.environ.setdefault("OPENBLAS_THREAD_TIMEOUT", "4")
    # Imports make many lasting objects; with the default of 700 the collector passes over them again and again.
    gc.set_threshold(50_000, 20, 50)


def _print_version(wanted: bool) -> None:
    if wanted:
        from fissura import __version__

        typer.echo(f"fissura {__version__}")
        raise typer.Exit


@app.callback()
def _top(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    pass
