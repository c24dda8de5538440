"""Laws of the size effect, fitted to strengths, and the stress intensity of a notched beam that they need.

Strength is ``s = 1.5 F L / (b d^2)`` throughout, with load F, span L, thickness b and depth d.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import curve_fit

FloatArray = NDArray[np.float64]


def intensity(a: float, span: float = 2.5) -> float:
    """``K_I / (s sqrt(d))`` of a beam in three-point bending; `a` is the notch over depth, `span` that over depth.

    By Guinea, Pastor, Planas and Elices (1998), International Journal of Fracture 89, for spans of 2.5 depths and more.
    """
    four = 1.9 + 0.41 * a + 0.51 * a**2 - 0.17 * a**3
    infinite = 1.99 + 0.83 * a - 0.31 * a**2 + 0.14 * a**3
    return math.sqrt(a) / ((1 - a) ** 1.5 * (1 + 3 * a)) * (infinite + 4.0 / span * (four - infinite))


def release(a: float, span: float = 2.5) -> tuple[float, float]:
    """``g(a)`` and its derivative; the energy release rate is ``s^2 d g / E`` in plane stress."""
    step = 1e-5
    below, above = (intensity(a + sign * step, span) ** 2 for sign in (-1, 1))
    return intensity(a, span) ** 2, (above - below) / (2.0 * step)


@dataclass(frozen=True)
class Fit:
    """Two positive constants of a law, fitted to the logarithm of strengths by least squares.

    Attributes
    ----------
    first, second : float
        The constants.
    relative : (2, 2) array
        Covariance of their logarithms: squares of relative standard errors, from the scatter about the law.
    r2 : float
        Share of the variance of the logarithm of strengths that the law takes.
    """

    first: float
    second: float
    relative: FloatArray
    r2: float

    def error(self, first: float, second: float) -> float:
        """Relative standard error of the product of powers of both constants."""
        powers = np.array([first, second])
        return float(math.sqrt(powers @ self.relative @ powers))

    @property
    def errors(self) -> tuple[float, float]:
        """Standard errors of both constants."""
        return self.first * self.error(1, 0), self.second * self.error(0, 1)


def _fitted(log_law: Callable[..., FloatArray], start: tuple[float, float], x: ArrayLike, s: ArrayLike) -> Fit:
    y = np.log(np.asarray(s, dtype=float))

    def law(x: FloatArray, log_first: float, log_second: float) -> FloatArray:
        return log_law(x, math.exp(log_first), math.exp(log_second))

    found, covariance = curve_fit(law, np.asarray(x, dtype=float), y, p0=np.log(start))
    off = y - law(np.asarray(x, dtype=float), *found)
    r2 = 1.0 - float(off @ off) / float(((y - y.mean()) ** 2).sum())
    return Fit(float(math.exp(found[0])), float(math.exp(found[1])), covariance, r2)


def straight(depths: Sequence[float], strengths: Sequence[float]) -> tuple[float, float]:
    """``s_0`` and ``d_0`` of Bažant's law by a straight line of ``1/s^2`` over depth, as RILEM TC 89-FMT does it."""
    slope, rise = np.polyfit(np.array(depths), 1.0 / np.array(strengths) ** 2, 1)
    return (1.0 / math.sqrt(rise), float(rise / slope)) if rise > 0 and slope > 0 else (math.nan, math.nan)


def notched(depths: Sequence[float], strengths: Sequence[float]) -> Fit:
    """Bažant's law, ``s = s_0 / sqrt(1 + d/d_0)``: ``s_0`` and ``d_0``."""
    start = straight(depths, strengths)
    if not math.isfinite(start[0]):
        start = max(strengths), float(np.median(depths))
    return _fitted(lambda d, s_0, d_0: np.log(s_0) - 0.5 * np.log1p(d / d_0), start, depths, strengths)


def fracture_energy(law: Fit, a: float, modulus: float, span: float = 2.5) -> tuple[float, float]:
    """``G_f`` of a law of :func:`notched` and its standard error [J/m^2].

    Large beams of the law have ``s^2 d = s_0^2 d_0``, and ``G_f`` is their energy release rate, in plane stress.
    """
    value = release(a, span)[0] * law.first**2 * law.second / modulus
    return value, value * law.error(2, 1)


def together(notches: Sequence[float], depths: Sequence[float], strengths: Sequence[float], modulus: float) -> Fit:
    """One law for notches of several lengths, ``s = sqrt(E G_f / (g' c_f + g d))``: ``G_f`` and ``c_f``.

    Bažant and Kazemi (1990): the same fracture energy, and the same effective length of the zone that softens in front
    of the notch, in beams with any notch.
    """
    terms = np.array([release(a) for a in notches])

    def law(x: FloatArray, G_f: float, c_f: float) -> FloatArray:
        return 0.5 * np.log(modulus * G_f / (x[2] * c_f + x[1] * x[0]))

    d = np.array(depths)
    start = float(np.median(np.array(strengths) ** 2 * terms[:, 0] * d / modulus)), 0.1 * float(np.median(d))
    return _fitted(law, start, np.stack([d, terms[:, 0], terms[:, 1]]), strengths)


def unnotched(depths: Sequence[float], strengths: Sequence[float], power: float) -> Fit:
    """Law of a boundary layer, ``s = s_inf (1 + r D_b/d)^(1/r)`` with the `power` r: ``s_inf`` and ``D_b``.

    Of beams that crack from an even surface (type 1 of Bažant): a layer of constant thickness softens before the peak.
    """
    start = min(strengths), 0.1 * float(np.median(depths))
    return _fitted(lambda d, s_inf, D_b: np.log(s_inf) + np.log1p(power * D_b / d) / power, start, depths, strengths)
