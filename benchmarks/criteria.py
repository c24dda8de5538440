"""Refinement criteria compared: error, cost and safety over gamma and r_f, against full resolution.

The ramp r_c - r_f stays that of the case; full resolution is run once for each seed.
"""

from __future__ import annotations

import argparse
import sys
from itertools import product
from typing import Any

from common import Check, Report, changed, difference, example, main, measured, middle, options, say, table, worst
from fissura import Case

CRITERIA = ("utilisation", "rankine")
#: The gamma of the case joins these.
GAMMAS = (0.5, 0.7, 0.9)
#: Radii of the refined balls in fine spacings.
RADII = (3.0, 4.0, 5.0, 6.0)
#: Largest load difference of the default combination, for every seed [per cent].
LIMIT = 1.0

TEXT = """\
Largest load difference, peak difference and elastic utilisation are the worst over the seeds; bodies at the end and the
ratio of processor times, full over adaptive, are medians. The default is set in bold.
"""


def produce(found: argparse.Namespace) -> Report:
    rows: list[dict[str, Any]] = []
    for name, seed in product(found.cases, found.seeds):
        say(f"{name}, seed {seed}: full resolution")
        case = example(name, seed)
        full = measured(case, full=True)
        for criterion, gamma, radius in product(CRITERIA, sorted({*GAMMAS, case.adaptivity.gamma}), RADII):
            row = {"case": name, "seed": seed, "criterion": criterion, "gamma": gamma, "r_f/l_f": radius}
            row["default"] = _is_default(case, criterion, gamma, radius)
            rows.append(row | difference(measured(_with(case, criterion, gamma, radius)), full))
            say(f"  {criterion}, gamma {gamma:g}, r_f {radius:g} l_f: {rows[-1]['load_difference']:.2f} %")
    return Report("criteria", rows, _markdown(rows), _checks(rows))


def _with(case: Case, criterion: str, gamma: float, radius: float) -> Case:
    r_f = radius * case.discretization.l_f
    r_c = r_f + case.adaptivity.r_c - case.adaptivity.r_f
    return changed(case, adaptivity={"criterion": criterion, "gamma": gamma, "r_f": r_f, "r_c": r_c})


def _is_default(case: Case, criterion: str, gamma: float, radius: float) -> bool:
    part = case.adaptivity
    same_radius = abs(part.r_f / case.discretization.l_f - radius) < 1e-6
    return part.criterion == criterion and part.gamma == gamma and same_radius


def _key(row: dict[str, Any]) -> tuple[str, float, float]:
    return row["criterion"], row["gamma"], row["r_f/l_f"]


def _markdown(rows: list[dict[str, Any]]) -> str:
    parts = ["## Refinement criteria", TEXT]
    heads = ["criterion", "γ", "r_f / l_f", "load, largest [%]", "peak [%]", "elastic utilisation", "bodies", "ratio"]
    for name in dict.fromkeys(row["case"] for row in rows):
        lines = []
        of_case = [row for row in rows if row["case"] == name]
        for key in dict.fromkeys(_key(row) for row in of_case):
            chosen = [row for row in of_case if _key(row) == key]
            mark = "**" if chosen[0]["default"] else ""
            note = "" if all(row["finished"] for row in chosen) else " (stopped early)"
            numbers = [
                f"{key[1]:g}",
                f"{key[2]:g}",
                f"{worst(chosen, 'load_difference'):.2f}{note}",
                f"{worst(chosen, 'peak_difference'):.2f}",
                f"{worst(chosen, 'max_elastic_utilisation'):.2f}",
                f"{middle(chosen, 'bodies_end'):.0f}",
                f"{middle(chosen, 'cpu_ratio'):.1f}",
            ]
            lines.append([f"{mark}{text}{mark}" for text in (f"`{key[0]}`", *numbers)])
        parts += [f"### `{name}`, criteria\n", table(heads, lines), ""]
    return "\n".join(parts)


def _checks(rows: list[dict[str, Any]]) -> list[Check]:
    chosen = [row for row in rows if row["default"]]
    if not chosen:
        return [Check("combinations that are the default", 0, 1, at_least=True)]
    stopped = Check("default runs that stopped early", sum(not row["finished"] for row in chosen), 0)
    return [stopped, Check("largest load difference of the default [%]", worst(chosen, "load_difference"), LIMIT)]


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["beam_d100"], [1, 2, 3])))
