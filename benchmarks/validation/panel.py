"""Winkler's L-shaped panel: what its peak depends on, one thing at a time. Peaks only: docs/winkler.md.

Runs end behind the peak. They are kept in a folder, and what is there is not run again.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from statistics import mean
from typing import Any

import above  # noqa: F401

from common import ROOT, Check, Report, example, main, options, say, shown, table
from fissura import Case, run_ensemble
from fissura.elasticity.tension import macroscopic_tension
from winkler import LOW, MODULUS, POISSON, STRENGTH, USED
from winkler_curves import NAME, Curve

#: Runs end when the load has fallen to this part of its peak.
STOP = 0.85
#: What is changed: E of the concrete [Pa], its fracture energy [N/m], size of bodies [m], part of the longest step.
TRIED: dict[str, tuple[float, float, float, float]] = {
    "the example": (MODULUS, USED, 0.012, 1.0),
    "bodies of 16 mm": (MODULUS, USED, 0.016, 1.0),
    "steps half as long": (MODULUS, USED, 0.012, 0.5),
    "`E` 17.8 GPa, with which the start is as measured": (17.8e9, USED, 0.012, 1.0),
    "fracture energy 65 N/m": (MODULUS, LOW, 0.012, 1.0),
}


def panel(modulus: float, energy: float, l_f: float, steps: float) -> Case:
    """The panel of another concrete, or with other bodies or steps; contacts are by the table of prisms."""
    case = example(NAME, 1)
    case = case.with_({"material.macro.E": modulus, "material.macro.nu": POISSON})
    f_t, G_t = macroscopic_tension().contact(STRENGTH, energy, case.material.E, case.material.alpha, l_f)
    return case.with_(
        {
            "material.f_t": f_t,
            "material.G_t": G_t,
            "discretization.l_f": l_f,
            "control.max_step": steps * case.control.max_step,
            "control.stop_load": STOP,
        }
    )


def produce(found: argparse.Namespace) -> Report:
    """Run all panels up to their peaks."""
    rows: list[dict[str, Any]] = []
    for k, name in enumerate(found.cases):
        say(f"{name}: {found.runs} realisations")
        case, folder = panel(*TRIED[name]), found.keep / f"panel_{list(TRIED).index(name)}"
        there = (folder / "ensemble.json").exists()
        ensemble = run_ensemble(case, found.runs, output=folder, companions="none", resume=there, seed=1)
        for number, peak, status in zip(
            ensemble.runs["number"], ensemble.runs["peak_load_N"], ensemble.runs["status"], strict=True
        ):
            rows.append(
                {
                    "case": name,
                    "tried": k,
                    "number": int(number),
                    "peak_N": float(peak),
                    "finished": bool(status == "finished"),
                    "f_t": case.material.f_t,
                    "G_t": case.material.G_t,
                }
            )
    return Report("panel", rows, _markdown(rows), _checks(rows))


def _mine(rows: list[dict[str, Any]], name: str) -> list[dict[str, Any]]:
    return [row for row in rows if row["case"] == name]


def _markdown(rows: list[dict[str, Any]]) -> str:
    wanted, lines = Curve.measured().peak, []
    for name in dict.fromkeys(row["case"] for row in rows):
        mine = _mine(rows, name)
        off = mean(row["peak_N"] for row in mine) / wanted - 1.0
        lines.append(
            [
                name,
                f"{mine[0]['f_t'] / 1e6:.2f}, {mine[0]['G_t']:.0f}",
                f"{len(mine)}",
                shown((row["peak_N"] / 1e3 for row in mine), 2),
                f"{off:+.0%}".replace("%", " %"),
            ]
        )
    heads = ["", "`f_t` [MPa], `G_t` [J/m²]", "realisations", "peak [kN]", "off the measured one"]
    return "\n\n".join(
        [
            "## What was tried for the peak",
            f"Peaks against the measured {wanted / 1e3:.2f} kN, adaptive; each line changes one thing. `f_t` and `G_t`"
            " follow from the concrete by the table of prisms every time.",
            table(heads, lines),
        ]
    )


def _checks(rows: list[dict[str, Any]]) -> list[Check]:
    return [Check("runs that stopped", sum(not row["finished"] for row in rows), 0)]


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--runs", type=int, default=2, metavar="N", help="realisations of each")
    parser.add_argument("--keep", type=Path, default=ROOT / "results" / "validation", help="folder for the runs")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, list(TRIED), [1], more=_more)))
