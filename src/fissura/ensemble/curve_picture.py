"""Picture of all curves of an ensemble, with their mean and percentiles."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fissura.case import Case
from fissura.ensemble.band import Band
from fissura.ensemble.result import EnsembleResult
from fissura.pictures.curves import BLUE, INK, LIGHT, ORANGE, WIDE, fill_measured, headline, legend, tidy
from fissura.results.load_path import NAMES, LoadPath
from fissura.results.measured import read_measured
from fissura.results.names import load_name, value_axis
from fissura.text.units import scale_of


def plot_curves(result: EnsembleResult) -> Figure | None:
    """Draw all curves, their mean and percentile band, and the deterministic run.

    If what is controlled turns back in a run, mean and band are over the dissipated energy, in a panel of their own.
    Where not every run counts any more, the mean is dashed and the band is paler.
    """
    if not result.paths or result.plan.vary:
        return None
    over_energy = result.band is not None and result.band.over == "dissipated energy"
    figure = Figure(figsize=(WIDE, 7.6 if over_energy else 4.8), layout="constrained")
    panels = figure.subplots(2 if over_energy else 1, 1, squeeze=False)[:, 0]
    draw_curves(result, panels[0], {}, banded=panels[-1])
    case = result.plan.case
    headline(
        panels[0],
        "Load",
        f"{len(result.paths)} runs of {case.name}"
        + (f"; the {NAMES[case.quantity]} turns back" if over_energy else ""),
    )
    return figure


def draw_curves(result: EnsembleResult, axes: Axes, line: Mapping[str, Any], banded: Axes | None = None) -> None:
    """Draw curves, mean and band into axes.

    Parameters
    ----------
    result : EnsembleResult
        With at least one curve.
    axes : Axes
        Where the curves go.
    line : mapping
        Properties of the mean, or of the curves where there is none.
    banded : Axes, optional
        Where mean and band go; by default the same axes, without those that are over the dissipated energy.
    """
    found, case = result.band, result.plan.case
    over_energy = found is not None and found.over == "dissipated energy"
    paths = result.paths
    x, x_unit = scale_of("m", max(float(path.value.max()) for path in paths.values()))
    y, y_unit = scale_of("N", max(float(np.abs(path.load).max()) for path in paths.values()))
    _measured(axes, case, x, y)
    own = line if found is None or (over_energy and banded is None) else {}
    finished = set(result.runs["number"][result.runs["status"] == "finished"].tolist())
    _lines(axes, [path for k, path in paths.items() if k in finished], x, y, LIGHT, f"{len(finished)} runs", 0.55, own)
    stopped = [path for k, path in paths.items() if k not in finished]
    _lines(axes, stopped, x, y, ORANGE, f"{len(stopped)} stopped early", 0.9, own)
    _companions(axes, result, x, y)
    panels = [axes]
    if found is not None and not over_energy:
        _band(banded or axes, found, x, y, line)
    elif found is not None and banded is not None:
        u, u_unit = scale_of("J", float(found.abscissa[-1]))
        _band(banded, found, u, y, line)
        banded.set_xlabel(f"dissipated energy [{u_unit}]")
        banded.set_ylabel(f"{load_name(case)} [{y_unit}]")
        banded.set_xlim(0.0, float(found.abscissa[-1]) * u)
        panels.append(banded)
    axes.set_xlabel(f"{value_axis(case, case.quantity)} [{x_unit}]")
    axes.set_ylabel(f"{load_name(case)} [{y_unit}]")
    axes.set_xlim(left=min(0.0, 1.02 * x * min(float(path.value.min()) for path in paths.values())))
    for panel in panels:
        tidy(panel)
        panel.set_ylim(bottom=min(0.0, 1.02 * y * min(float(path.load.min()) for path in paths.values())))
        legend(panel, loc="upper right")


def _measured(axes: Axes, case: Case, x: float, y: float) -> None:
    """The measured band that a case names, where loads are over the gauge, as measured ones are."""
    measured = case.output.measured
    if (case.quantity == "gauge" or case.main.gauge is None) and measured is not None and measured.exists():
        fill_measured(axes, read_measured(measured), x, y)


def _companions(axes: Axes, result: EnsembleResult, x: float, y: float) -> None:
    alone = list(result.companion_paths.values())
    if len(alone) == 1:
        style: dict[str, Any] = {"color": INK, "linewidth": 1.3, "linestyle": (0, (5, 2)), "label": "deterministic"}
        axes.plot(alone[0].value * x, alone[0].load * y, **style)
    elif alone:
        _lines(axes, alone, x, y, INK, f"{len(alone)} deterministic runs", 0.3, {})


def _lines(
    axes: Axes,
    paths: list[LoadPath],
    x: float,
    y: float,
    colour: str,
    label: str,
    alpha: float,
    line: Mapping[str, Any],
) -> None:
    for k, path in enumerate(paths):
        style: dict[str, Any] = {
            "color": colour,
            "linewidth": 0.7,
            "alpha": alpha,
            "label": label if k == 0 else None,
            **line,
        }
        axes.plot(path.value * x, path.load * y, **style)


def _band(axes: Axes, found: Band, u: float, y: float, line: Mapping[str, Any]) -> None:
    """Mean and percentiles of the loads, in units of ``1/u`` and ``1/y``."""
    until = found.until
    for part, alpha in ((slice(0, until), 0.30), (slice(until - 1, None), 0.14)):
        low, _, high = found.percentiles[:, part] * y
        style: dict[str, Any] = {"color": BLUE, "alpha": alpha, "linewidth": 0, "zorder": 2}
        label = "5 % to 95 %" if alpha == 0.30 else None
        axes.fill_between(found.abscissa[part] * u, low, high, label=label, **style)
    mean: dict[str, Any] = {"color": BLUE, "linewidth": 1.9, "label": "mean", "zorder": 4, **line}
    axes.plot(found.abscissa[:until] * u, found.mean[:until] * y, **mean)
    if until < len(found.abscissa):
        rest = slice(until - 1, None)
        label = f"mean of those left (≥ {int(found.count.min())})"
        mean = {"linestyle": "--", "color": BLUE, "linewidth": 1.5, **line, "label": label}
        axes.plot(found.abscissa[rest] * u, found.mean[rest] * y, **mean)
