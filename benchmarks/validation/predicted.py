"""Realisations of a test that is predicted: their curves, the numbers told of them, and pictures."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import above  # noqa: F401
import numpy as np
from numpy.typing import NDArray

from common import say
from fissura import Case, EnsembleResult, run_ensemble
from fissura.pictures.curves import INK, headline, legend, tidy
from fissura.results.curve import read_curve

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FloatArray = NDArray[np.float64]

LINE, MEAN = "#7fa6c9", "#1f4e79"
#: Intervals of the opening at which curves are compared.
POINTS = 400


@dataclass(frozen=True, eq=False)
class Predicted:
    """Realisations of one case.

    Attributes
    ----------
    name : str
        Told in tables.
    ensemble : EnsembleResult
        The realisations.
    ligament : float
        Area that the crack runs through [m^2].
    until : float
        Opening up to which curves are told [m].
    gauge : str
        Column of the opening in ``curve.csv``.
    """

    name: str
    ensemble: EnsembleResult
    ligament: float
    until: float
    gauge: str = "gauge_m"

    @classmethod
    def of(cls, name: str, case: Case, runs: int, folder: Path, **about: Any) -> Predicted:
        """Run a case with several structures; what is in the folder already is not run again."""
        say(f"{name}: {runs} realisations")
        there = (folder / "ensemble.json").exists()
        found = run_ensemble(case, runs, output=folder, companions="none", keep=True, resume=there, seed=1)
        return cls(name, found, **about)

    @property
    def numbers(self) -> list[int]:
        """The realisations that finished."""
        runs = self.ensemble.runs
        return [int(number) for number in runs["number"][runs["status"] == "finished"]]

    @cached_property
    def curves(self) -> list[tuple[FloatArray, FloatArray]]:
        """Opening [m] and load [N] of each, from the unloaded state on; the opening does not turn back."""
        found = []
        for number in self.numbers:
            curve = read_curve(self.ensemble.place(number))
            opening = np.maximum.accumulate(np.append(0.0, curve[self.gauge].astype(float)))
            found.append((opening, np.append(0.0, curve["load_N"].astype(float))))
        return found

    @cached_property
    def openings(self) -> FloatArray:
        """Openings at which the mean curve is told [m]."""
        return np.linspace(0.0, self.until, POINTS + 1)

    @cached_property
    def loads(self) -> FloatArray:
        """Loads there [N], one row for each realisation."""
        return np.array([np.interp(self.openings, *curve) for curve in self.curves])

    @property
    def peaks(self) -> list[float]:
        """Largest load of each [N]."""
        return [float(load.max()) for _, load in self.curves]

    @property
    def at_peaks(self) -> list[float]:
        """Opening at the largest load of each [m]."""
        return [float(opening[load.argmax()]) for opening, load in self.curves]

    @property
    def stiffness(self) -> list[float]:
        """Load over opening of the first step of each [N/m]."""
        return [float(load[1] / opening[1]) for opening, load in self.curves]

    @property
    def work(self) -> list[float]:
        """Of the load on the opening up to `until`, of each, over the ligament [J/m^2]."""
        return [float(np.trapezoid(row, self.openings)) / self.ligament for row in self.loads]

    def loads_at(self, opening: float) -> list[float]:
        """Load of each at an opening [N]."""
        return [float(np.interp(opening, *curve)) for curve in self.curves]

    def draw(self, axes: Axes, title: str, note: str) -> None:
        """Curves of all realisations, and their mean."""
        for k, row in enumerate(self.loads):
            label = f"{len(self.loads)} realisations" if k == 0 else None
            axes.plot(1e6 * self.openings, row / 1e3, color=LINE, linewidth=0.9, label=label)
        axes.plot(1e6 * self.openings, self.loads.mean(axis=0) / 1e3, color=MEAN, linewidth=2.0, label="their mean")
        axes.set_xlabel("opening [µm]", color=INK)
        axes.set_ylabel("load [kN]", color=INK)
        axes.set_xlim(0.0, 1e6 * self.until)
        axes.set_ylim(0.0)
        tidy(axes)
        legend(axes)
        headline(axes, title, note)
