"""Calibrate f_t and G_t of the half-notched beam of Grégoire et al. (2013) to their measured load-CMOD band.

A grid of both parameters is run with five seeds and judged by the mean of their curves; the values in the case file are
those of the best pair. They are then run with as many other seeds, on which the choice did not depend, and with bodies
of other sizes. A curve is judged by its excursion: by how much its load leaves the measured band, as per cent of the
largest measured load.
"""

from __future__ import annotations

import sys
from itertools import product
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from common import ROOT, Check, Report, changed, main, measured, options, say, table
from fissura import Case, load_case
from fissura.results.measured import MeasuredBand, read_measured

CASE = "gregoire_d50_halfnotch"
STRENGTHS = (2.6e6, 2.8e6, 3.0e6, 3.2e6)
ENERGIES = (23.0, 26.0, 29.0, 32.0)
SPACINGS = (10e-3, 7e-3, 5e-3, 4e-3)
RISE = 5e-6  # an opening on the straight part of the measured curves [m]
LARGEST_EXCURSION = 5.0  # per cent of the largest measured load


def load_at(curve: dict[str, NDArray[Any]], gauge: NDArray[np.float64]) -> NDArray[np.float64]:
    """Load of a run at given openings [N]."""
    loads: NDArray[np.float64] = np.interp(gauge, np.append(0.0, curve["gauge_m"]), np.append(0.0, curve["load_N"]))
    return loads


def excursion(load: NDArray[np.float64], band: MeasuredBand) -> NDArray[np.float64]:
    """How far a load is above (+) or below (-) the band, per cent of the largest measured load."""
    above, below = np.maximum(load - band.upper, 0.0), np.maximum(band.lower - load, 0.0)
    return 100.0 * (above - below) / band.upper.max()


def judged(name: str, load: NDArray[np.float64], band: MeasuredBand) -> dict[str, Any]:
    """What is reported of one curve."""
    out = excursion(load, band)
    return {
        "run": name,
        "highest_measured_point_N": float(load.max()),
        "inside": float(np.mean(out == 0.0)),
        "above": float(out.max()),
        "below": float(out.min()),
    }


def trial(
    case: Case, band: MeasuredBand, name: str, seeds: list[int]
) -> tuple[dict[str, Any], list[NDArray[np.float64]]]:
    """Run a case with some seeds and judge the mean of their curves."""
    loads = [load_at(measured(changed(case, seed=seed)).result.curve, band.gauge) for seed in seeds]
    row = judged(name, np.mean(loads, axis=0), band)
    say(f"  {name}: {row['inside']:.0%} inside, {row['below']:+.1f} to {row['above']:+.1f} %")
    return row, loads


def draw(loads: list[NDArray[np.float64]], band: MeasuredBand) -> None:
    """All seeds over the measured band."""
    figure = Figure(figsize=(7.2, 4.6), layout="constrained")
    axes = figure.subplots()
    micro = band.gauge * 1e6
    axes.fill_between(micro, band.lower, band.upper, color="#d9dce1", label="measured, Grégoire et al. (2013)")
    for k, load in enumerate(loads):
        axes.plot(micro, load, color="#1f4e79", lw=0.8, alpha=0.6, label="computed, each seed" if k == 0 else None)
    axes.plot(micro, np.mean(loads, axis=0), color="#c8451b", lw=2.0, label="mean of the seeds")
    axes.set(xlabel="CMOD [µm]", ylabel="load [N]", xlim=(0, micro.max()), ylim=(0, None))
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)
    figure.savefig(ROOT / "docs" / "images" / "gregoire_band.png", dpi=150)


def produce(found: Any) -> Report:
    """Run the grid and the seeds."""
    case = load_case(ROOT / "examples" / f"{CASE}.toml")
    assert case.output.measured is not None
    band = read_measured(case.output.measured)
    case = changed(case, output={"vtk": 0, "measured": None})
    grid = []
    for f_t, g_t in product(STRENGTHS, ENERGIES):
        material = {"f_t": f_t, "G_t": g_t}  # what the case file leaves to defaults follows
        name = f"f_t {f_t / 1e6:.1f} MPa, G_t {g_t:.0f} J/m²"
        grid.append(trial(changed(case, material=material), band, name, found.seeds)[0])
    fitted, _ = trial(case, band, f"mean of seeds {numbers(found.seeds)}, to which it was fitted", found.seeds)
    others = [max(found.seeds) + seed for seed in found.seeds]
    predicted, loads = trial(case, band, f"mean of seeds {numbers(others)}, predicted", others)
    runs = [judged(f"seed {seed}", load, band) for seed, load in zip(others, loads, strict=True)]
    sizes = []
    for spacing in SPACINGS:
        other = changed(case, discretization={"l_f": spacing})
        row, of_all = trial(other, band, f"l_f {spacing * 1e3:g} mm", found.seeds)
        sizes.append(row | {"rise": rise(np.mean(of_all, axis=0), band)})
    draw(loads, band)
    m = case.material
    text = "\n\n".join(
        [
            f"## Half-notched beam of Grégoire et al.\n\nChosen: f_t = {m.f_t / 1e6:g} MPa, G_t = {m.G_t:g} J/m², with"
            f" E = {m.E / 1e9:g} GPa and l_f = {case.discretization.l_f * 1e3:g} mm. The seeds that are predicted had"
            " no part in the choice: other placings of the bodies, the same test.",
            listed([fitted, predicted, *runs]),
            f"The grid, means of the curves of seeds {numbers(found.seeds)}:",
            listed(grid),
            f"Bodies of other sizes with the chosen pair, seeds {numbers(found.seeds)}; *rise* is the load at"
            f" {RISE * 1e6:g} µm, where the measured curves are straight, over the middle of the band:",
            listed(sizes, rise="rise"),
        ]
    )
    checks = [
        check
        for row, what in ((fitted, "fitted"), (predicted, "predicted"))
        for check in (
            Check(f"{what} mean curve above the band, % of the largest load", row["above"], LARGEST_EXCURSION),
            Check(f"{what} mean curve below the band, % of the largest load", -row["below"], LARGEST_EXCURSION),
        )
    ]
    return Report("calibrate_gregoire", [*grid, fitted, predicted, *runs, *sizes], text, checks)


def rise(load: NDArray[np.float64], band: MeasuredBand) -> float:
    """Load on the straight part of the measured curves over the middle of the band."""
    middle = 0.5 * (band.lower + band.upper)
    return float(np.interp(RISE, band.gauge, load) / np.interp(RISE, band.gauge, middle))


def numbers(seeds: list[int]) -> str:
    """Seeds as a range."""
    return f"{min(seeds)} to {max(seeds)}"


def listed(rows: list[dict[str, Any]], **more: str) -> str:
    """Rows as a table, with more columns by their keys."""
    heads = ("run", "largest load [N]", "points inside the band", "highest above", "deepest below", *more.values())
    return table(
        heads,
        [
            (
                row["run"],
                f"{row['highest_measured_point_N']:.0f}",
                f"{row['inside']:.0%}",
                f"{row['above']:.1f} %",
                f"{-row['below']:.1f} %",
                *(f"{row[key]:.2f}" for key in more),
            )
            for row in rows
        ],
    )


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, [CASE], [1, 2, 3, 4, 5])))
