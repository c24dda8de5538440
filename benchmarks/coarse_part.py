"""The coarse part: heterogeneous as the material, or smooth; what each choice costs and how far the load is off.

Effort is the sum of bodies times linear iterations over a run, and does not depend on what else a machine does.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from statistics import median
from typing import Any
from unittest import mock

from common import Check, Report, Run, changed, difference, example, main, measured, options, say, table
from fissura import Case
from fissura.equilibrium import limits

#: Largest error of the load [%] and seeds of each beam; the last opening that is compared [m].
WANTED = 1.0
SEEDS = {"beam_d200": (1, 2, 3, 4, 5), "beam_d400": (1, 2)}
TARGET = {"beam_d200": 1.0e-4, "beam_d400": 1.27e-4}


@dataclass(frozen=True)
class Variant:
    """A coarse part: alpha and bending of its contacts, None where these are the material's; r_f over l_f."""

    name: str
    radius: float
    alpha: float | None = None
    bending: float = 1.0


VARIANTS = (
    Variant("heterogeneous (default)", 6.0),
    Variant("heterogeneous", 4.0),
    Variant("bending alone", 4.0, 0.0),
    Variant("α_c 0.5 alone", 4.0, 0.5, 0.0),
    Variant("smooth: α_c 0.5, bending", 4.0, 0.5),
    Variant("α_c 0.7, bending", 4.0, 0.7),
    Variant("α_c 1, bending", 4.0, 1.0),
    Variant("smooth, twice the bending", 4.0, 0.5, 2.0),
    Variant("smooth", 3.0, 0.5),
    Variant("smooth", 6.0, 0.5),
)


def effort(run: Run) -> float:
    """Sum of bodies times linear iterations."""
    curve = run.result.curve
    return float((curve["bodies"] * curve["linear_iterations"]).sum())


def of_variant(case: Case, variant: Variant) -> Case:
    """A case with this coarse part."""
    l_f, l_c = case.discretization.l_f, case.discretization.l_c
    r_f = variant.radius * l_f
    kind = "heterogeneous" if variant.alpha is None else "smooth"
    return changed(case, adaptivity={"coarse_part": kind, "r_f": r_f, "r_c": r_f + 2.0 * l_c})


def rows_of(found: argparse.Namespace) -> list[dict[str, Any]]:
    """One row for each specimen and coarse part."""
    rows: list[dict[str, Any]] = []
    for name in found.cases:
        for seed in SEEDS[name]:
            case = changed(example(name, seed), control={"target": TARGET[name]})
            full = measured(case, full=True)
            say(f"{name}, seed {seed}: full resolution")
            for variant in VARIANTS:
                alpha = limits.SMOOTH_ALPHA if variant.alpha is None else variant.alpha
                with mock.patch.multiple(limits, SMOOTH_ALPHA=alpha, BENDING=variant.bending):
                    adaptive = measured(of_variant(case, variant))
                row = {"case": name, "seed": seed, "variant": variant.name, "radius": variant.radius}
                row |= difference(adaptive, full) | {"saved": effort(full) / effort(adaptive)}
                row["error"] = abs(row["load_difference"])
                rows.append(row)
                say(f"  {variant.name}, r_f {variant.radius:g} l_f: {row['error']:.2f} %, {row['saved']:.1f}")
    return rows


def produce(found: argparse.Namespace) -> Report:
    rows = rows_of(found)
    checks = []
    lines = []
    for name in found.cases:
        for variant in VARIANTS:
            mine = [r for r in rows if (r["case"], r["variant"], r["radius"]) == (name, variant.name, variant.radius)]
            errors = [row["error"] for row in mine]
            middle = {key: median(row[key] for row in mine) for key in ("bodies_end", "refinements", "saved")}
            lines.append(
                [
                    f"`{name}`, {variant.name}",
                    f"{variant.radius:g} l_f",
                    f"{median(errors):.2f} ({max(errors):.2f})",
                    f"{middle['bodies_end']:.0f}",
                    f"{middle['refinements']:.0f}",
                    f"{middle['saved']:.1f}",
                ]
            )
            if variant.name.startswith("smooth: "):
                checks.append(Check(f"{name}: largest error of a smooth coarse part [%]", max(errors), WANTED))
    heads = [
        "coarse part",
        "r_f",
        "load, median (worst) [%]",
        "bodies at the end",
        "refinements",
        "effort, full over adaptive",
    ]
    seeds = ", ".join(f"{len(SEEDS[name])} of `{name}`" for name in found.cases)
    text = f"""## The coarse part

Largest difference of the load from full resolution over the curve, to an opening past the peak; medians over seeds
({seeds}). *Effort* is the sum of bodies times linear iterations. `α_c` is the tangential over the
normal stiffness of coarse contacts, *bending* their resistance to rotation; both are in `equilibrium/limits.py`.

{table(heads, lines)}"""
    return Report("coarse_part", rows, text, checks)


if __name__ == "__main__":
    raise SystemExit(main(produce, options(__doc__, list(SEEDS), [])))
