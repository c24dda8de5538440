"""Grégoire's series at all its sizes, with constants that were fitted to one beam of it: docs/validation.md.

Depths of 50 to 400 mm in the same proportions, thickness 50 mm, without a notch and with notches of a fifth and half of
the depth. Only peaks count, so that runs end behind them. Bažant's size-effect law is fitted to notched beams. Runs are
kept in a folder, and what is there is not run again.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterable
from pathlib import Path
from statistics import mean
from typing import Any

import above  # noqa: F401
import numpy as np
from predicted import LINE, MEAN

from common import ROOT, Check, Report, main, options, say, shown, table
from fissura import Case, load_case, run_ensemble
from fissura.bulk import bulk_law
from fissura.case import case_from_dict
from fissura.results.lettering import save
from fissura.results.pictures import DPI, INK, headline, legend, tidy

DEPTHS = (50, 100, 200, 400)
NOTCHES = (0.0, 0.2, 0.5)
#: Span and length over depth, as in the tests; runs end when the load has fallen to this part of its peak.
SPAN, LENGTH, STOP = 2.5, 3.5, 0.8


def beam(depth: float, notch: float, fitted: Case) -> Case:
    """A beam of a depth [m] with a notch through a part of it, of the fitted material."""
    middle, rest = 0.5 * LENGTH * depth, 0.5 * (LENGTH - SPAN) * depth
    half = 0.08 * depth if notch else 0.7 * depth  # of the length of the gauge
    scale = depth / 0.05
    case: dict[str, Any] = {
        "name": f"depth {1e3 * depth:g} mm, notch {notch:g}",
        "specimen": {"size": [LENGTH * depth, depth, 0.05]},
        "supports": [
            {"type": "pin", "face": "bottom", "at": rest},
            {"type": "roller", "face": "bottom", "at": rest + SPAN * depth},
        ],
        "load": {"face": "top", "at": middle},
        "gauge": {
            "a": {"face": "bottom", "at": middle - half},
            "b": {"face": "bottom", "at": middle + half},
        },
        "material": {name: getattr(fitted.material, name) for name in ("E", "alpha", "f_t", "G_t")},
        "discretization": {"l_f": fitted.discretization.l_f, "l_c": fitted.discretization.l_c},
        "control": {
            "type": "gauge" if notch else "dissipation",
            "target": 0.19e-3 * scale,
            "max_step": 2e-6 * scale**0.5,
            "stop_load": STOP,
        },
        "output": {"vtk": 0},
    }
    if notch:
        case["notch"] = {"face": "bottom", "position": middle, "depth": notch * depth, "width": 0.002}
    return case_from_dict(case)


def intensity(a: float) -> float:
    """``K_I / (s sqrt(d))`` of a beam in three-point bending, ``s = 1.5 F L / (b d^2)``; `a` is the notch over depth.

    By Guinea, Pastor, Planas and Elices (1998), International Journal of Fracture 89, for spans of 2.5 depths and more.
    """
    four = 1.9 + 0.41 * a + 0.51 * a**2 - 0.17 * a**3
    infinite = 1.99 + 0.83 * a - 0.31 * a**2 + 0.14 * a**3
    return math.sqrt(a) / ((1 - a) ** 1.5 * (1 + 3 * a)) * (infinite + 4.0 / SPAN * (four - infinite))


def law(depths: list[float], strengths: list[float]) -> tuple[float, float, float]:
    """Fit ``s = s_0 / sqrt(1 + d/d_0)`` by a straight line of ``1/s^2``; returns ``s_0``, ``d_0`` and R²."""
    x, y = np.array(depths), 1.0 / np.array(strengths) ** 2
    slope, rise = np.polyfit(x, y, 1)
    off = y - (rise + slope * x)
    r2 = 1.0 - float(off @ off) / float(((y - y.mean()) ** 2).sum())
    return 1.0 / math.sqrt(rise) if rise > 0 else math.inf, float(rise / slope), r2


def produce(found: argparse.Namespace) -> Report:
    """Run all beams, fit the law, draw."""
    fitted = load_case(ROOT / "examples" / "gregoire_d50_halfnotch.toml")
    rows = []
    for depth in found.depths:
        for notch in NOTCHES:
            runs = found.runs if depth < 400 else found.largest
            case = beam(depth / 1e3, notch, fitted)
            folder = found.keep / f"size_{depth}_{notch:g}"
            say(f"{case.name}: {runs} realisations")
            there = (folder / "ensemble.json").exists()
            ensemble = run_ensemble(case, runs, output=folder, companions="none", resume=there, seed=depth)
            counted = ensemble.runs["past_peak"] | (ensemble.runs["status"] == "finished")
            for k in np.flatnonzero(counted):
                peak = float(ensemble.runs["peak_load_N"][k])
                rows.append(
                    {
                        "case": case.name,
                        "depth": depth,
                        "notch": notch,
                        "number": int(ensemble.runs["number"][k]),
                        "peak_N": peak,
                        "strength_Pa": 1.5 * peak * SPAN / (0.05 * depth / 1e3),
                        "bodies_end": int(ensemble.runs["bodies_end"][k]),
                        "bodies_full": int(ensemble.runs["bodies_full"][k]),
                        "cpu_s": float(ensemble.runs["cpu_s"][k]),
                        "missing": int((~counted).sum()),
                    }
                )
    _picture(rows, ROOT / "docs" / "images" / "validation_sizes.png")
    return Report("sizes", rows, _markdown(rows, fitted), _checks(rows))


def _of(rows: Iterable[dict[str, Any]], depth: int, notch: float) -> list[dict[str, Any]]:
    return [row for row in rows if (row["depth"], row["notch"]) == (depth, notch)]


def _fit(rows: list[dict[str, Any]], notch: float) -> tuple[float, float, float]:
    mine = [row for row in rows if row["notch"] == notch]
    return law([row["depth"] / 1e3 for row in mine], [row["strength_Pa"] for row in mine])


def _energy(rows: list[dict[str, Any]], notch: float, modulus: float) -> float:
    """``G_f`` [J/m^2] of the law: ``1/s^2`` grows with depth by ``g / (E G_f)``."""
    at_zero, depth, _ = _fit(rows, notch)
    return intensity(notch) ** 2 * at_zero**2 * depth / modulus


def _markdown(rows: list[dict[str, Any]], fitted: Case) -> str:
    modulus, _ = bulk_law().macroscopic(fitted.material.E, fitted.material.alpha)
    heads = ["depth [mm]", "notch / depth", "realisations", "peak [kN]", "strength [MPa]", "bodies, of all", "time [s]"]
    lines = [
        [
            f"{depth}",
            f"{notch:g}",
            f"{len(mine)}",
            shown((row["peak_N"] / 1e3 for row in mine), 2),
            shown((row["strength_Pa"] / 1e6 for row in mine), 2),
            f"{mean(row['bodies_end'] for row in mine):.0f} of {mean(row['bodies_full'] for row in mine):.0f}",
            f"{mean(row['cpu_s'] for row in mine):.0f}",
        ]
        for depth in sorted({row["depth"] for row in rows})
        for notch in NOTCHES
        if (mine := _of(rows, depth, notch))
    ]
    fits = [
        [
            f"{notch:g}",
            f"{_fit(rows, notch)[0] / 1e6:.2f}",
            f"{1e3 * _fit(rows, notch)[1]:.0f}",
            f"{_fit(rows, notch)[2]:.3f}",
            f"{_energy(rows, notch, modulus):.1f}",
        ]
        for notch in NOTCHES[1:]
    ]
    return "\n\n".join(
        [
            "## Sizes: what was computed",
            "Means ± standard deviations of single realisations, adaptive. Strength is `1.5 F L/(b d²)`. *Bodies* are"
            " those at the end of the adaptive run, and at full resolution. *Time* is that of the processor.",
            "![Strength over depth](images/validation_sizes.png)",
            table(heads, lines),
            "Bažant's law `s = s_0/√(1 + d/d_0)`, fitted to the notched beams as a straight line of `1/s²` over `d`;"
            f" `G_f` from its slope with `E` = {modulus / 1e9:.1f} GPa of the whole:",
            table(["notch / depth", "s_0 [MPa]", "d_0 [mm]", "R²", "G_f [J/m²]"], fits),
            f"`G_t` of the contacts is {fitted.material.G_t:g} J/m².",
        ]
    )


def _checks(rows: list[dict[str, Any]]) -> list[Check]:
    worst = max(row["missing"] for row in rows)
    fits = [Check(f"R² of the law, notch {n:g}", _fit(rows, n)[2], 0.9, at_least=True) for n in NOTCHES[1:]]
    return [Check("realisations of one kind without a peak", worst, 0), *fits]


def _picture(rows: list[dict[str, Any]], path: Path) -> None:
    """Strength over depth, in logarithms, with the law."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.4), layout="constrained")
    axes = figure.subplots()
    fine = np.geomspace(40, 500, 100)
    for notch, marker in zip(NOTCHES, "osv", strict=True):
        mine = [row for row in rows if row["notch"] == notch]
        label = f"notch {notch:g} of the depth" if notch else "no notch"
        x, y = [row["depth"] for row in mine], [row["strength_Pa"] / 1e6 for row in mine]
        axes.loglog(x, y, marker, color=MEAN, markersize=5, markerfacecolor="none", label=label)
        if notch:
            at_zero, depth, _ = _fit(rows, notch)
            axes.loglog(fine, at_zero / 1e6 / np.sqrt(1 + fine / (1e3 * depth)), color=LINE)
    axes.set_xlabel("depth [mm]", color=INK)
    axes.set_ylabel("strength 1.5 F L/(b d²) [MPa]", color=INK)
    axes.set_xticks(DEPTHS, [str(depth) for depth in DEPTHS])
    axes.set_yticks([1, 2, 3, 5, 7], ["1", "2", "3", "5", "7"])
    axes.minorticks_off()
    tidy(axes)
    legend(axes)
    headline(axes, "Size effect", "realisations; lines: Bažant's law, fitted to the notched beams")
    save(figure, path, DPI)


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--depths", nargs="+", type=int, default=list(DEPTHS), metavar="MM", help="%(default)s")
    parser.add_argument("--runs", type=int, default=5, metavar="N", help="realisations of each beam")
    parser.add_argument("--largest", type=int, default=2, metavar="N", help="realisations of beams of 400 mm")
    parser.add_argument("--keep", type=Path, default=ROOT / "results" / "validation", help="folder for the runs")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["all"], [1], more=_more)))
