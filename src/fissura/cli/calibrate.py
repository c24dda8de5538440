"""The command ``fissura calibrate``."""

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from fissura.cli.console import errors, print_table, say, warnings
from fissura.cli.options import FullOption, OverwriteOption, QuietOption, ResumeOption, SchedulerOption, WorkersOption
from fissura.cli.resuming import Resumable
from fissura.machine.interrupts import interruptible


def calibrate(
    case: Annotated[
        Path,
        typer.Argument(
            metavar="CASE", help="Case file; or a file with tables [[test]] and unknowns.", show_default=False
        ),
    ],
    measured: Annotated[
        list[Path] | None,
        typer.Argument(metavar="MEASURED", help="CSV file of a curve or a band; or one for each specimen."),
    ] = None,
    unknown: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=LOWER..UPPER",
            help="A key to find, with or without bounds; repeatable.",
            show_default="material.f_t, material.G_t",
        ),
    ] = None,
    fixed: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="A value that the case gets before; repeatable."),
    ] = None,
    seeds: Annotated[int | None, typer.Option(min=2, help="Random structures of a round.", show_default="6")] = None,
    runs: Annotated[
        int | None,
        typer.Option(min=1, help="Runs at most.", show_default="40 for each test, more for more than 3 unknowns"),
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed of all.", show_default="that of the case")] = None,
    specimens: Annotated[
        int | None, typer.Option(min=1, help="Specimens behind what was measured.", show_default="1; 2 of a band")
    ] = None,
    units: Annotated[
        str | None, typer.Option(metavar="UNITS", help='Units of the columns, such as "mm, kN".', show_default=False)
    ] = None,
    columns: Annotated[
        str | None,
        typer.Option(metavar="NAMES", help="Columns that are meant, if there are more.", show_default=False),
    ] = None,
    workers: WorkersOption = None,
    scheduler: SchedulerOption = None,
    full: FullOption = False,
    resume: ResumeOption = False,
    overwrite: OverwriteOption = False,
    output: Annotated[
        Path | None, typer.Option(help="Folder for the results.", show_default="results/NAME_calibration")
    ] = None,
    quiet: QuietOption = False,
) -> None:
    """Find keys of a case from measured curves, with their standard errors."""
    with errors(), interruptible(say):
        from fissura.calibration.progress import CalibrationProgress
        from fissura.calibration.request import unknown_option
        from fissura.calibration.runner import calibrate as run
        from fissura.cli.values import setting

        folder = output if output is not None else Path("results") / f"{case.stem}_calibration"
        console = Console(stderr=True)
        progress = None if quiet else CalibrationProgress(console)
        instead = " instead of --overwrite" if overwrite else ""
        resumable = Resumable(folder, f"the same command with --resume{instead} goes on from there")
        unknowns: dict[str, Any] | None = dict(map(unknown_option, unknown)) if unknown else None
        with resumable, warnings(console, quiet=quiet), progress or nullcontext():
            result = run(
                case,
                measured or None,
                unknowns,
                output=folder,
                fixed=dict(map(setting, fixed)) if fixed else None,
                seeds=seeds,
                runs=runs,
                seed=seed,
                specimens=specimens,
                units=_words(units),
                columns=_words(columns),
                full=full,
                resume=resume,
                overwrite=overwrite,
                workers=workers,
                scheduler=scheduler,
                on_start=resumable.beginning(progress.start if progress else None),
                on_round=progress.round if progress else None,
                on_outcome=progress.outcome if progress else None,
            )
        if not quiet:
            print_table([*result.table(), ("results", str(folder)), ("page", str(folder / "calibration.html"))])


def _words(text: str | None) -> list[str]:
    return [word.strip() for word in text.split(",") if word.strip()] if text else []
