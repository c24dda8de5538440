"""Pictures of an ensemble's report, by name."""

from __future__ import annotations

from collections.abc import Callable

from matplotlib.figure import Figure

from fissura.ensemble.crack_picture import plot_crack_starts
from fissura.ensemble.curve_picture import plot_curves
from fissura.ensemble.peak_pictures import plot_convergence, plot_papers, plot_peaks
from fissura.ensemble.result import EnsembleResult
from fissura.ensemble.study_pictures import plot_study_curves, plot_study_peaks

__all__ = ["PICTURES"]

PICTURES: dict[str, tuple[Callable[[EnsembleResult], Figure | None], str]] = {
    "curves": (plot_curves, "Load curves with mean and percentile band"),
    "curves_by_value": (plot_study_curves, "Load curves by the values of what is varied"),
    "peaks_by_value": (plot_study_peaks, "Peak loads over what is varied"),
    "peaks": (plot_peaks, "Histogram of the peak loads"),
    "papers": (plot_papers, "Probability plots of the peak loads"),
    "crack_starts": (plot_crack_starts, "Where cracks started"),
    "convergence": (plot_convergence, "Convergence of mean and coefficient of variation"),
}
"""Pictures of the report by name: what draws it (None: there is nothing to draw), and its caption."""
