"""Curves and cracks of Winkler's L-shaped panel, computed and measured: what `winkler.py` compares and draws."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from common import ROOT, Run
from fissura.results.measured import MeasuredBand, read_measured

FloatArray = NDArray[np.float64]

NAME = "winkler_lpanel"
#: Area that the crack runs through: thickness times the width of the leg [m^2].
LIGAMENT = 0.1 * 0.25
#: Loads up to which stiffness is a secant [N]; where curves are compared [m].
SECANT, UNTIL = 4000.0, 1.0e-3
#: Facets that are open wider are crack [m].
OPEN = 20e-6


@dataclass(frozen=True)
class Curve:
    """Load [N] over the displacement of the platen [m], which does not turn back."""

    u: FloatArray
    load: FloatArray

    @classmethod
    def of(cls, run: Run) -> Curve:
        gauge = np.append(0.0, run.result.gauge)
        return cls(np.maximum.accumulate(gauge), np.append(0.0, run.result.load_values))

    @classmethod
    def measured(cls) -> Curve:
        band: MeasuredBand = read_measured(ROOT / "examples" / "data" / f"{NAME}_load_displacement.csv")
        return cls(np.append(0.0, band.gauge), np.append(0.0, 0.5 * (band.lower + band.upper)))

    @classmethod
    def mean(cls, curves: list[Curve]) -> Curve:
        u = np.linspace(0.0, UNTIL, 501)
        return cls(u, np.mean([np.interp(u, curve.u, curve.load) for curve in curves], axis=0))

    @property
    def peak(self) -> float:
        return float(self.load.max())

    @property
    def at_peak(self) -> float:
        return float(self.u[self.load.argmax()])

    @property
    def stiffness(self) -> float:
        """Secant up to `SECANT` [N/m]."""
        before = slice(0, int(self.load.argmax()) + 1)
        return SECANT / float(np.interp(SECANT, self.load[before], self.u[before]))

    @property
    def work(self) -> float:
        """Of the load to the end of the comparison, over the ligament [J/m^2]."""
        u = np.linspace(0.0, UNTIL, 2001)
        return float(np.trapezoid(np.interp(u, self.u, self.load), u)) / LIGAMENT

    def yielding(self, compliance: float) -> Curve:
        """The same with a spring in series [m/N]."""
        return Curve(self.u + compliance * self.load, self.load)

    def off(self, other: Curve) -> float:
        """Root mean square difference of loads, over the peak of the other curve."""
        u = np.linspace(0.0, UNTIL, 2001)
        rest = np.interp(u, self.u, self.load) - np.interp(u, other.u, other.load)
        return float(np.sqrt(np.mean(rest**2))) / other.peak


def path(run: Run) -> tuple[FloatArray, FloatArray]:
    """Places (k, 2) of cracked facets in the plane [m], and their areas times openings."""
    last = run.result.last
    opened = last.opening > OPEN
    return last.tessellation.contacts.centroid[opened, :2], (last.tessellation.contacts.area * last.opening)[opened]


def inclination(run: Run, part: tuple[float, float]) -> float:
    """Of a part of the crack against the horizontal, upwards and away from the corner [degrees]."""
    at, weight = path(run)
    here = (at[:, 0] > part[0]) & (at[:, 0] < part[1])
    slope = np.polyfit(at[here, 0], at[here, 1], 1, w=np.sqrt(weight[here]))[0]
    return float(-np.degrees(np.arctan(slope)))
