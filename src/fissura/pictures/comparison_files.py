"""Files that comparisons are written to: their numbers, and pictures of them."""

from pathlib import Path

from matplotlib.backend_bases import FigureCanvasBase

from fissura.errors import InputError
from fissura.files.atomic import csv_bytes, plain, write_atomically, write_json
from fissura.pictures.curves import DPI, comparison_figure
from fissura.pictures.lettering import save
from fissura.pictures.moments import bodies_figure
from fissura.results.comparison import Comparison

HEADS = ("a", "b", "difference")
"""Of the columns of numbers."""


def saved(comparison: Comparison, path: Path) -> Path:
    """Write numbers or the picture, as the ending of the name says; see `Comparison.save`."""
    form = path.suffix.lower().removeprefix(".")
    if form == "csv":
        rows = ((name, *values) for name, values in comparison.numbers().items())
        write_atomically(path, csv_bytes([("quantity", *HEADS), *rows]))
    elif form == "json":
        write_json(
            path, plain({name: dict(zip(HEADS, values, strict=True)) for name, values in comparison.numbers().items()})
        )
    elif form in FigureCanvasBase.filetypes:
        save(comparison_figure(comparison), path, DPI)
    else:
        known = ", ".join(f".{name}" for name in ("csv", "json", *sorted(FigureCanvasBase.filetypes)))
        raise InputError("path", f"{path}: {path.suffix or 'no ending'} is no file of a comparison", known)
    return path


def save_bodies(comparison: Comparison, path: Path) -> None:
    """Write the picture of `Comparison.plot_bodies`.

    Parameters
    ----------
    comparison : Comparison
        The runs.
    path : Path
        File to write; its ending decides the format.

    Raises
    ------
    InputError
        A run was read from a folder without sections.
    """
    save(bodies_figure(comparison)[0], path, DPI)
