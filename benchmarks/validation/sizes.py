"""Grégoire's series at all its sizes, with constants that were fitted to one beam of it: docs/validation.md.

Depths of 50 to 400 mm in the same proportions, thickness 50 mm, without a notch and with notches of a fifth and half of
the depth. Runs for the strength end behind the peak; laws of the size effect are fitted to them. Some notched beams run
on to the end of the tail, for the work of fracture. Runs are kept in a folder, and what is there is not run again.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path
from typing import Any

import above  # noqa: F401
import numpy as np
import size_laws
from size_beams import DEPTHS, NOTCHES, PRISM, SPAN, THICKNESS, WORK, WORK_RUNS, beam, realisations
from size_tables import markdown, picture, series, whole_modulus

from common import ROOT, Check, Report, main, options, say
from fissura import Case, load_case, run_ensemble
from fissura.results.curve import read_curve

CASES = ("strength", "work")


def produce(found: argparse.Namespace) -> Report:
    """Run all beams, fit the laws, draw."""
    fitted = load_case(ROOT / "examples" / "gregoire_d50_halfnotch.toml")
    keep = found.keep
    rows: list[dict[str, Any]] = []
    for depth in found.depths if "strength" in found.cases else []:
        for notch in found.notches:
            runs = 0 if found.kept else realisations(depth, notch)
            rows += _computed("strength", depth, notch, fitted, runs, keep)
    for depth, notch in WORK if "work" in found.cases else []:
        if depth in found.depths and notch in found.notches:
            rows += _computed("work", depth, notch, fitted, 0 if found.kept else WORK_RUNS, keep)
    whole = (found.cases, found.depths, found.notches) == (list(CASES), list(DEPTHS), list(NOTCHES))
    if not whole:
        return Report("sizes", rows, "## Sizes: a part of what was computed", [])
    picture(rows, ROOT / "docs" / "images" / "validation_sizes.png")
    return Report("sizes", rows, markdown(rows, fitted), _checks(rows, fitted))


def _computed(kind: str, depth: int, notch: float, fitted: Case, runs: int, keep: Path) -> list[dict[str, Any]]:
    """Rows of the realisations of one beam that finished; `runs` 0: of those in the folder, however many."""
    case = beam(depth / 1e3, notch, fitted, tail=kind == "work")
    folder = keep / f"size_{kind}_{depth}_{notch:g}"
    say(f"{kind}, {case.name}" + (f": {runs} realisations" if runs else ""))
    if runs:
        there = (folder / "ensemble.json").exists()
        run_ensemble(case, runs, output=folder, companions="none", resume=there, seed=depth)
    rows, stopped = [], 0
    for file in sorted(folder.glob("runs/*/summary.json")):
        place, told = file.parent, json.loads(file.read_text(encoding="utf-8"))
        if told["status"] != "finished":
            stopped += 1
            continue
        curve = read_curve(place)
        peak, ligament = float(told["peak_load_N"]), (1.0 - notch) * THICKNESS * depth / 1e3
        load, spent = curve["load_N"].astype(float), curve["dissipated_J"].astype(float)
        left, at = float(load[-1]), float(curve["load_displacement_m"][-1])
        behind = np.flatnonzero((np.arange(len(load)) > load.argmax()) & (load <= PRISM * peak))
        rows.append(
            {
                "case": case.name,
                "kind": kind,
                "depth": depth,
                "notch": notch,
                "number": int(place.name),
                "peak_N": peak,
                "strength_Pa": 1.5 * peak * SPAN / (THICKNESS * depth / 1e3),
                "left": left / peak,
                "work_J_m2": float(told["work_J"]) / ligament,
                "spent_J_m2": float(spent[behind[0]]) / ligament if len(behind) else math.nan,
                "tail_J_m2": left * at / ligament,
                "torn": sum("torn out" in warning for warning in told["warnings"]),
                "jumps": sum("damage jumped" in warning for warning in told["warnings"]),
                "bodies_end": int(told["bodies_end"]),
                "bodies_full": int(told["bodies_full"]),
                "cpu_s": float(told["cpu_s"]),
            }
        )
    return [row | {"stopped": stopped} for row in rows]


def _checks(rows: list[dict[str, Any]], fitted: Case) -> list[Check]:
    modulus = whole_modulus(fitted)
    laws = {notch: size_laws.notched(*series(rows, notch)[1:]) for notch in NOTCHES[1:]}
    energies = [size_laws.fracture_energy(law, notch, modulus) for notch, law in laws.items()]
    apart = abs(energies[0][0] - energies[1][0]) / float(np.hypot(energies[0][1], energies[1][1]))
    return [
        Check("realisations of one kind that stopped", max(row["stopped"] for row in rows), 0),
        Check("realisations torn at a support or the load", sum(row["torn"] for row in rows), 0),
        *(Check(f"R² of the law, notch {notch:g}", law.r2, 0.9, at_least=True) for notch, law in laws.items()),
        Check("G_f of both notches, difference in standard errors", apart, 3.0),
    ]


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--depths", nargs="+", type=int, default=list(DEPTHS), metavar="MM", help="%(default)s")
    parser.add_argument("--notches", nargs="+", type=float, default=list(NOTCHES), metavar="PART", help="%(default)s")
    parser.add_argument("--keep", type=Path, default=ROOT / "results" / "validation", help="folder for the runs")
    parser.add_argument("--kept", action="store_true", help="take what the folder holds, run nothing")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, list(CASES), [1], more=_more)))
