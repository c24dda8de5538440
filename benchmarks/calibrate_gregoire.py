"""Calibrate f_t and G_t of the half-notched beam of Grégoire et al. (2013) to their measured load-CMOD band.

A grid of both parameters is run with the first seed; the values in the case file are then run with all seeds. A run is
judged by its excursion: by how much its load leaves the measured band, as per cent of the largest measured load.
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
STRENGTHS = (3.2e6, 3.6e6, 4.0e6)
ENERGIES = (34.0, 37.0, 40.0)
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


def trial(case: Case, band: MeasuredBand, name: str) -> tuple[dict[str, Any], NDArray[np.float64]]:
    """Run a case and judge it."""
    load = load_at(measured(case).result.curve, band.gauge)
    row = judged(name, load, band)
    say(f"  {name}: {row['inside']:.0%} inside, {row['below']:+.1f} to {row['above']:+.1f} %")
    return row, load


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
        grid.append(trial(changed(case, seed=found.seeds[0], material=material), band, name)[0])
    runs = [trial(changed(case, seed=seed), band, f"seed {seed}") for seed in found.seeds]
    loads = [load for _, load in runs]
    mean = judged("mean of the seeds", np.mean(loads, axis=0), band)
    draw(loads, band)
    m = case.material
    text = "\n\n".join(
        [
            f"## Half-notched beam of Grégoire et al.\n\nChosen: f_t = {m.f_t / 1e6:g} MPa, G_t = {m.G_t:g} J/m², with"
            f" E = {m.E / 1e9:g} GPa and l_f = {case.discretization.l_f * 1e3:g} mm.",
            listed([*[row for row, _ in runs], mean]),
            f"The grid, seed {found.seeds[0]}:",
            listed(grid),
        ]
    )
    checks = [
        Check("mean curve above the band, % of the largest load", mean["above"], LARGEST_EXCURSION),
        Check("mean curve below the band, % of the largest load", -mean["below"], LARGEST_EXCURSION),
    ]
    return Report("calibrate_gregoire", [*grid, *[row for row, _ in runs], mean], text, checks)


def listed(rows: list[dict[str, Any]]) -> str:
    """Rows as a table."""
    heads = ("run", "largest load [N]", "points inside the band", "highest above", "deepest below")
    return table(
        heads,
        [
            (
                row["run"],
                f"{row['highest_measured_point_N']:.0f}",
                f"{row['inside']:.0%}",
                f"{row['above']:.1f} %",
                f"{-row['below']:.1f} %",
            )
            for row in rows
        ],
    )


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, [CASE], [1, 2, 3, 4, 5])))
