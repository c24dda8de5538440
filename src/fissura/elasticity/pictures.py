"""Pictures of a study: constants against `alpha`, and against the size of bodies."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fissura.case.macroscopic import macroscopic_elasticity, voigt
from fissura.elasticity.study import Row, Study, spread
from fissura.pictures.curves import BLUE, DPI, INK, LIGHT, ORANGE, headline, tidy
from fissura.pictures.lettering import save

#: Bulk values of structures with 0.65 nuclei in a cube of side ``l_min``, where saturated ones have 0.73: alpha, E/E_c,
#: nu (theory section 2). Fewer nuclei than fit make the material softer where `alpha` is small.
SPARSE = (
    (0.05, 0.399, 0.301),
    (0.10, 0.473, 0.263),
    (0.20, 0.570, 0.215),
    (0.24, 0.602, 0.199),
    (0.29, 0.638, 0.181),
    (0.30, 0.645, 0.178),
    (0.40, 0.709, 0.145),
    (0.50, 0.767, 0.116),
    (0.70, 0.870, 0.065),
    (1.00, 1.000, 0.000),
)

_LABELS = ("$E_{macro}\\,/\\,E_{contact}$", "Poisson's ratio")


def _figure() -> tuple[Figure, tuple[Axes, Axes]]:
    figure = Figure(figsize=(9.6, 4.3), layout="constrained")
    left, right = figure.subplots(1, 2)
    for axes, label in zip((left, right), _LABELS, strict=True):
        tidy(axes)
        axes.set_ylabel(label)
    return figure, (left, right)


def _values(row: Row) -> tuple[tuple[float, float], tuple[float, float]]:
    """Mean and standard deviation of both constants."""
    return spread(row.E)[:2], spread(row.nu)[:2]


def plot_alpha(study: Study, path: Path) -> None:
    """Draw constants of the largest periodic cells over `alpha`, with Voigt's estimate and the tabulated law.

    Raises
    ------
    ValueError
        A file name whose ending is not known.
    """
    figure, panels = _figure()
    rows = study.of("periodic", size=study.sizes[-1])
    law = macroscopic_elasticity()
    fine = np.linspace(law.alpha[0], 1.0, 200)
    lines = np.array([law.macroscopic(1.0, alpha) for alpha in fine])
    estimate = np.array([voigt(alpha) for alpha in np.linspace(0.0, 1.0, 101)])
    sparse = np.array(SPARSE)
    for k, axes in enumerate(panels):
        axes.plot(np.linspace(0.0, 1.0, 101), estimate[:, k], "--", color=INK, linewidth=1.1, label="Voigt's estimate")
        axes.plot(fine, lines[:, k], color=LIGHT, linewidth=2.4, label="tabulated bulk law")
        axes.plot(
            sparse[:, 0],
            sparse[:, 1 + k],
            "x",
            color=ORANGE,
            markersize=5,
            markeredgewidth=1.4,
            label="0.65 nuclei per $l_{min}^3$",
            zorder=4,
        )
        values = np.array([_values(row)[k] for row in rows])
        axes.errorbar(
            [row.alpha for row in rows],
            values[:, 0],
            np.nan_to_num(values[:, 1]),
            fmt="o",
            markersize=4.5,
            capsize=2.5,
            color=BLUE,
            label=f"periodic cells of {rows[0].bodies:.0f} bodies",
        )
        axes.set_xlabel("$\\alpha$ of the contacts")
        axes.set_xlim(0.0, 1.02)
        axes.set_ylim(bottom=0.0 if k else None)
    headline(panels[0], "Elastic constants of the bulk", f"mean and standard deviation of {rows[0].seeds} structures")
    panels[0].legend(fontsize=9, labelcolor=INK, edgecolor="none", loc="lower right")
    save(figure, path, DPI)


def plot_size(study: Study, path: Path, alpha: float) -> None:
    """Draw constants over the size of bodies for one `alpha`: periodic cells, and prisms with fitted lines.

    Raises
    ------
    ValueError
        A file name whose ending is not known.
    """
    figure, panels = _figure()
    series = (
        ("periodic", "periodic cells", "o", BLUE),
        ("gauge", "prisms, gauges on their sides", "s", ORANGE),
        ("ends", "prisms, end to end", "^", INK),
    )
    widest = 1.08 / study.sizes[0]
    for shift, (kind, label, marker, colour) in enumerate(series):
        rows = study.of(kind, alpha=alpha)
        at = np.array([1.0 / row.size for row in rows]) + 0.004 * (shift - 1) * widest
        for k, axes in enumerate(panels):
            if k and kind == "ends":
                continue  # both ways to measure share their lateral strain
            values = np.array([_values(row)[k] for row in rows])
            name = "prisms" if k and kind == "gauge" else label
            error = np.nan_to_num(values[:, 1])
            axes.errorbar(
                at, values[:, 0], error, fmt=marker, markersize=4.5, capsize=2.5, color=colour, label=name, zorder=3
            )
        fit = study.layer(kind, alpha)
        if fit is not None and kind != "periodic":
            line = np.array([0.0, widest])
            panels[0].plot(line, fit.E_bulk * (1.0 + fit.c * line), "-", color=colour, linewidth=1.1)
    if alpha >= macroscopic_elasticity().alpha[0]:
        for axes, value in zip(panels, macroscopic_elasticity().macroscopic(1.0, alpha), strict=True):
            axes.axhline(value, color=LIGHT, linewidth=2.4, zorder=1, label="tabulated bulk law")
    for axes in panels:
        axes.set_xlabel("$l_{min}$ / size")
        axes.set_xlim(0.0, widest)
        axes.legend(fontsize=9, labelcolor=INK, edgecolor="none", loc="best")
    headline(panels[0], f"Elastic constants and the size of bodies, α = {alpha:g}", "mean and standard deviation")
    save(figure, path, DPI)
