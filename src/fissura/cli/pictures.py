"""Commands that draw: ``fissura show`` a case, ``compare``, ``moments`` and ``animate`` finished runs."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from fissura.cli.console import check_ending, errors, print_table, warnings, writing
from fissura.cli.machine import comparison_json, print_json
from fissura.cli.options import CaseArgument, FullOption, JsonOption
from fissura.errors import InputError

if TYPE_CHECKING:
    from fissura.pictures.specimen import Sight
    from fissura.simulation.loop import Simulation

ResultArgument = Annotated[Path, typer.Argument(metavar="RESULT", help="Result folder.", show_default=False)]
StressOption = Annotated[
    bool, typer.Option("--stress", help="Colour bodies by their largest principal stress, not by size.")
]


def show(
    case: CaseArgument,
    output: Annotated[Path | None, typer.Option(help="File to write.", show_default="NAME_specimen.png")] = None,
    full: FullOption = False,
    interactive: Annotated[
        bool,
        typer.Option("--interactive", help="Turn it in a window (needs PyVista); with --output a picture of that."),
    ] = False,
    azimuth: Annotated[float, typer.Option(min=-360, max=360, help="Degrees to the right of the z axis.")] = 30.0,
    elevation: Annotated[float, typer.Option(min=-89, max=89, help="Degrees above the horizontal.")] = 25.0,
) -> None:
    """Draw the specimen of a case in 3D, with supports, loads and gauges, without running it."""
    with errors():
        from fissura.case import load_case
        from fissura.pictures.specimen import Sight, plot_specimen
        from fissura.simulation.loop import Simulation
        from fissura.simulation.memory import require_memory

        loaded = load_case(case)
        path = output if output is not None else Path(f"{loaded.name}_specimen.png")
        if interactive:
            _check_view(output)
        else:
            check_ending(path, "--output")
        require_memory(loaded, full=full)
        with warnings(Console(stderr=True)) as shown:
            simulation = Simulation(loaded, full=full)
            for notice in simulation.notices:
                shown.show(str(notice))
            if interactive:
                _view(simulation, output, Sight(azimuth, elevation))
            else:
                with writing(path):
                    plot_specimen(simulation, path, Sight(azimuth, elevation))
        if output is not None or not interactive:
            typer.echo(f"picture: {path}")


def _check_view(output: Path | None) -> None:
    """Refuse a view that cannot be shown, before anything is computed.

    Raises
    ------
    InputError
        PyVista is not installed, there is no screen, or the picture would be no PNG.
    """
    from fissura.pictures.pyvista_tools import can_open_windows, check_picture, pyvista

    pyvista()
    if output is None and not can_open_windows():
        allowed = "--output FILE.png, which makes a picture of the view, or no --interactive"
        raise InputError("--interactive", "there is no screen to open a window on", allowed)
    if output is not None:
        check_picture(output, "--output")


def _view(simulation: Simulation, output: Path | None, sight: Sight) -> None:
    """Show a specimen in a window until that is closed, or write a picture of it."""
    from fissura.pictures.pyvista_tools import shown
    from fissura.pictures.specimen_window import specimen_view

    view = specimen_view(simulation, sight, off_screen=output is not None)
    with writing(output) if output is not None else nullcontext():
        shown(view, simulation.case.name, output)


@contextmanager
def _placed(picture: Path, asked: Path | None, option: str) -> Iterator[None]:
    """Write a picture; where nobody asked for its place, which is a folder of results, it is listed there."""
    from fissura.files.folder import claimed

    with writing(picture):
        if asked is None:
            claimed(picture, option)
        yield


def compare(
    a: Annotated[Path, typer.Argument(metavar="A", help="Result folder.", show_default=False)],
    b: Annotated[Path, typer.Argument(metavar="B", help="Result folder: the reference.", show_default=False)],
    plot: Annotated[Path | None, typer.Option(help="File for the picture.", show_default="A/compare.png")] = None,
    bodies: Annotated[
        bool, typer.Option("--bodies", help="Draw bodies and cracks of both, too: compare_bodies.png.")
    ] = False,
    json: JsonOption = False,
) -> None:
    """Compare two runs: a table of differences, and a picture of both curves."""
    with errors(json=json):
        from fissura.results.compare import compare as compare_folders

        with warnings(Console(stderr=True)):
            comparison = compare_folders(a, b)
        if not json:
            print_table(comparison.table(), title=f"{a} against {b}")
        picture = plot if plot is not None else a / "compare.png"
        check_ending(picture, "--plot")
        with _placed(picture, plot, "--plot"):
            comparison.save(picture)
        pictures = [picture]
        if bodies:
            from fissura.pictures.comparison_files import save_bodies

            beside = picture.with_name(f"{picture.stem}_bodies{picture.suffix}")
            with _placed(beside, plot, "--plot"):
                save_bodies(comparison, beside)
            pictures.append(beside)
        if json:
            print_json({"a": str(a), "b": str(b), **comparison_json(comparison), "pictures": list(map(str, pictures))})
        else:
            for picture in pictures:
                typer.echo(f"picture: {picture}")


def moments(
    folder: ResultArgument,
    output: Annotated[Path | None, typer.Option(help="File to write.", show_default="RESULT/moments.png")] = None,
    stress: StressOption = False,
) -> None:
    """Draw bodies and crack at four moments of a run, and its curve."""
    with errors():
        from fissura.pictures.moments import plot_moments

        path = output if output is not None else folder / "moments.png"
        check_ending(path, "--output")
        with _placed(path, output, "--output"):
            plot_moments(folder, path, stress=stress)
        typer.echo(f"picture: {path}")


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
    with errors():
        from fissura.pictures.animation import animate as write_animation

        path = output if output is not None else folder / "refinement.gif"
        with _placed(path, output, "--output"):
            count = write_animation(folder, path, fps=fps, width=size, stress=stress)
        typer.echo(f"animation: {path}, {count} frames")
