"""The command ``fissura ensemble``."""

from contextlib import nullcontext
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from fissura.cli.console import STOPPED, errors, print_table, say, warnings
from fissura.cli.options import (
    CaseArgument,
    FullOption,
    OverwriteOption,
    QuietOption,
    ResumeOption,
    SchedulerOption,
    WorkersOption,
)
from fissura.cli.resuming import Resumable
from fissura.machine.interrupts import interruptible


class Mode(StrEnum):
    """What is random."""

    geometry = "geometry"
    field = "field"
    both = "both"


class Sampling(StrEnum):
    """How the field is sampled."""

    monte_carlo = "monte-carlo"
    latin_hypercube = "latin-hypercube"


class Companions(StrEnum):
    """Deterministic runs for comparison."""

    one = "one"
    each = "each"
    none = "none"


def ensemble(
    case: CaseArgument,
    runs: Annotated[
        int | None,
        typer.Option(min=1, help="Number of realisations.", show_default="[ensemble] of the case; 1 with --vary"),
    ] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(metavar="KEY=VALUES", help='Values of a key, such as "material.f_t=2.5 MPa, 3 MPa"; repeatable.'),
    ] = None,
    together: Annotated[
        bool, typer.Option("--together", help="Vary keys together instead of in all combinations.")
    ] = False,
    seeds: Annotated[
        str | None,
        typer.Option(metavar="SEEDS", help='Seeds of the realisations, such as "1, 2, 3", instead of --runs.'),
    ] = None,
    mode: Annotated[
        Mode | None, typer.Option(help="What is random.", show_default="both with a [field], else geometry")
    ] = None,
    sampling: Annotated[Sampling, typer.Option(help="How the field is sampled.")] = Sampling.monte_carlo,
    leading_modes: Annotated[
        int | None,
        typer.Option(min=1, help="Modes that Latin hypercubes stratify.", show_default="10, or all if fewer"),
    ] = None,
    companions: Annotated[
        Companions | None,
        typer.Option(
            help="Runs without a field: one, one for each realisation, or none.", show_default="one; none with --vary"
        ),
    ] = None,
    workers: WorkersOption = None,
    threads_per_worker: Annotated[int, typer.Option(min=1, help="Threads of each.")] = 1,
    scheduler: SchedulerOption = None,
    full: FullOption = False,
    keep: Annotated[
        bool, typer.Option("--keep", help="Keep all the files of every run, pictures and VTK, too.")
    ] = False,
    resume: ResumeOption = False,
    overwrite: OverwriteOption = False,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Seed of the ensemble.", show_default="that of the case")
    ] = None,
    output: Annotated[
        Path | None, typer.Option(help="Folder for the results.", show_default="results/NAME_ensemble")
    ] = None,
    quiet: QuietOption = False,
) -> None:
    """Run many realisations of a case, on all processors or on a cluster, and evaluate them together.

    With --vary, or vary in the table [ensemble] of the case, it is a parameter study: the same realisations at each
    point.
    """
    with errors(), interruptible(say):
        from fissura.case import load_case
        from fissura.cli.values import seed_list, varied
        from fissura.ensemble.kept import kept
        from fissura.ensemble.progress import EnsembleProgress
        from fissura.ensemble.runner import run_ensemble

        loaded = load_case(case)
        name = loaded.name + ("_full" if full else "") + "_ensemble"
        folder = output if output is not None else Path("results") / name
        console = Console(stderr=True)
        progress = None if quiet else EnsembleProgress(console)
        instead = " instead of --overwrite" if overwrite else ""
        resumable = Resumable(folder, f"the same command with --resume{instead} goes on from there")
        with resumable, warnings(console, quiet=quiet), progress or nullcontext():
            result = run_ensemble(
                loaded,
                runs,
                output=folder,
                vary=None if not vary else varied(vary),
                combine="together" if together else None,
                seeds=None if seeds is None else seed_list(seeds),
                mode=None if mode is None else mode.value,
                sampling=sampling.value,
                leading_modes=leading_modes,
                companions=None if companions is None else companions.value,
                seed=seed,
                full=full,
                keep=keep,
                resume=resume,
                overwrite=overwrite,
                workers=workers,
                threads_per_worker=threads_per_worker,
                scheduler=scheduler,
                on_start=resumable.beginning(progress.start if progress else None),
                on_outcome=progress.outcome if progress else None,
            )
        if not quiet:
            print_table([*result.table(), ("results", str(folder)), ("report", str(folder / "report.html"))])
        if not result.complete:
            unfinished = result.unfinished()
            for name, reason in unfinished[:10]:
                say(f"{name} {reason}")
            more = f", {len(unfinished) - 10} more of them not named here" if len(unfinished) > 10 else ""
            say(f"error: {len(unfinished)} runs did not finish{more}; see {folder / 'report.html'}")
            again = len(kept(folder).again)
            if again:
                say(f"--resume tries {again} of them again, which failed for want of memory or the like")
            raise typer.Exit(STOPPED)
