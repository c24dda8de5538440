"""Commands about one case: ``fissura run``, ``check`` and ``new``, and ``schema`` of all cases."""

from __future__ import annotations

from contextlib import nullcontext
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from fissura.cli.console import (
    errors,
    file_names,
    go_on,
    not_written,
    print_table,
    say,
    verbosely,
    warnings,
)
from fissura.cli.machine import check_json, print_json
from fissura.cli.options import CaseArgument, FullOption, JsonOption, OverwriteOption, QuietOption
from fissura.cli.report import report_at_end, reported
from fissura.errors import InputError
from fissura.machine.interrupts import interruptible

if TYPE_CHECKING:
    from fissura.simulation.loop import Simulation

#: What TOML editors look for in the first line of a case, and what to do for it.
_HEAD = """\
#:schema ./fissura.schema.json
# Editors complete and check keys by this file, which is written by: fissura schema > fissura.schema.json"""


def run(
    case: CaseArgument,
    full: FullOption = False,
    output: Annotated[Path | None, typer.Option(help="Folder for the results.", show_default="results/NAME")] = None,
    overwrite: OverwriteOption = False,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the run in the folder.")] = False,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed, instead of that of the case.")] = None,
    report: Annotated[bool, typer.Option("--report", help="Write a page about it at the end: report.html.")] = False,
    quiet: QuietOption = False,
    verbose: Annotated[bool, typer.Option("--verbose", help="Tell what happens within steps, too.")] = False,
    json: JsonOption = False,
) -> None:
    """Run a case and write its results."""
    quiet |= json
    with errors(json=json), interruptible(_nothing if json else say), report_at_end(wanted=report):
        from fissura.case import load_case

        loaded = load_case(case)  # what is wrong with it is told before all that a run needs is imported
        from fissura.progress.live import RunProgress
        from fissura.running.run import run as run_case

        folder = output if output is not None else Path("results") / (loaded.name + ("_full" if full else ""))
        console = Console(stderr=True)
        progress = None if quiet else RunProgress(console, loaded)
        begun = False

        def start(simulation: Simulation) -> None:
            nonlocal begun
            begun = True
            if progress is not None:
                progress.start(simulation)

        try:
            with (
                warnings(console, quiet=quiet) as shown,
                verbosely(console, wanted=verbose and not json),
                progress or nullcontext(),
            ):
                result = run_case(
                    loaded,
                    full=full,
                    output=folder,
                    overwrite=overwrite,
                    resume=resume,
                    seed=seed,
                    on_start=start,
                    on_step=progress.step if progress else None,
                )
                for message in result.summary["warnings"]:
                    shown.show(message)
        except OSError as error:
            kept = f"kept in {folder}: {file_names(folder)}{go_on(folder)}" if folder.is_dir() else "nothing was kept"
            raise not_written(error, error.filename or f"a file in {folder}", kept) from None
        if json:
            print_json({**result.summary, "folder": str(folder), "files": file_names(folder).split(", ")})
        elif not begun:
            farther = "no stage goes further" if result.case.stage else "control.target is not larger"
            say(f"the run in {folder} has ended, and {farther}: nothing was changed")
        if not quiet:
            print_table([*result.table(), ("results", str(folder)), ("files", file_names(folder))])
        if report:
            reported(result)


def _nothing(message: str) -> None:
    """Say nothing."""


def check(
    case: CaseArgument,
    build: Annotated[
        bool,
        typer.Option("--build", help="Count bodies and contacts, even if kernels have to be compiled for it first."),
    ] = False,
    json: JsonOption = False,
) -> None:
    """Validate a case and say what would be run, without running it."""
    with errors(json=json):
        from fissura.case import load_case

        with warnings(Console(stderr=True)) as shown:
            loaded = load_case(case)
            from fissura.api.check import check as checked

            found = checked(loaded, build=build or None)
            if json:
                print_json(check_json(found))
                return
            print_table(found.table())
            for notice in found.warnings:
                shown.show(str(notice))


def new(
    template: Annotated[str | None, typer.Argument(help="Name of a template.", show_default=False)] = None,
    list_: Annotated[bool, typer.Option("--list", help="List the templates.")] = False,
) -> None:
    """Print a commented case to start from: fissura new beam > case.toml."""
    with errors():
        folder = files("fissura") / "templates"
        known = {item.name.removesuffix(".toml"): item for item in folder.iterdir() if item.name.endswith(".toml")}
        if list_:
            for name in sorted(known):
                first = known[name].read_text(encoding="utf-8").splitlines()[0]
                typer.echo(f"{name:<20} {first.removeprefix('#').strip()}")
        elif template not in known:
            problem = f"{template!r} is not known" if template else "missing"
            raise InputError("template", problem, ", ".join(sorted(known)))
        else:
            typer.echo(_HEAD)
            typer.echo(known[template].read_text(encoding="utf-8"), nl=False)


def schema() -> None:
    """Print the JSON schema of case files, for editors: fissura schema > fissura.schema.json."""
    with errors():
        import json

        from fissura.case.schema import case_schema

        typer.echo(json.dumps(case_schema(), indent=1))
