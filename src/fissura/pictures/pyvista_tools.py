"""PyVista, which the extra ``view`` brings: loading it, windows, pictures of views, polygons as meshes."""

import os
import subprocess
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from fissura.arrays import FloatArray, IntArray
from fissura.errors import InputError
from fissura.files.atomic import replacing
from fissura.pictures.curves import INK
from fissura.pictures.lettering import literal

WINDOW = (1100, 800)
"""Size of a view [pixels]."""

COLUMNS = 4
"""Columns of a legend."""

_TRIAL = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderWindow
window = vtkRenderWindow()
window.SetOffScreenRendering(1)
window.Render()
"""


def pyvista() -> Any:
    """The module PyVista.

    Raises
    ------
    InputError
        It is not installed.
    """
    try:
        return import_module("pyvista")
    except ImportError:
        raise InputError("pyvista", "is not installed; 3D views need it", 'pip install "fissura[view]"') from None


def can_open_windows() -> bool:
    """Whether there is a screen to open windows on."""
    return not sys.platform.startswith("linux") or any(map(os.environ.get, ("DISPLAY", "WAYLAND_DISPLAY")))


@cache
def can_render() -> bool:
    """Whether anything can be drawn: on a screen, or without one by EGL or OSMesa.

    Where there is neither, drawing ends the process, so that another one tries first.
    """
    if can_open_windows():
        return True
    done = subprocess.run([sys.executable, "-c", _TRIAL], capture_output=True, timeout=120, check=False)
    return done.returncode == 0


def plotter(*, off_screen: bool | None = None) -> Any:
    """An empty view, white, with axes in a corner.

    Parameters
    ----------
    off_screen : bool, optional
        Whether it is drawn into memory instead of a window; None where PyVista decides, as in a notebook.

    Raises
    ------
    InputError
        PyVista is not installed, or nothing can be drawn here.
    """
    pyvista()
    if not can_render():
        allowed = "a screen, or OpenGL without one: a package such as libegl1 or libosmesa6"
        raise InputError("pyvista", "cannot draw on this machine", allowed)
    with _quiet():
        view = pyvista().Plotter(off_screen=off_screen, window_size=list(WINDOW), theme=_theme())
    view.add_axes(line_width=3, viewport=(0.0, 0.16, 0.14, 0.36))
    return view


def screenshot(view: Any, path: Path) -> None:
    """Write a picture of a view, as a whole or not at all; the view is closed after it.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    with _quiet():
        pixels = view.screenshot(return_img=True)
        view.close()
    with replacing(path) as part, part.open("wb") as file:
        Image.fromarray(pixels).save(file, format="PNG")


def legend(view: Any, entries: Sequence[tuple[str, str]]) -> None:
    """Names beside squares of their colours, along the lower edge of a view.

    PyVista's own legend writes names in the colours, of which light ones cannot be read.

    Parameters
    ----------
    view : pyvista.Plotter
        Where.
    entries : sequence of (str, str)
        Names and colours; each name is shown once.
    """
    names = dict(entries)
    rows = -(-len(names) // COLUMNS)
    for k, (name, colour) in enumerate(names.items()):
        at = 0.02 + (k // rows) * 0.97 / COLUMNS, 0.02 + (rows - 1 - k % rows) * 0.033
        square = view.add_text("M", position=at, viewport=True, font_size=8, color=colour)
        square.prop.background_color, square.prop.background_opacity = colour, 1.0
        view.add_text(literal(name), position=(at[0] + 0.025, at[1]), viewport=True, font_size=8, color=INK)


def shown(view: Any, title: str, output: Path | None = None) -> Any:
    """Open a window, show a view in a notebook, or write a picture of it.

    Raises
    ------
    InputError
        There is no screen to open a window on, or the picture would be no PNG.
    OSError
        The file cannot be written.
    """
    if output is not None:
        check_picture(output, "output")
        return screenshot(view, output)
    if not view.notebook and not can_open_windows():
        view.close()
        raise InputError("show", "there is no screen to open a window on", 'output="FILE.png"')
    with warnings.catch_warnings():  # docs/python.md says what lets views turn in notebooks
        warnings.filterwarnings("ignore", "Using static image")
        return view.show(title=title)


def check_picture(output: Path, key: str) -> None:
    """Refuse a picture of a view that is no PNG.

    Raises
    ------
    InputError
        It would be none.
    """
    if output.suffix.lower() != ".png":
        raise InputError(key, f"{output}: views are written as .png only", "a name that ends in .png")


def toggled(view: Any, actors: Sequence[Any], opacity: float, hint: str) -> None:
    """Let the key ``t`` make some actors transparent and opaque again, and say so in the view; windows only."""
    if view.off_screen or view.notebook:
        return

    def toggle() -> None:
        for actor in actors:
            actor.prop.opacity = opacity if actor.prop.opacity > opacity else 1.0
        view.render()

    view.add_key_event("t", toggle)
    view.add_text(f"t: {hint}, q: close", position="upper_right", font_size=8, color="#6b7280")


def polygon_mesh(points: FloatArray, offsets: IntArray) -> Any:
    """Polygons as a PyVista mesh, one cell for each.

    Parameters
    ----------
    points : (p, 3) array
        Corners of all polygons, one polygon after another.
    offsets : (q + 1,) array
        Corners of polygon ``k`` are ``points[offsets[k]:offsets[k + 1]]``.
    """
    sizes = np.diff(offsets)
    if not len(sizes):
        return pyvista().PolyData()
    return pyvista().PolyData(points, np.insert(np.arange(len(points)), offsets[:-1], sizes))


def _theme() -> Any:
    theme = pyvista().themes.DocumentTheme()
    theme.font.color = INK
    theme.lighting_params.ambient, theme.lighting_params.diffuse = 0.25, 0.8
    return theme


@contextmanager
def _quiet() -> Iterator[None]:
    """Without VTK's warning that there is no screen where none is needed."""
    if can_open_windows():
        yield
        return
    logger = import_module("vtkmodules.vtkCommonCore").vtkLogger
    logger.SetStderrVerbosity(logger.VERBOSITY_ERROR)
    try:
        yield
    finally:
        logger.SetStderrVerbosity(logger.VERBOSITY_INFO)
