"""Pictures of docs/loading.md, drawn from the runs of `loading.py`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fissura import Result
from fissura.pictures.curves import BLUE, DPI, GREY, ORANGE, headline, legend, tidy
from fissura.pictures.lettering import save
from fissura.pictures.moments import plot_moments

__all__ = ["draw"]


def draw(results: dict[str, Result], folder: Path) -> None:
    """Draw all pictures.

    Parameters
    ----------
    results : dict of str to Result
        Runs by their names, with their folders.
    folder : Path
        Where to draw.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name, file in (
        ("four-point bending", "four_point_bending"),
        ("four-point shear", "four_point_shear"),
        ("shear of 10 kN, then tension", "nooru_mohamed"),
    ):
        plot_moments(_folder(results[name]), folder / f"loading_{file}.png")
    _cycles(results, folder / "loading_cycles.png")
    _weight(results, folder / "loading_weight.png")


def _folder(result: Result) -> Path:
    assert result.folder is not None
    return result.folder


def _curve(axes: Axes, result: Result, colour: str, label: str, width: float = 1.5) -> None:
    """Load over gauge, from rest."""
    gauge, load = (np.append(0.0, values) for values in (result.gauge, result.load_values))
    axes.plot(1e6 * gauge, 1e-3 * load, color=colour, linewidth=width, label=label)


def _finish(axes: Axes, name: str, note: str) -> None:
    axes.set_xlabel("crack mouth opening [µm]")
    axes.set_ylabel("load [kN]")
    axes.axhline(0.0, color="#30343b", linewidth=0.8)
    headline(axes, name, note)
    tidy(axes)
    legend(axes, loc="lower right")


def _cycles(results: dict[str, Result], to: Path) -> None:
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    _curve(left, results["the same, without cycles"], GREY, "without cycles", 4.0)
    _curve(left, results["cycles"], BLUE, "five cycles")
    _finish(left, "Cycles", "unloaded to 5 % of the load, the published law")
    _curve(right, results["load turned round, published law"], BLUE, "cusatis-cedolin")
    _curve(right, results["load turned round, closing law"], ORANGE, "cusatis-cedolin-closing")
    _finish(right, "The load turned round", "to minus a half, and back")
    save(figure, to, DPI)


def _weight(results: dict[str, Result], to: Path) -> None:
    figure = Figure(figsize=(7.2, 4.2), layout="constrained")
    axes = figure.add_subplot()
    _curve(axes, results["the same without weight"], GREY, "without weight", 3.0)
    _curve(axes, results["beam under its weight"], BLUE, "with its weight")
    _finish(axes, "A beam of 1 m under its weight", "the weight is put on first")
    save(figure, to, DPI)
