"""What the pictures of a study share: colours, markers, and axes with logarithmic scales and plain numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence

from matplotlib.axis import Axis
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter, NullLocator

__all__ = ["COLOURS", "FLOOR", "MARKERS", "SOFT", "few", "plain"]

#: Colours that stay apart for the colour-blind, and markers, one pair for each variation in turn.
COLOURS = ("#1f4e79", "#d1641b", "#3a9a78", "#8c4a8f", "#c9a227", "#5aa5d6", "#7a7f87", "#b3394a")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p", "h", "*")

#: Colour of notes that should not catch the eye.
SOFT = "#7a7f87"

#: Errors are drawn at this one at least [%]: below it there is only the tolerance of equilibrium.
FLOOR = 0.01


def plain(axis: Axis, ticks: Sequence[float] = ()) -> None:
    """Write the numbers of a logarithmic axis out, at given ticks or at the powers of ten."""
    axis.set_major_locator(FixedLocator(ticks) if ticks else LogLocator(10.0))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
    if ticks:
        axis.set_minor_locator(NullLocator())


def few(low: float, high: float) -> list[float]:
    """Two to eight round ticks of a logarithmic axis that span an interval."""
    for steps in ((1.0,), (1.0, 3.0), (1.0, 2.0, 5.0), (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)):
        decades = range(math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 1)
        ticks = [float(f"{step * 10.0**decade:.3g}") for decade in decades for step in steps]
        inside = [tick for tick in ticks if low / 1.1 <= tick <= 1.1 * high]
        if len(inside) >= 3:
            return inside
    middle = math.sqrt(low * high)
    return inside or [float(f"{middle:.2g}")]
