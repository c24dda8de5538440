"""Curves of an ensemble, or columns of its table of runs, in axes of matplotlib."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from fissura.ensemble.axes_of_values import value_axis_of
from fissura.ensemble.curve_picture import draw_curves
from fissura.ensemble.result import EnsembleResult
from fissura.ensemble.study_pictures import curves_by_value
from fissura.ensemble.table import COLUMNS, varied_keys
from fissura.errors import InputError
from fissura.pictures.curves import BLUE, tidy
from fissura.pictures.lettering import literal
from fissura.pictures.plotting import new_axes, scaled_axis
from fissura.results.names import column_among
from fissura.text.units import split_unit

_TABLE = "the table of runs"


def plot_curves_of(result: EnsembleResult, ax: Axes | None, line: dict[str, Any]) -> Axes:
    """Draw all curves and their means; see `EnsembleResult.plot`."""
    if not result.paths:
        raise InputError(str(result.folder), "has no run with a curve", "an ensemble with finished runs")
    if ax is None:
        ax = new_axes((6.4, 4.2))
    if result.plan.vary:
        curves_by_value(result, ax, line)
    else:
        draw_curves(result, ax, line)
    return ax


def plot_rows(result: EnsembleResult, x: str | None, y: str | None, ax: Axes | None, line: dict[str, Any]) -> Axes:
    """Draw a column of the table of runs over another; see `EnsembleResult.plot`."""
    rows = result.runs
    keys = varied_keys(rows)
    columns = [name for name in rows if name in keys or COLUMNS.get(name) is not str]
    named = {key.rpartition(".")[2]: key for key in keys}
    across = column_among(columns, named.get(str(x), x) if x is not None else "number", "x", _TABLE)
    up = column_among(columns, named.get(str(y), y) if y is not None else "peak_load", "y", _TABLE)
    if ax is None:
        ax = new_axes((6.4, 4.2))
    shown = []
    for column, axis in ((across, ax.xaxis), (up, ax.yaxis)):
        if column in keys:
            found = value_axis_of(result.plan, column)
            shown.append(np.array([found.place(value) for value in rows[column].tolist()]))
            if axis is ax.xaxis:
                found.label(ax)
            else:
                axis.set_label_text(literal(found.name))
            continue
        values = rows[column].astype(np.float64)
        name = split_unit(column)[0].replace("_", " ")
        factor, label = scaled_axis(column, name, values, axis.get_label_text())
        axis.set_label_text(label)
        shown.append(values * factor)
    style: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 4, "alpha": 0.7}
    ax.plot(*shown, **{**style, **({} if ax.lines or "c" in line else {"color": BLUE}), **line})
    tidy(ax)
    return ax
