"""Iterations of linear solvers against size and against crack length, as a picture for the docs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

BLUE, ORANGE, GREY, GREEN = "#1f5fa8", "#d9731a", "#8a8f98", "#3a8f4d"


def draw(sizes: list[dict[str, Any]], crack: dict[str, Any], path: Path) -> None:
    """Write the picture.

    Parameters
    ----------
    sizes : list of dict
        Rows with ``bodies``, ``iterations``, ``iterations_50``, ``iterations_90`` and ``amg_iterations``.
    crack : dict
        ``share`` of the ligament that is cracked, and iterations ``two_level``, ``bridging``, ``amg`` of each.
    path : Path
        PNG file.
    """
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.0), constrained_layout=True)
    bodies = [row["bodies"] for row in sizes]
    for key, label, color, marker in (
        ("iterations", "two-level, sound", BLUE, "o"),
        ("iterations_50", "two-level, cracked 50 %", GREEN, "s"),
        ("iterations_90", "two-level, cracked 90 %", ORANGE, "^"),
        ("amg_iterations", "smoothed aggregation, sound", GREY, "D"),
    ):
        left.plot(bodies, [row[key] for row in sizes], marker=marker, color=color, label=label)
    left.set_xscale("log")
    left.set_xlabel("bodies")
    share = [100.0 * value for value in crack["share"]]
    for key, label, color, marker in (
        ("two_level", "two-level", BLUE, "o"),
        ("bridging", "two-level, clusters not split at the crack", ORANGE, "s"),
        ("amg", "smoothed aggregation", GREY, "D"),
    ):
        right.plot(share, crack[key], marker=marker, color=color, label=label)
    right.set_xlabel(f"cracked share of the ligament [%], {crack['bodies']} bodies")
    for axes in (left, right):
        axes.set_ylabel("iterations to 1e-6")
        axes.set_ylim(bottom=0)
        axes.grid(color="#e3e6ea", linewidth=0.8)
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, fontsize=9)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=150, facecolor="white")
    plt.close(figure)
