"""Pictures of a calibration: computed curves over what was measured."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fissura.pictures.curves import BLUE, LIGHT, ORANGE, WIDE, fill_measured, headline, legend, tidy
from fissura.pictures.grid import grid_of
from fissura.results.load_path import NAMES
from fissura.results.measured import MeasuredBand
from fissura.text.units import scale_of

if TYPE_CHECKING:
    from fissura.calibration.result import Calibration, Fit


def plot_calibration(result: Calibration) -> Figure:
    """Draw all tests of a calibration, a panel for each."""
    figure, grid, _ = grid_of(len(result.fits), (WIDE, 10.0), 4.6)
    for axes, fit in zip(grid, result.fits, strict=True):
        draw_fit(axes, fit)
        headline(axes, fit.name, f"residual {100 * fit.residual:.1f} % of the peak, {100 * fit.inside:.0f} % inside")
    return figure


def draw_fit(axes: Axes, fit: Fit) -> None:
    """Draw the curves of a test: measured, computed with each seed, their mean, and the mean at the estimate."""
    x, x_unit = scale_of("m", float(fit.x.max()))
    y, y_unit = scale_of("N", float(np.abs(fit.upper).max()))
    fill_measured(axes, MeasuredBand(fit.x, fit.lower, fit.upper), x, y)
    for k, load in enumerate(fit.seeds):
        label = f"computed, {len(fit.seeds)} seeds" if k == 0 else None
        axes.plot(fit.x * x, load * y, color=LIGHT, linewidth=0.8, alpha=0.8, label=label)
    axes.plot(fit.x * x, fit.computed * y, color=BLUE, linewidth=1.8, label="their mean")
    axes.plot(fit.x * x, fit.predicted * y, "--", color=ORANGE, linewidth=1.4, label="mean at the estimate")
    axes.set_xlabel(f"{NAMES['gauge'] if fit.quantity == 'gauge' else NAMES['displacement']} [{x_unit}]")
    axes.set_ylabel(f"load [{y_unit}]")
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=min(0.0, 1.05 * y * float(fit.lower.min())))
    tidy(axes)
    legend(axes, fontsize=8.5)
