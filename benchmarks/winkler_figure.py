"""Picture of docs/winkler.md: curves of all seeds over the measured one, and their cracks."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from common import Run
from fissura.pictures.crack import HEAT
from fissura.pictures.curves import DPI, INK, headline, legend, tidy
from fissura.pictures.lettering import save
from specimens_figure import corners_of
from winkler_curves import Curve, path

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Corners of the panel [mm].
PANEL = np.array([[0, 0], [250, 0], [250, 250], [500, 250], [500, 500], [0, 500], [0, 0]])
LINE, MEAN = "#7fa6c9", "#1f4e79"
#: Width of the strips in which the middle of a crack is shown [m].
STRIP = 0.01


def draw(runs: list[Run], wanted: Curve, to: Path) -> None:
    """Draw curves on the left, cracks on the right."""
    figure = Figure(figsize=(10.0, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
    curves = [Curve.of(run) for run in runs]
    for k, run in enumerate(runs):
        u, load = 1e3 * np.append(0.0, run.result.gauge), np.append(0.0, run.result.load_values) / 1e3
        left.plot(u, load, color=LINE, linewidth=0.9, label=None if k else f"{len(runs)} seeds")
    middle = Curve.mean(curves)
    left.plot(1e3 * middle.u, middle.load / 1e3, color=MEAN, linewidth=2.0, label="their mean")
    left.plot(1e3 * wanted.u[1:], wanted.load[1:] / 1e3, "o", color=INK, markersize=4, label="measured (Winkler)")
    left.set_xlabel("displacement of the platen [mm]", color=INK)
    left.set_ylabel("load [kN]", color=INK)
    left.set_xlim(0.0, 1.0)
    left.set_ylim(0.0)
    tidy(left)
    legend(left)
    headline(left, "Load", "predicted, not fitted")
    _cracks(right, runs)
    to.parent.mkdir(parents=True, exist_ok=True)
    save(figure, to, DPI)


def _cracks(axes: Axes, runs: list[Run]) -> None:
    last = runs[0].result.last
    shapes, facet = corners_of(last, last.opening > 0.02 * last.opening.max())
    colours = HEAT(last.opening[facet] / last.opening.max())
    flat = [shape[:, :2] for shape in shapes]
    axes.add_collection(PolyCollection(flat, facecolors=colours, edgecolors=colours, linewidths=0.3))
    for k, run in enumerate(runs):
        at, weight = path(run)
        strip = np.floor(at[:, 0] / STRIP).astype(int)
        line = [
            (at[here, 0].mean(), np.average(at[here, 1], weights=weight[here]))
            for here in (strip == s for s in np.unique(strip))
            if here.sum() > 2
        ]
        x, y = 1e3 * np.array(line).T
        axes.plot(x, y, color=MEAN, linewidth=1.2, label=None if k else "middle of the crack, by seed")
    axes.plot(*PANEL.T, color=INK, linewidth=1.2)
    axes.set_aspect("equal")
    axes.set_xlim(-10, 330)
    axes.set_ylim(120, 400)
    axes.set_xlabel("x [mm]", color=INK)
    axes.set_ylabel("y [mm]", color=INK)
    tidy(axes)
    legend(axes, loc="upper right")
    headline(axes, "Crack", "facets of one seed by their opening; all from the inner corner")
