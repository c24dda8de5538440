"""The command ``fissura study``."""

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from fissura.cli.console import errors, print_table, say, warnings
from fissura.cli.options import SchedulerOption
from fissura.cli.resuming import Resumable
from fissura.machine.interrupts import interruptible


def study(
    plan: Annotated[Path, typer.Argument(metavar="STUDY", help="Study file (TOML).", show_default=False)],
    output: Annotated[Path | None, typer.Option(help="Folder.", show_default="results/NAME of the file")] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Runs at the same time.", show_default="1")] = None,
    scheduler: SchedulerOption = None,
    again: Annotated[
        list[str] | None,
        typer.Option(help="Run this variation once more; also: full, failures. May be given several times."),
    ] = None,
    report: Annotated[bool, typer.Option("--report", help="Run nothing, only compare what is there.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print errors and the outcome only.")] = False,
) -> None:
    """Run specimens with several choices of parameters, adaptive and at full resolution, and compare them.

    What the folder has already is not run again, so that an interrupted study goes on where it was.
    """
    folder = output if output is not None else Path("results") / plan.stem
    with errors(), interruptible(say):
        from fissura.study.definition import load_study
        from fissura.study.progress import StudyProgress
        from fissura.study.runner import run_study, write_result

        console = Console(stderr=True)
        progress = None if quiet else StudyProgress(console)
        resumable = Resumable(folder, f"the same command{' without --again' if again else ''} goes on from there")
        with resumable:
            with warnings(console, quiet=quiet), progress or nullcontext():
                found = run_study(
                    load_study(plan),
                    folder,
                    workers=workers,
                    scheduler=scheduler,
                    again=again or (),
                    run=not report,
                    on_start=resumable.beginning(progress.start if progress else None),
                    on_done=progress.done if progress else None,
                )
            files = write_result(found, folder)
        early = sum(not m.finished for m in found.found)
        print_table(
            [
                (
                    "adaptive runs",
                    f"{len(found.found)}, {early} of which did not finish, or whose run at full resolution did not",
                ),
                ("runs left", f"{found.left}"),
                ("written", ", ".join(str(path) for path in files)),
            ]
        )
