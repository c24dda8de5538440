"""Any column of the curve over any other, in axes of matplotlib."""

import re
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from fissura.arrays import FloatArray
from fissura.case import Case
from fissura.pictures.curves import BLUE, tidy
from fissura.pictures.lettering import literal
from fissura.results.curve import COLUMN_OF
from fissura.results.names import column_named, load_name, value_axis
from fissura.results.run_data import RunData
from fissura.text.units import SCALES, scale_of, split_unit


def plot_columns(result: RunData, x: str | None, y: str, ax: Axes | None, line: dict[str, Any]) -> Axes:
    """Draw a column over another; see `Result.plot`."""
    columns = [
        COLUMN_OF[result.case.quantity] if x is None else column_named(result.curve, x, "x"),
        column_named(result.curve, y, "y"),
    ]
    if ax is None:
        ax = new_axes((6.4, 4.2))
    factors = []
    for column, axis in zip(columns, (ax.xaxis, ax.yaxis), strict=True):
        values = result.curve[column].astype(np.float64)
        title = literal(column_title(result.case, column))
        factor, label = scaled_axis(column, title, values, axis.get_label_text())
        factors.append(factor)
        axis.set_label_text(label)
    kind = " at full resolution" if result.full else ""
    style = {"linewidth": 1.6, "label": literal(result.case.name + kind)}
    style |= {} if ax.lines or "c" in line else {"color": BLUE}
    ax.plot(*(result.curve[c] * f for c, f in zip(columns, factors, strict=True)), **{**style, **line})
    tidy(ax)
    return ax


def new_axes(size: tuple[float, float]) -> Axes:
    """Axes of a new figure of pyplot, which notebooks show by themselves; its size in inches."""
    from matplotlib import pyplot  # looks for windows when it is imported

    return pyplot.subplots(figsize=size, layout="constrained")[1]


def column_title(case: Case, column: str) -> str:
    """What a column is called on axes, without its unit."""
    for quantity, known in COLUMN_OF.items():
        if column == known:
            return value_axis(case, quantity)
    return load_name(case) if column == "load_N" else split_unit(column)[0].replace("_", " ")


def scaled_axis(column: str, name: str, values: FloatArray, label: str) -> tuple[float, str]:
    """Factor, and label of the axis; where one with a unit that fits is there, it stays."""
    unit = split_unit(column)[1]
    if not unit:
        return 1.0, label or name
    shown = re.search(r"\[(.+)\]\s*$", label)
    for _, factor, text in SCALES[unit]:
        if shown and shown[1] == text:
            return factor, label
    factor, text = scale_of(unit, float(np.abs(values[np.isfinite(values)]).max(initial=0.0)))
    return factor, f"{name} [{text}]"
