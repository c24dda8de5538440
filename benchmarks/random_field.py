"""Random field: accuracy and cost of its expansions, what decides among them, and its share of a run.

Fields over a beam of 350 x 100 x 50 mm with smaller and smaller correlation lengths; then whole runs of the examples
with a field of 50 mm, in which all time spent in the field is counted.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from contextlib import contextmanager
from statistics import median
from typing import Any

import numpy as np
from scipy.special import log_ndtr, ndtri

import fissura.simulation.discretization as structure_module
from common import Check, Report, changed, cpu_time, example, main, measured, options, say, table
from fissura.case import Field
from fissura.material.field import MARGINALS, RandomField, covariance_named, marginal_named
from fissura.material.field import expansion as choice
from fissura.material.field.circulant import CirculantExpansion, _stencil
from fissura.material.field.eole import DenseExpansion
from fissura.material.field.field import _expanded
from fissura.material.field.separable import SeparableExpansion

#: The beam [m], correlation lengths [m], and points that are evaluated.
SIZE = (0.35, 0.1, 0.05)
LENGTHS = (0.1, 0.05, 0.025, 0.0125, 0.006)
POINTS = 100_000
#: Models by name, order and what the case file calls for.
MODELS = [("squared-exponential", None), ("matern", 2.5), ("matern", 1.5), ("matern", 1.0), ("exponential", None)]
#: Nodes beyond which eigenpairs of a whole grid are not tried.
MOST_DENSE = 2000
#: Fewest points per minute and core, and largest share of a run [%].
RATE, SHARE = 1e6, 5.0
#: Examples that are run with a field, and its correlation length [m].
CASES, LENGTH = ("beam_d100", "unnotched_beam"), 0.05

TEXT = f"""\
A field over a beam of 350 × 100 × 50 mm, grid spacing a third of the correlation length where nothing else is said.
*Variance error* is that before the pointwise variance is corrected. *Correlation error* is the largest difference of
the field's correlation from the model's after it, over 4000 pairs of points at all distances, computed, not sampled.
*Build* depends on the case alone, *draw* is paid by every realisation; processor times. *Points per minute* is for
{POINTS} points with the grafted marginal applied, one core. A star marks what `expand` chooses.
"""

RUNS = """\
Whole runs with a field of {length:g} mm (squared exponential, grafted, CoV 0.25), medians over seeds of nuclei and
field: processor time of the run, of building the field, of evaluating it at all contacts and bodies of all
discretizations, and the share of both in the run. *Picture* is the time for `field.png`, which comes on top once for a
run that has a folder.
"""


DISTORTION = """\
What the marginal distribution does to correlation (CoV 0.25): that of `H` less that of `Ĥ`, by Gauss-Hermite
quadrature. And what a variance error does to it when it is not corrected: the probability of less than `H`, over the
right one.
"""


def produce(found: argparse.Namespace) -> Report:
    rows = []
    for name, nu in MODELS:
        for length in LENGTHS:
            rows += _rows(name, nu, length)
    runs = [_run(name, found.seeds) for name in found.cases]
    return Report("random_field", [*rows, *runs], _markdown(rows, runs), _checks(rows, runs))


def _rows(name: str, nu: float | None, length: float) -> list[dict[str, Any]]:
    covariance = covariance_named(name, (length,), nu)
    say(f"{name} {nu or ''} {1e3 * length:g} mm")
    chosen = choice.expand(covariance, SIZE)
    small = SeparableExpansion if covariance.model.separable else DenseExpansion
    steps = covariance.length / 3.0
    kinds: list[tuple[Any, Callable[[], Any]]] = [(type(chosen), lambda: choice.expand(covariance, SIZE))]
    nodes = np.prod([s / h + 1 for s, h in zip(SIZE, steps, strict=True)])
    if type(chosen) is not small and (covariance.model.separable or nodes < MOST_DENSE):
        kinds.append((small, lambda: small(covariance, SIZE, steps, 0.01)))
    if type(chosen) is not CirculantExpansion:
        kinds.append((CirculantExpansion, lambda: CirculantExpansion(covariance, SIZE, steps)))
    x = np.random.default_rng(1).random((POINTS, 3)) * SIZE
    marginal = marginal_named("grafted", 0.25)
    rows = []
    for kind, build in kinds:
        build()  # compiled kernels are not part of what is measured
        expansion, built = cpu_time(build, 3)
        accuracy = expansion.accuracy
        xi = np.random.default_rng(2).standard_normal(accuracy.modes)
        at, drawn = cpu_time(lambda e=expansion, n=xi: e.realisation(n), 3)
        field = RandomField(at, marginal, accuracy, 0)
        field.strength(x[:10])
        _, evaluated = cpu_time(lambda f=field: f.strength(x), 1 if accuracy.modes < 1000 else 2)
        rows.append(
            {
                "model": name if nu is None else f"Matérn {nu:g}",
                "length_mm": 1e3 * length,
                "method": accuracy.method,
                "chosen": kind is type(chosen),
                "nodes": accuracy.nodes,
                "modes": accuracy.modes,
                "spacing_mm": 1e3 * min(accuracy.spacing),
                "variance_error": 100 * accuracy.mean,
                "variance_error_max": 100 * accuracy.largest,
                "correlation_error": _correlation_error(expansion, covariance),
                "build_ms": 1e3 * built,
                "draw_ms": 1e3 * drawn,
                "rate": 60.0 * POINTS / evaluated,
            }
        )
    return rows


def _pairs(covariance: Any) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of points of the beam at scaled distances from 0 to 3."""
    rng = np.random.default_rng(3)
    x = rng.random((40_000, 3)) * SIZE
    way = rng.standard_normal((len(x), 3))
    way *= 3.0 * rng.random((len(x), 1)) / np.linalg.norm(way, axis=1)[:, None]
    y = x + way * covariance.length
    inside = np.flatnonzero(((y >= 0.0) & (y <= SIZE)).all(axis=1))[:4000]
    return x[inside], y[inside]


def _correlation_error(expansion: Any, covariance: Any) -> float:
    """Largest difference of a field's correlation from the model's."""
    x, y = _pairs(covariance)
    target = covariance.of(np.linalg.norm((x - y) / covariance.length, axis=1))
    if isinstance(expansion, CirculantExpansion):
        return float(np.abs(_of_estimates(covariance, np.array(expansion.accuracy.spacing), x, y) - target).max())
    modes = [_modes(expansion, points) for points in (x, y)]
    a, b = (m / np.linalg.norm(m, axis=1)[:, None] for m in modes)
    return float(np.abs(np.einsum("pk,pk->p", a, b) - target).max())


def _modes(expansion: Any, x: np.ndarray) -> np.ndarray:
    """Values of all kept modes at points."""
    if isinstance(expansion, DenseExpansion):
        return expansion._covariance.tabulated(x, expansion._nodes) @ expansion._basis
    columns = [
        axis.modes(expansion._covariance, x[:, column])
        for axis, column in zip(expansion._axes, expansion._permutation, strict=True)
    ]
    i, j, k = np.unravel_index(expansion._order, expansion._shape)
    return columns[0][:, i] * columns[1][:, j] * columns[2][:, k]


def _of_estimates(covariance: Any, steps: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Correlation of two estimates, each from the nodes around its point."""
    near = _stencil(steps)
    inverse = np.linalg.inv(covariance.between(near, near))
    out = np.empty(len(x))
    for p, (one, other) in enumerate(zip(x, y, strict=True)):
        nodes, weights, sizes = [], [], []
        for point in (one, other):
            here = np.floor(point / steps) * steps + near
            c = covariance.between(point[None], here)[0]
            nodes.append(here)
            weights.append(inverse @ c)
            sizes.append(weights[-1] @ c)
        between = weights[0] @ covariance.between(nodes[0], nodes[1]) @ weights[1]
        out[p] = between / np.sqrt(sizes[0] * sizes[1])
    return out


@contextmanager
def _counted(spent: dict[str, float]) -> Any:
    """Count the time in which a simulation builds and evaluates its field."""

    def counting(function: Callable[..., Any], name: str) -> Callable[..., Any]:
        def call(*arguments: Any) -> Any:
            start = time.process_time()
            try:
                return function(*arguments)
            finally:
                spent[name] += time.process_time() - start

        return call

    made, transformed = structure_module.field_from_case, RandomField.strength
    structure_module.field_from_case = counting(made, "build")
    RandomField.strength = counting(transformed, "evaluate")  # type: ignore[method-assign]
    try:
        yield
    finally:
        structure_module.field_from_case = made
        RandomField.strength = transformed  # type: ignore[method-assign]


def _run(name: str, seeds: list[int]) -> dict[str, Any]:
    rows = []
    for seed in [seeds[0], *seeds]:  # the first compiles and loads
        case = changed(example(name, seed), field=Field(length=LENGTH))
        say(f"{name}, seed {seed}, with a field")
        spent = {"build": 0.0, "evaluate": 0.0}
        _expanded.cache_clear()
        with _counted(spent):
            run = measured(case)
        rows.append({"cpu_s": run.cpu_s, "steps": run.result.steps, "finished": run.finished, **spent})
        last = run.result
        rows[-1]["bodies"] = last.summary["bodies_end"]
    rows = rows[1:]
    row = {key: median(float(r[key]) for r in rows) for key in ("cpu_s", "build", "evaluate", "bodies", "steps")}
    row["share"] = 100.0 * median((r["build"] + r["evaluate"]) / r["cpu_s"] for r in rows)
    return {"case": name, "finished": all(r["finished"] for r in rows), **row, "picture": _picture(case, last)}


def _picture(case: Any, result: Any) -> float:
    import tempfile
    from pathlib import Path

    from fissura.material import field_from_case
    from fissura.pictures.field import plot_field
    from fissura.specimen import domain_from_case

    field = field_from_case(case)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "field.png"
        return cpu_time(
            lambda: plot_field(field, case.field, domain_from_case(case), result.last.tessellation, path), 2
        )[1]


def _markdown(rows: list[dict[str, Any]], runs: list[dict[str, Any]]) -> str:
    heads = [
        "model",
        "length [mm]",
        "method",
        "nodes",
        "modes",
        "spacing [mm]",
        "variance error, mean [%]",
        "largest [%]",
    ]
    heads += ["correlation error", "build [ms]", "draw [ms]", "points per minute [10⁶]"]
    lines = [
        [
            row["model"],
            f"{row['length_mm']:g}",
            row["method"] + (" *" if row["chosen"] else ""),
            f"{row['nodes']}",
            f"{row['modes']}",
            f"{row['spacing_mm']:.3g}",
            f"{row['variance_error']:.2g}",
            f"{row['variance_error_max']:.2g}",
            f"{row['correlation_error']:.2g}",
            f"{row['build_ms']:.1f}",
            f"{row['draw_ms']:.1f}",
            f"{row['rate'] / 1e6:.3g}",
        ]
        for row in rows
    ]
    parts = ["## Random field", TEXT, table(heads, lines), "", *_distortion(), "", RUNS.format(length=1e3 * LENGTH)]
    heads = ["case", "bodies at the end", "steps", "run [s]", "build [ms]", "evaluate [ms]", "share [%]", "picture [s]"]
    lines = [
        [
            f"`{row['case']}`",
            f"{row['bodies']:.0f}",
            f"{row['steps']:.0f}",
            f"{row['cpu_s']:.2f}",
            f"{1e3 * row['build']:.1f}",
            f"{1e3 * row['evaluate']:.1f}",
            f"{row['share']:.2g}",
            f"{row['picture']:.2f}",
        ]
        for row in runs
    ]
    return "\n".join([*parts, table(heads, lines)])


#: Correlations, and probabilities and variance errors, for which the distortion is told.
CORRELATIONS, PROBABILITIES, ERRORS = (-0.5, 0.3, 0.5, 0.7, 0.9), (1e-2, 1e-3, 1e-4), (0.01, 0.05)


def _distortion() -> list[str]:
    nodes, weights = np.polynomial.hermite_e.hermegauss(120)
    weights = weights / weights.sum()
    lines = []
    for name in MARGINALS:
        marginal, cells = marginal_named(name, 0.25), []
        first = marginal.from_gaussian(nodes)[:, None] - 1.0
        for rho in CORRELATIONS:
            second = marginal.from_gaussian(rho * nodes[:, None] + np.sqrt(1.0 - rho * rho) * nodes) - 1.0
            found = float((weights[:, None] * weights * first * second).sum()) / 0.25**2
            cells.append(f"{found - rho:+.4f}")
        lines.append([name, *cells])
    parts = [DISTORTION, table(["distribution", *(f"correlation {rho:g}" for rho in CORRELATIONS)], lines), ""]
    lines = [
        [f"{100 * error:g} %", *(f"{np.exp(log_ndtr(ndtri(p) / np.sqrt(1.0 - error))) / p:.2f}" for p in PROBABILITIES)]
        for error in ERRORS
    ]
    return [*parts, table(["variance error", *(f"probability {p:g}" for p in PROBABILITIES)], lines)]


def _checks(rows: list[dict[str, Any]], runs: list[dict[str, Any]]) -> list[Check]:
    slowest = min(row["rate"] for row in rows if row["chosen"])
    checks = [Check("fewest points per minute and core", slowest, RATE, at_least=True)]
    checks += [Check(f"share of the field in {row['case']} [%]", row["share"], SHARE) for row in runs]
    checks += [Check("runs that finished", float(all(row["finished"] for row in runs)), 1.0, at_least=True)]
    return checks


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, CASES, [1, 2, 3])))
