"""The curve of a run as columns for a page, in units that suit their values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.pictures.plotting import column_title
from fissura.results.curve import COLUMN_OF, TEXTS
from fissura.results.measured import read_measured
from fissura.text.units import scale_of, split_unit

if TYPE_CHECKING:
    from fissura.results.result import Result

__all__ = ["columns_of", "measured_of"]


def columns_of(result: Result) -> dict[str, Any]:
    """All columns of numbers, the unloaded state in front.

    Returns
    -------
    dict
        ``columns``: a list of ``name``, ``title`` (with the unit), ``unit`` and ``values``, (steps + 1,); ``steps``:
        numbers of the steps, 0 for the unloaded state; ``x`` and ``y``: names of the columns that are shown first.
    """
    columns = []
    for name, values in result.curve.items():
        if name in TEXTS:
            continue
        numbers = values.astype(np.float64)
        unit = split_unit(name)[1]
        factor, shown = scale_of(unit, _largest(numbers)) if unit else (1.0, "")
        title = column_title(result.case, name)
        columns.append(
            {
                "name": name,
                "title": f"{title} [{shown}]" if shown else title,
                "unit": shown,
                "values": np.concatenate([[0.0 if unit else np.nan], factor * numbers]),
            }
        )
    return {
        "columns": columns,
        "steps": np.concatenate([[0], result.curve["step"]]).astype(np.int32),
        "x": COLUMN_OF[result.case.quantity],
        "y": "load_N",
    }


def measured_of(result: Result) -> dict[str, Any] | None:
    """Measured loads over the gauge in the units of the columns; None where there are none, or they cannot be read."""
    path = result.case.output.measured
    if path is None or not result.steps:
        return None
    try:
        band = read_measured(path)
    except InputError:
        return None
    x = scale_of("m", _largest(result.gauge))[0]
    y = scale_of("N", _largest(result.load_values))[0]
    return {"x": x * band.gauge, "lower": y * band.lower, "upper": y * band.upper}


def _largest(values: NDArray[np.float64]) -> float:
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
