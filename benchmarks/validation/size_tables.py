"""Tables and picture of the size effect: for sizes.py."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from statistics import mean, stdev
from typing import Any

import above  # noqa: F401
import numpy as np
import size_laws
from predicted import LINE, MEAN
from size_beams import DEPTHS, NOTCHES, PRISM, TAIL, WORK

from common import shown, table
from fissura import Case
from fissura.case.macroscopic import macroscopic_elasticity
from fissura.elasticity.tension import macroscopic_tension
from fissura.pictures.curves import DPI, INK, headline, legend, tidy
from fissura.pictures.lettering import save


def of(rows: Iterable[dict[str, Any]], kind: str, depth: int, notch: float) -> list[dict[str, Any]]:
    return [row for row in rows if (row["kind"], row["depth"], row["notch"]) == (kind, depth, notch)]


def series(rows: list[dict[str, Any]], *notches: float) -> tuple[list[float], list[float], list[float]]:
    """Notches, depths [m] and strengths [Pa] of realisations."""
    mine = [row for row in rows if row["kind"] == "strength" and row["notch"] in notches]
    return (
        [row["notch"] for row in mine],
        [row["depth"] / 1e3 for row in mine],
        [row["strength_Pa"] for row in mine],
    )


def whole_modulus(fitted: Case) -> float:
    return float(macroscopic_elasticity().macroscopic(fitted.material.E, fitted.material.alpha)[0])


def _with(value: float, error: float, digits: int) -> str:
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def markdown(rows: list[dict[str, Any]], fitted: Case) -> str:
    modulus = whole_modulus(fitted)
    return "\n\n".join(
        [
            "## Sizes: what was computed",
            "Means ± standard deviations of single realisations, adaptive. Strength is `1.5 F L/(b d²)`. *Bodies* are"
            " those at the end of the run, and at full resolution. *Time* is that of the processor.",
            "![Strength over depth](images/validation_sizes.png)",
            _table_of_series(rows),
            "**Notched.** Bažant's law `s = s_0/√(1 + d/d_0)`, by least squares of `ln s`, ± standard errors from the"
            f" scatter about the law. `G_f = g s_0² d_0/E` with `E` = {modulus / 1e9:.1f} GPa of the whole, in plane"
            " stress. *Straight line*: `G_f` by the line of `1/s²` over `d`, as RILEM recommends. *Both*: one law for"
            " both notches, `s = √(E G_f/(g' c_f + g d))`.",
            _table_of_notched(rows, modulus),
            "**Not notched.** Law of a boundary layer, `s = s_∞ (1 + r D_b/d)^(1/r)`:",
            _table_of_unnotched(rows),
            "**Energies**, over the ligament. *To 5 %*: dissipated until the load has fallen to"
            f" {PRISM:.0%} of its peak, the end of the prisms. *Work*: all of the load up to {TAIL:.0%} of the peak, or"
            " to an opening of 4 % of the depth. *Tail*: `F u` there, what a tail `F ~ 1/u²` would add.",
            _table_of_work(rows),
            _table_of_energies(rows, fitted),
        ]
    )


def _table_of_series(rows: list[dict[str, Any]]) -> str:
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
        for depth in DEPTHS
        for notch in NOTCHES
        if (mine := of(rows, "strength", depth, notch))
    ]
    return table(heads, lines)


def _table_of_notched(rows: list[dict[str, Any]], modulus: float) -> str:
    heads = ["notch / depth", "s_0 [MPa]", "d_0 [mm]", "d / d_0", "R²", "c_f [mm]", "G_f [J/m²]", "straight line"]
    lines = []
    for notch in NOTCHES[1:]:
        _, depths, strengths = series(rows, notch)
        law = size_laws.notched(depths, strengths)
        g, slope = size_laws.release(notch)
        at_zero, at = size_laws.straight(depths, strengths)
        c_f = 1e3 * g / slope
        lines.append(
            [
                f"{notch:g}",
                _with(law.first / 1e6, law.errors[0] / 1e6, 2),
                _with(1e3 * law.second, 1e3 * law.errors[1], 0),
                f"{min(depths) / law.second:.1f} to {max(depths) / law.second:.1f}",
                f"{law.r2:.3f}",
                _with(c_f * law.second, c_f * law.errors[1], 1),
                _with(*size_laws.fracture_energy(law, notch, modulus), 1),
                f"{g * at_zero**2 * at / modulus:.1f}",
            ]
        )
    for first, last in ((50, 400), (50, 200), (100, 400)):
        some = [row for row in rows if first <= row["depth"] <= last]
        both = size_laws.together(*series(some, *NOTCHES[1:]), modulus)
        zone, energy = _with(1e3 * both.second, 1e3 * both.errors[1], 1), _with(both.first, both.errors[0], 1)
        lines.append([f"both, {first} to {last} mm", "", "", "", f"{both.r2:.3f}", zone, energy, ""])
    return table(heads, lines)


def _table_of_unnotched(rows: list[dict[str, Any]]) -> str:
    _, depths, strengths = series(rows, 0.0)
    lines = []
    for power in (1.0, 2.0):
        law = size_laws.unnotched(depths, strengths, power)
        lines.append(
            [
                f"{power:g}",
                _with(law.first / 1e6, law.errors[0] / 1e6, 2),
                _with(1e3 * law.second, 1e3 * law.errors[1], 0),
                f"{law.r2:.3f}",
            ]
        )
    return table(["r", "s_∞ [MPa]", "D_b [mm]", "R²"], lines)


def _table_of_work(rows: list[dict[str, Any]]) -> str:
    heads = [
        "depth [mm]",
        "notch / depth",
        "realisations",
        "peak [kN]",
        "to 5 % [J/m²]",
        "work [J/m²]",
        "tail [J/m²]",
        "time [s]",
    ]
    lines = [
        [
            f"{depth}",
            f"{notch:g}",
            f"{len(mine)}",
            shown((row["peak_N"] / 1e3 for row in mine), 2),
            shown((row["spent_J_m2"] for row in mine), 1),
            shown((row["work_J_m2"] for row in mine), 1),
            shown((row["tail_J_m2"] for row in mine), 1),
            f"{mean(row['cpu_s'] for row in mine):.0f}",
        ]
        for depth, notch in WORK
        if (mine := of(rows, "work", depth, notch))
    ]
    return table(heads, lines)


def _table_of_energies(rows: list[dict[str, Any]], fitted: Case) -> str:
    material, unit = fitted.material, fitted.material.G_t
    both = size_laws.together(*series(rows, *NOTCHES[1:]), whole_modulus(fitted))
    spent = [row["spent_J_m2"] for row in rows if row["kind"] == "work"]
    works = [row["work_J_m2"] for row in rows if row["kind"] == "work"]
    brittleness = 2.0 * material.E * unit / material.f_t**2 / fitted.discretization.l_f
    prisms = [unit * bound for bound in macroscopic_tension().energy(brittleness, material.alpha)]
    heads = ["energy", "[J/m²]", "over G_t"]
    lines = [
        ["`G_t`, of the contacts", f"{unit:g}", "1"],
        ["`G_f`, both notches", _with(both.first, both.errors[0], 1), f"{both.first / unit:.2f}"],
        [
            "`G_F`, of prisms in direct tension to 5 %",
            "{:.0f} to {:.0f}".format(*prisms),
            f"{sum(prisms) / 2 / unit:.2f}",
        ],
        ["beams, dissipated to 5 % of the peak", _with(mean(spent), stdev(spent), 1), f"{mean(spent) / unit:.2f}"],
        ["`W_F`, work of fracture", _with(mean(works), stdev(works), 1), f"{mean(works) / unit:.2f}"],
    ]
    return table(heads, lines)


def picture(rows: list[dict[str, Any]], path: Path) -> None:
    """Strength over depth, in logarithms, with the laws."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    axes = figure.subplots()
    for notch, marker in zip(NOTCHES, "osv", strict=True):
        _, x, y = series(rows, notch)
        fine = 1e3 * np.geomspace(min(x), max(x), 50)
        label = f"notch {notch:g} of the depth" if notch else "no notch"
        if notch:
            law = size_laws.notched(x, y)
            line = law.first / np.sqrt(1.0 + fine / (1e3 * law.second))
        else:
            law = size_laws.unnotched(x, y, 2.0)
            line = law.first * np.sqrt(1.0 + 2e3 * law.second / fine)
        axes.loglog(fine, line / 1e6, color=LINE)
        points = {"color": MEAN, "markersize": 5, "markerfacecolor": "none"}
        axes.loglog([1e3 * d for d in x], [s / 1e6 for s in y], marker, label=label, **points)
    axes.set_xlabel("depth [mm]", color=INK)
    axes.set_ylabel("strength 1.5 F L/(b d²) [MPa]", color=INK)
    axes.set_xticks(DEPTHS, [str(depth) for depth in DEPTHS])
    axes.set_yticks([0.5, 1, 2, 3, 5, 7], ["0.5", "1", "2", "3", "5", "7"])
    axes.minorticks_off()
    tidy(axes)
    legend(axes)
    headline(axes, "Size effect", "realisations; lines: Bažant's law, and that of a boundary layer")
    save(figure, path, DPI)
