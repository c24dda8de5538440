"""The result of a search: estimates with errors, and how the curves of every test fit."""

import logging
from pathlib import Path

import numpy as np

from fissura.calibration.observed import Observed, inside
from fissura.calibration.problem import Problem, Test, Unknown
from fissura.calibration.result import Calibration, Estimate, Fit
from fissura.calibration.search import Found
from fissura.calibration.surrogate import Samples, Surrogate

_log = logging.getLogger(__name__)

#: Residual over what random structures alone would leave, correlation, and share of the points, that are warned of.
_MISFIT, _CORRELATED, _SHORT = 2.0, 0.95, 0.9


def evaluated(problem: Problem, found: Found, folder: Path) -> Calibration:
    """The result of a search; what should be read with care is logged, too."""
    sure = found.uncertainty
    estimates = {}
    for k, unknown in enumerate(problem.unknowns):
        parts = (sure.errors[k], np.sqrt(sure.simulated[k]), np.sqrt(sure.measured[k]))
        estimates[unknown.key] = _estimate(unknown, float(found.coordinates[k]), tuple(map(float, parts)), sure.factor)
    fits = tuple(
        _fit(problem, found, *of)
        for of in zip(problem.tests, found.tests, found.samples, found.surrogates, strict=True)
    )
    correlation = sure.correlation
    warnings = tuple(_warnings(problem, found, estimates, correlation, fits))
    for text in warnings:
        _log.warning(text)
    numbers = found.runs, found.seeds, sure.freedom
    return Calibration(
        problem.name, estimates, correlation, fits, *numbers, found.converged, found.move, warnings, folder
    )


def _estimate(unknown: Unknown, at: float, errors: tuple[float, ...], factor: float) -> Estimate:
    value = unknown.value(at)
    slope = unknown.slope(value)
    low, high = unknown.value_beyond(at - factor * errors[0]), unknown.value_beyond(at + factor * errors[0])
    error, simulated, measured = (slope * part for part in errors)
    edge = 1e-3 * (unknown.coordinate(unknown.upper) - unknown.coordinate(unknown.lower))
    at_bound = not unknown.coordinate(unknown.lower) + edge < at < unknown.coordinate(unknown.upper) - edge
    text = {"value": unknown.told(value), "low": unknown.told(low), "high": unknown.told(high)}
    text["error"] = unknown.told(float(f"{error:.2g}"))
    limits = unknown.start, unknown.lower, unknown.upper
    return Estimate(unknown.key, value, error, low, high, *limits, simulated, measured, text, at_bound)


def _fit(problem: Problem, found: Found, test: Test, of: Observed, samples: Samples, surrogate: Surrogate) -> Fit:
    here = (np.abs(samples.coordinates - found.nearest) < 1e-12).all(axis=1)
    seeds = samples.loads[here]
    computed, predicted = seeds.mean(axis=0), surrogate.mean(found.coordinates)
    residual = float(np.sqrt(np.mean((of.load - predicted) ** 2))) / of.peak
    scatter = surrogate.scatter
    variance = (scatter**2).sum(axis=0) / (len(scatter) - 1)
    structures = np.maximum(variance, of.deviation**2) / test.specimens + variance / len(scatter)
    out = np.maximum(computed - of.upper, 0.0), np.maximum(of.lower - computed, 0.0)
    sensitivity, jacobian = {}, surrogate.jacobian(found.coordinates)
    top = int(np.argmax(np.abs(predicted)))
    for k, unknown in enumerate(problem.unknowns):
        sensitivity[unknown.key] = {
            "peak": float(jacobian[top, k] / predicted[top]),
            "rms": float(np.sqrt(np.mean(jacobian[:, k] ** 2)) / of.peak),
        }
    measured, simulated = (of.x, of.load, of.lower, of.upper), (computed, seeds, predicted)
    expected = float(np.sqrt(np.mean(structures))) / of.peak
    above, below = (float(part.max()) / of.peak for part in out)
    shares = residual, expected, inside(of, computed), above, below
    return Fit(test.name, test.quantity, *measured, *simulated, *shares, test.specimens, sensitivity)


def _warnings(
    problem: Problem, found: Found, estimates: dict[str, Estimate], correlation: np.ndarray, fits: tuple[Fit, ...]
) -> list[str]:
    """What should be read with care."""
    texts = []
    if not found.converged:
        texts.append(
            f"the search ended after {found.runs} runs, the most that were allowed, {found.move:.1f} standard errors"
            " of the seeds from where it would go next (what to do: --resume with more --runs)"
        )
    for key, estimate in estimates.items():
        if estimate.at_bound:
            texts.append(
                f"{key} is at its bound, {estimate.text['value']}: its error means little (what to do: wider bounds)"
            )
    keys = list(estimates)
    for i, key in enumerate(keys):
        for j in range(i):
            if abs(correlation[i, j]) > _CORRELATED:
                texts.append(
                    f"{keys[j]} and {key} are hardly told apart, their correlation is {correlation[i, j]:+.2f}"
                    " (what to do: further tests, or one unknown less)"
                )
    for test, fit, of in zip(problem.tests, fits, found.tests, strict=True):
        if fit.residual > _MISFIT * fit.expected:
            texts.append(
                f"{fit.name}: the curve fits worse, {100 * fit.residual:.1f} % of the peak, than random structures"
                f" explain, {100 * fit.expected:.1f} %: standard errors do not tell how wrong the model is"
            )
        end = min(test.until, *(float(band.gauge[-1]) for band in test.measured))
        if of.x[-1] < _SHORT * end:
            texts.append(
                f"{fit.name}: loads are compared up to {of.x[-1]:.3g} m of {end:.3g} m, where the first run ends"
                " (what to do: a larger control.target, or no stop_load)"
            )
    for samples in found.samples:
        left = len(np.unique(samples.seed))
        if left < found.seeds:
            texts.append(f"{found.seeds - left} of {found.seeds} seeds are left out: runs of them ended early")
            break
    return texts
