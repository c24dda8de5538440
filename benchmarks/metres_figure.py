"""Figure of `metres.py`: time, memory, bodies and strength over depth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from fissura.pictures.curves import BLUE, INK, ORANGE, legend, tidy
from validation.size_laws import notched

KINDS = {"adaptive": (BLUE, "adaptive"), "full": (ORANGE, "full resolution")}
FAMILIES = {"thin": ("o", "50 mm thick"), "solid": ("s", "half as thick as deep"), "large": ("D", "450 mm thick")}
COLUMNS = (
    ("cpu_s", "processor time [s], as far as both go"),
    ("memory_MB", "memory [MB]"),
    ("bodies", "bodies at the end"),
)


def figure(rows: list[dict[str, Any]], path: Path) -> None:
    """Draw four panels to a file."""
    picture = Figure(figsize=(10.0, 7.4), layout="constrained")
    panels = picture.subplots(2, 2).ravel()
    for axes, (column, label) in zip(panels, COLUMNS, strict=False):
        for kind, (colour, name) in KINDS.items():
            for family, (marker, thickness) in FAMILIES.items():
                mine = [row for row in rows if row["family"] == family and f"{kind}_{column}" in row]
                if mine:
                    depth, value = [row["depth"] for row in mine], [row[f"{kind}_{column}"] for row in mine]
                    axes.plot(depth, value, marker + "-", color=colour, markersize=5, label=f"{name}, {thickness}")
        _logarithmic(axes, rows, label)
    legend(panels[1], loc="upper left")
    _strength(panels[3], rows)
    picture.savefig(path, dpi=130)


def _strength(axes: Axes, rows: list[dict[str, Any]]) -> None:
    for family, (marker, thickness) in FAMILIES.items():
        mine = [row for row in rows if row["family"] == family]
        if mine:
            depth, strength = [row["depth"] for row in mine], [row["adaptive_strength_MPa"] for row in mine]
            axes.plot(depth, strength, marker, color=BLUE, markersize=5, label=f"adaptive, {thickness}")
    small = list({row["name"]: row for row in rows if row["family"] != "large"}.values())
    law = notched([row["depth"] for row in small], [row["adaptive_strength_MPa"] for row in small])
    depth = np.geomspace(min(row["depth"] for row in rows), max(row["depth"] for row in rows), 100)
    axes.plot(depth, law.first / np.sqrt(1.0 + depth / law.second), color=INK, linewidth=1.0, label="Bažant's law")
    _logarithmic(axes, rows, "nominal strength [MPa]")
    legend(axes)


def _logarithmic(axes: Axes, rows: list[dict[str, Any]], label: str) -> None:
    depths = sorted({row["depth"] for row in rows})
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xticks(depths, [f"{depth}" for depth in depths])
    axes.set_xlabel("depth [mm]")
    axes.set_ylabel(label)
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    tidy(axes)
