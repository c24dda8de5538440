"""The command ``fissura``."""

from __future__ import annotations

import gc
import logging
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from fissura.ensemble.command import ensemble
from fissura.errors import FissuraError, InputError, RunStopped

if TYPE_CHECKING:
    from fissura.study.record import Record

__all__ = ["app", "main"]

BAD_INPUT, STOPPED, NOT_WRITTEN, INTERRUPTED = 2, 3, 4, 130

app = typer.Typer(
    help="Breaks concrete on a computer: adaptive discrete models of fracture.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)

ELASTIC_ALPHA = "0.05,0.1,0.2,0.29,0.4,0.5,0.7,1"

CaseArgument = Annotated[Path, typer.Argument(metavar="CASE", help="Case file (TOML).", show_default=False)]
ResultArgument = Annotated[Path, typer.Argument(metavar="RESULT", help="Result folder.", show_default=False)]
StressOption = Annotated[
    bool, typer.Option("--stress", help="Colour bodies by their largest principal stress, not by size.")
]


def main() -> None:
    """Run the command line; errors of the user end it with one message, never with a traceback."""
    start_light()
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")
    app()


def start_light() -> None:
    """Settings of the process that make its start cheaper; they change no result."""
    # Threads of OpenBLAS, of which NumPy and SciPy bring one copy each, spin after loading unless told to sleep.
    os.environ.setdefault("OPENBLAS_THREAD_TIMEOUT", "4")
    # Imports make many lasting objects; with the default of 700 the collector passes over them again and again.
    gc.set_threshold(50_000, 20, 50)


def _say(message: str) -> None:
    """Write a message to the user on standard error, unwrapped."""
    typer.echo(message, err=True)


@contextmanager
def _errors() -> Iterator[None]:
    """Turn the errors a user can meet into a message and an exit status."""
    try:
        yield
    except RunStopped as error:
        _say(f"error: {error}{_saved(error)}")
        raise typer.Exit(STOPPED) from None
    except FissuraError as error:
        _say(f"error: {error}")
        raise typer.Exit(BAD_INPUT) from None
    except KeyboardInterrupt as error:
        _say(f"interrupted{_saved(error)}")
        raise typer.Exit(INTERRUPTED) from None


def _saved(error: BaseException) -> str:
    """What was saved of a run that ended early."""
    result = getattr(error, "result", None)
    if result is None or result.folder is None:
        return "; nothing was saved"
    steps = len(result.curve["step"])
    return f"; the {steps} steps before it are saved in {result.folder}: {_names(result.folder)}"


def _names(folder: Path) -> str:
    """Names of the files in a folder."""
    return ", ".join(sorted(path.name for path in folder.iterdir() if path.is_file()))


def _print_table(rows: Sequence[tuple[str, str]], title: str = "") -> None:
    """Print rows of name and value: a table in a terminal, plain lines elsewhere."""
    console = Console()
    if not console.is_terminal:
        width = max(len(name) for name, _ in rows)
        for name, value in rows:
            typer.echo(f"{name:<{width}}  {value}")
        return
    table = Table(title=title or None, show_header=False)
    for name, value in rows:
        table.add_row(Text(name, style="bold"), Text(value))
    console.print(table)


class _Warnings(logging.Handler):
    """Shows what Fissura's modules log as warnings, each once."""

    def __init__(self, console: Console) -> None:
        super().__init__(logging.WARNING)
        self.console = console
        self.shown: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        self.show(record.getMessage())

    def show(self, message: str) -> None:
        if message not in self.shown:
            self.shown.add(message)
            self.console.print(f"warning: {message}", markup=False, highlight=False, soft_wrap=True)


@contextmanager
def _warnings(console: Console) -> Iterator[_Warnings]:
    """Show warnings of the package's loggers on a console."""
    logger, handler = logging.getLogger("fissura"), _Warnings(console)
    logger.addHandler(handler)
    try:
        yield handler
    finally:
        logger.removeHandler(handler)


@app.command()
def run(
    case: CaseArgument,
    full: Annotated[bool, typer.Option("--full", help="Full resolution everywhere, no adaptivity.")] = False,
    output: Annotated[Path | None, typer.Option(help="Folder for the results.", show_default="results/NAME")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace earlier results there.")] = False,
    seed: Annotated[int | None, typer.Option(min=0, help="Seed, instead of that of the case.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print errors and warnings only.")] = False,
) -> None:
    """Run a case and write its results."""
    from fissura.interrupts import interruptible

    with _errors(), interruptible(_say):
        from fissura import api
        from fissura.case import load_case
        from fissura.progress import RunProgress

        loaded = load_case(case)
        folder = output if output is not None else Path("results") / (loaded.name + ("_full" if full else ""))
        console = Console(stderr=True)
        progress = None if quiet else RunProgress(console, loaded)
        try:
            with _warnings(console) as warnings, progress or nullcontext():
                result = api.run(
                    loaded,
                    full=full,
                    output=folder,
                    overwrite=overwrite,
                    seed=seed,
                    on_start=progress.start if progress else None,
                    on_step=progress.step if progress else None,
                )
                for message in result.summary["warnings"]:
                    warnings.show(message)
        except OSError as error:
            where = error.filename or f"a file in {folder}"
            kept = f"kept in {folder}: {_names(folder)}" if folder.is_dir() else "nothing was kept"
            _say(f"error: {where}: cannot be written: {error.strerror or error}; {kept}")
            raise typer.Exit(NOT_WRITTEN) from None
        if not quiet:
            _print_table([*result.table(), ("results", str(folder)), ("files", _names(folder))])


@app.command()
def check(case: CaseArgument) -> None:
    """Validate a case and say what would be run, without running it."""
    with _errors():
        from fissura.case import load_case
        from fissura.check import report

        with _warnings(Console(stderr=True)) as warnings:
            found = report(load_case(case))
            _print_table(found.table())
            for message in found.warnings:
                warnings.show(message)


@app.command()
def new(
    template: Annotated[str | None, typer.Argument(help="Name of a template.", show_default=False)] = None,
    list_: Annotated[bool, typer.Option("--list", help="List the templates.")] = False,
) -> None:
    """Print a commented case to start from: fissura new beam > case.toml."""
    with _errors():
        folder = files("fissura") / "templates"
        known = {item.name.removesuffix(".toml"): item for item in folder.iterdir() if item.name.endswith(".toml")}
        if list_:
            for name in sorted(known):
                first = known[name].read_text(encoding="utf-8").splitlines()[0]
                typer.echo(f"{name:<10} {first.removeprefix('#').strip()}")
        elif template not in known:
            problem = f"{template!r} is not known" if template else "missing"
            raise InputError("template", problem, ", ".join(sorted(known)))
        else:
            typer.echo(known[template].read_text(encoding="utf-8"), nl=False)


@app.command()
def compare(
    a: Annotated[Path, typer.Argument(metavar="A", help="Result folder.", show_default=False)],
    b: Annotated[Path, typer.Argument(metavar="B", help="Result folder: the reference.", show_default=False)],
    plot: Annotated[Path | None, typer.Option(help="File for the picture.", show_default="A/compare.png")] = None,
    bodies: Annotated[
        bool, typer.Option("--bodies", help="Draw bodies and cracks of both, too: compare_bodies.png.")
    ] = False,
) -> None:
    """Compare two runs: a table of differences, and a picture of both curves."""
    with _errors():
        from fissura.results.compare import compare as compare_folders

        comparison = compare_folders(a, b)
        _print_table(comparison.table(), title=f"{a} against {b}")
        picture = plot if plot is not None else a / "compare.png"
        with _writing(picture, "--plot"):
            comparison.plot(picture)
        typer.echo(f"picture: {picture}")
        if bodies:
            from fissura.results.moments import plot_bodies

            beside = picture.with_name(f"{picture.stem}_bodies{picture.suffix}")
            with _writing(beside, "--plot"):
                plot_bodies(comparison, beside)
            typer.echo(f"picture: {beside}")


@app.command()
def moments(
    folder: ResultArgument,
    output: Annotated[Path | None, typer.Option(help="File to write.", show_default="RESULT/moments.png")] = None,
    stress: StressOption = False,
) -> None:
    """Draw bodies and crack at four moments of a run, and its curve."""
    with _errors():
        from fissura.results.moments import plot_moments

        path = output if output is not None else folder / "moments.png"
        with _writing(path, "--output"):
            plot_moments(folder, path, stress=stress)
        typer.echo(f"picture: {path}")


@app.command()
def animate(
    folder: ResultArgument,
    output: Annotated[
        Path | None,
        typer.Option(help="File to write: .gif, or .mp4 with ffmpeg.", show_default="RESULT/refinement.gif"),
    ] = None,
    fps: Annotated[int, typer.Option(min=1, max=50, help="Frames per second.")] = 10,
    size: Annotated[int, typer.Option(min=320, max=4000, help="Width in pixels.")] = 960,
    stress: StressOption = False,
) -> None:
    """Animate a run: bodies grow finer, the crack opens, the curve grows."""
    with _errors():
        from fissura.results.animation import animate as write_animation

        path = output if output is not None else folder / "refinement.gif"
        with _writing(path, "--output"):
            count = write_animation(folder, path, fps=fps, width=size, stress=stress)
        typer.echo(f"animation: {path}, {count} frames")


@contextmanager
def _writing(picture: Path, option: str) -> Iterator[None]:
    """Turn what can go wrong in writing a picture into a message."""
    try:
        yield
    except OSError as error:
        _say(f"error: {picture}: cannot be written: {error.strerror or error}")
        raise typer.Exit(NOT_WRITTEN) from None
    except ValueError as error:  # matplotlib does not know the file's type
        if isinstance(error, FissuraError):
            raise
        raise InputError(option, f"{picture}: {error}", "a name that ends in .png, .pdf or .svg") from None


@app.command()
def elastic(
    case: Annotated[
        Path | None, typer.Argument(metavar="[CASE]", help="Print the constants of this case.", show_default=False)
    ] = None,
    alpha: Annotated[str, typer.Option(help="Tangential over normal stiffness of contacts.")] = ELASTIC_ALPHA,
    sizes: Annotated[str, typer.Option(help="Sides of cells and widths of prisms, in l_min.")] = "4,6,8,12",
    seeds: Annotated[int, typer.Option(min=1, help="Number of structures of each kind and size.")] = 5,
    aspect: Annotated[float, typer.Option(min=1.0, max=10.0, help="Length over width of prisms; 1: cubes.")] = 2.0,
    modulus: Annotated[
        str | None, typer.Option("--E", metavar="STRESS", help='Modulus of contacts, "60 GPa"; else all are relative.')
    ] = None,
    inverse: Annotated[
        tuple[str, str] | None,
        typer.Option(metavar="E=38GPa nu=0.18", help="Print the contact constants that give these of the material."),
    ] = None,
    output: Annotated[Path, typer.Option(help="Folder for table and pictures.")] = Path("results/elastic"),
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace earlier results there.")] = False,
) -> None:
    """Elastic constants of the material as a whole: computed from structures, of a case, or the inverse."""
    with _errors():
        from fissura.elasticity import request

        if inverse is not None:
            if case is not None:
                raise InputError("--inverse", "is given together with a case", "one of both")
            _print_table(request.inverse_rows(*request.parse_inverse(inverse)))
        elif case is not None:
            from fissura.case import load_case

            _print_table(request.case_rows(load_case(case)))
        else:
            E = None if modulus is None else request.parse_modulus(modulus, "--E")
            wanted = request.parse_numbers(alpha, "--alpha", 0.0, 1.0, above=True)
            widths = request.parse_numbers(sizes, "--sizes", request.SMALLEST, request.LARGEST)
            _elastic_study(wanted, widths, seeds, aspect, E, output, overwrite)


def _elastic_study(
    alphas: Sequence[float],
    sizes: Sequence[float],
    seeds: int,
    aspect: float,
    E: float | None,
    output: Path,
    overwrite: bool,
) -> None:
    """Compute, print and write a study of elastic constants."""
    from rich.progress import Progress

    from fissura.api import prepare_folder
    from fissura.elasticity import request
    from fissura.elasticity.study import structure_seeds, study

    folder = prepare_folder(output, overwrite=overwrite)
    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("structures", total=None)
        found = study(
            alphas,
            sizes,
            structure_seeds(seeds),
            aspect=aspect,
            on_structure=lambda done, total: bar.update(task, completed=done, total=total),
        )
    for heads, rows in (request.study_table(found, E), request.layer_table(found)):
        if rows:
            _print_columns(heads, rows)
    try:
        names = request.write(found, folder, E)
    except OSError as error:
        _say(f"error: {folder}: cannot be written: {error.strerror or error}")
        raise typer.Exit(NOT_WRITTEN) from None
    typer.echo(f"written in {folder}: {', '.join(names)}")


def _print_columns(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table with heads, columns aligned; wide ones are never wrapped."""
    widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]
    for row in (heads, *rows):
        typer.echo("  ".join(f"{text:<{width}}" for text, width in zip(row, widths, strict=True)).rstrip())
    typer.echo("")


app.command()(ensemble)


@app.command()
def study(
    plan: Annotated[Path, typer.Argument(metavar="STUDY", help="Study file (TOML).", show_default=False)],
    output: Annotated[Path | None, typer.Option(help="Folder.", show_default="results/NAME of the file")] = None,
    workers: Annotated[int, typer.Option(min=1, help="Runs at the same time.")] = 1,
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
    from fissura.interrupts import interruptible

    folder = output if output is not None else Path("results") / plan.stem
    with _errors(), interruptible(_say):
        from fissura.study import load_plan, run_study, write_outcome

        def tell(task: object, record: Record, left: int) -> None:
            if not quiet:
                seconds = f"{record.summary['cpu_s']:.1f} s" if record.summary else "no steps"
                _say(f"{task}: {record.status}, {seconds}; {left} left")

        try:
            found = run_study(load_plan(plan), folder, workers=workers, again=again or (), run=not report, on_done=tell)
            files = write_outcome(found, folder)
        except KeyboardInterrupt:
            _say(f"interrupted; finished runs are saved in {folder}, the same command goes on from there")
            raise typer.Exit(INTERRUPTED) from None
        except OSError as error:
            _say(f"error: {error.filename or folder}: cannot be written: {error.strerror or error}")
            raise typer.Exit(NOT_WRITTEN) from None
        early = sum(not m.finished for m in found.found)
        _print_table(
            [
                ("adaptive runs", f"{len(found.found)}, {early} of which did not finish or have a twin that did not"),
                ("runs left", f"{found.left}"),
                ("written", ", ".join(str(path) for path in files)),
            ]
        )


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


if __name__ == "__main__":
    main()
