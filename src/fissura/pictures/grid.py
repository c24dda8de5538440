"""Figures of several panels, side by side and one row below the other."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure


def grid_of(
    count: int, widths: Sequence[float], height: float, *, more: float = 0.0, sharey: bool = False
) -> tuple[Figure, list[Axes], int]:
    """A figure with so many panels, row by row, and the number of its columns.

    Widths [inch] are those of figures with one column, two, and so on, up to the most there may be; heights are those
    of a row, and what comes on top of all of them.
    """
    columns = min(count, len(widths))
    rows = -(-count // columns)
    figure = Figure(figsize=(widths[columns - 1], more + height * rows), layout="constrained")
    grid = list(figure.subplots(rows, columns, squeeze=False, sharey=sharey).flat)
    for axes in grid[count:]:
        axes.set_visible(False)
    return figure, grid[:count], columns
