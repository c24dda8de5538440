"""Bending strength over direct tensile strength by the codes, and their picture with what was computed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from predicted import MEAN

from fissura.pictures.curves import BLUE, DPI, INK, ORANGE, headline, legend, tidy
from fissura.pictures.lettering import save


def eurocode(depth: float) -> float:
    """EN 1992-1-1, 3.1.8, for a depth in mm."""
    return max(1.6 - depth / 1000.0, 1.0)


def model_code(depth: float) -> float:
    """fib Model Code 2010, 5.1.5.1, for a depth in mm; CEB-FIP Model Code 1990 has 1.5/100^0.7 = 0.0597 for 0.06."""
    size = 0.06 * depth**0.7
    return (1.0 + size) / size


def draw(ratios: dict[float, list[float]], path: Path) -> None:
    """Ratios of realisations by depth [mm]."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axes = figure.subplots()
    fine = np.linspace(35, 260, 100)
    axes.plot(fine, [model_code(depth) for depth in fine], color=BLUE, label="fib Model Code 2010")
    axes.plot(fine, [eurocode(depth) for depth in fine], color=ORANGE, label="Eurocode 2")
    for k, (depth, values) in enumerate(ratios.items()):
        axes.plot([depth] * len(values), values, "o", color=MEAN, markerfacecolor="none", markersize=5,
                  label=None if k else "realisations")  # fmt: skip
    axes.plot(list(ratios), [np.mean(values) for values in ratios.values()], "_", color=MEAN, markersize=16,
              label="their means")  # fmt: skip
    axes.set_xlabel("depth of the beam [mm]", color=INK)
    axes.set_ylabel("bending over direct tension", color=INK)
    axes.set_ylim(1.0, 2.6)
    tidy(axes)
    legend(axes)
    headline(axes, "Bending strength over tensile strength", "one material, nothing fitted to these tests")
    save(figure, path, DPI)
