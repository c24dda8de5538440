"""A cheap model of a notched beam: a curve as a formula, with a random structure that shifts its constants."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fissura.calibration.observed import observed
from fissura.calibration.problem import Problem, Test, Unknown
from fissura.calibration.search import Found, search
from fissura.calibration.surrogate import Samples
from fissura.case import Case
from fissura.results.measured import MeasuredBand

FloatArray = NDArray[np.float64]

X = np.linspace(1e-6, 2e-4, 400)
F_T = Unknown("material.f_t", 2.2e6, 0.8e6, 8e6)
G_T = Unknown("material.G_t", 35.0, 10.0, 150.0)
MORE = (Unknown("material.E", 50e9, 20e9, 120e9), Unknown("material.mu", 0.3, 0.05, 1.0))
PLATEAU = (Unknown("material.residual", 0.15, 0.03, 0.5), Unknown("material.shape", 1.0, 0.5, 2.0))
TRUE = {
    "material.f_t": 2.8e6,
    "material.G_t": 50.0,
    "material.E": 60e9,
    "material.mu": 0.2,
    "material.residual": 0.1,
    "material.shape": 1.3,
}


def curve(x: FloatArray, values: dict[str, float], structure: FloatArray, size: float = 1.0) -> FloatArray:
    """Load over gauge: a rise with the modulus, a peak with the strength, a tail with energy over strength."""
    v = TRUE | values
    f, G, E = (v[key] * (1 + shift) for key, shift in zip(("material.f_t", "material.G_t", "material.E"), structure))  # noqa: B905
    peak = 350e-6 * f * size
    rise = 8e7 * E / 60e9
    tail = 1.8 * G / f * (v["material.mu"] / 0.2) ** 0.3 * size**0.7
    return peak * (1.0 - np.exp(-rise * x / peak)) * np.exp(-np.maximum(x - 5e-6, 0.0) / tail * 0.25)


def with_plateau(x: FloatArray, values: dict[str, float], structure: FloatArray, size: float = 1.0) -> FloatArray:
    """Load over gauge with five constants that one tells apart: its fall has a shape, and ends at a residual load."""
    v = TRUE | values
    keys = ("material.f_t", "material.G_t", "material.E")
    f, G, E = (v[key] * (1 + shift) for key, shift in zip(keys, structure, strict=True))
    peak, rise = 350e-6 * f * size, 8e7 * E / 60e9
    fall = (np.maximum(x - 5e-6, 0.0) / (3.0 * G / f * size**0.5)) ** v["material.shape"]
    left = v["material.residual"]
    return peak * (1.0 - np.exp(-rise * x / peak)) * ((1.0 - left) * np.exp(-fall) + left)


@dataclass
class Laboratory:
    """Measured specimens and computed runs of the cheap model, from one generator of random numbers."""

    case: Case
    rng: np.random.Generator
    unknowns: tuple[Unknown, ...] = (F_T, G_T)
    specimens: int = 1
    sizes: tuple[float, ...] = (1.0,)
    scatter: tuple[float, float, float] = (0.05, 0.1, 0.03)
    noise: float = 0.002
    formula: Callable[[FloatArray, dict[str, float], FloatArray, float], FloatArray] = curve
    calls: list[tuple[int, int]] = field(default_factory=list)

    def structure(self) -> FloatArray:
        return self.rng.normal(size=3) * self.scatter

    def measured(self, size: float) -> MeasuredBand:
        load = self.formula(X, TRUE, self.structure(), size)
        return MeasuredBand(X, load, load)

    def search(self, seeds: int = 6, most: int = 40) -> Found:
        tests = tuple(
            Test(
                f"size {size:g}",
                self.case,
                tuple(self.measured(size) for _ in range(self.specimens)),
                1.0,
                self.specimens,
                "gauge",
            )
            for size in self.sizes
        )  # fmt: skip
        problem = Problem("synthetic", self.unknowns, tests)
        points = [observed(test) for test in tests]
        structures = [[self.structure() for _ in range(seeds)] for _ in tests]

        def simulate(designs: FloatArray, count: int) -> tuple[FloatArray, list[Samples]]:
            self.calls.append((len(designs), count))
            found = []
            for size, of, own in zip(self.sizes, points, structures, strict=True):
                rows = [(design, k) for k in range(count) for design in designs]
                loads = [
                    self.formula(of.x, problem.values(design), own[k], size) * (1 + self.noise * self.rng.normal())
                    for design, k in rows
                ]
                found.append(Samples(np.array([d for d, _ in rows]), np.array([k for _, k in rows]), np.array(loads)))
            return designs, found

        return search(problem, points, simulate, seeds, most)
