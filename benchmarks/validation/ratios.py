"""Direct tension, splitting and bending strength of one material against the rules of codes: docs/validation.md.

The contacts are those that were fitted to Grégoire's half-notched beam, with bodies as large as its largest aggregate.
Nothing is fitted here. Variations of the fracture energy and of the size of bodies tell what the ratios depend on. Only
peaks count, so that runs end behind them. They are kept in a folder, and what is there is not run again.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from statistics import mean
from typing import Any

import above  # noqa: F401
import numpy as np
from ratios_cases import DEPTHS, FALL, L_F, SIDE, ZONES, Test, bent, pulled, split
from ratios_figure import draw, eurocode, model_code

from common import ROOT, Check, Report, main, options, say, shown, table
from fissura import run_ensemble
from fissura.case.macroscopic import macroscopic_elasticity
from fissura.elasticity.tension import macroscopic_tension
from fissura.results.curve import read_curve

#: Fracture energies over that of the material; finer bodies [m].
TOUGHNESS, FINE = (0.5, 1.0, 2.0), 0.005


def _runs(test: Test, toughness: float, l_f: float, runs: int, keep: Path) -> list[dict[str, Any]]:
    name = f"{test.name}, G_t x {toughness:g}, l_f {1e3 * l_f:g} mm"
    say(f"{name}: {runs} realisations")
    folder = keep / ("ratios_" + name.replace(", ", "_").replace(" ", "-"))
    there = (folder / "ensemble.json").exists()
    ensemble = run_ensemble(test.case, runs, output=folder, companions="none", resume=there, seed=1)
    rows = []
    for k in range(runs):
        past = bool(ensemble.runs["past_peak"][k] or ensemble.runs["status"][k] == "finished")
        strength = float("nan")
        if past:
            curve = read_curve(ensemble.place(int(ensemble.runs["number"][k])))
            strength = test.strength(curve["load_N"].astype(float))
        rows.append(
            {
                "case": test.name,
                "toughness": toughness,
                "l_f": l_f,
                "number": k,
                "strength_Pa": strength,
                "bodies": int(ensemble.runs["bodies_end"][k]),
                "cpu_s": float(ensemble.runs["cpu_s"][k]),
            }
        )
    return rows


def produce(found: argparse.Namespace) -> Report:
    """Run all specimens, draw, compare."""
    tests = [pulled(), *(bent(depth) for depth in DEPTHS), *(split(zone=zone) for zone in ZONES)]
    rows = [
        row
        for test in tests
        for row in _runs(test, 1.0, L_F, found.fewer if test is tests[len(DEPTHS)] else found.runs, found.keep)
    ]
    for toughness in TOUGHNESS:
        if toughness != 1.0 and "toughness" in found.cases:
            for test in (pulled(toughness), bent(DEPTHS[1], toughness), split(toughness, ZONES[1])):
                rows += _runs(test, toughness, L_F, found.fewer, found.keep)
    for test in (pulled(l_f=FINE), bent(DEPTHS[0], l_f=FINE)) if "bodies" in found.cases else ():
        rows += _runs(test, 1.0, FINE, found.fewer, found.keep)
    tension = _strength(rows, pulled().name)
    beams = {1e3 * depth: [s / tension for s in _good(rows, bent(depth).name)] for depth in DEPTHS}
    draw(beams, ROOT / "docs" / "images" / "validation_ratios.png")
    return Report("ratios", rows, _markdown(rows, found.cases), _checks(rows))


def _good(rows: list[dict[str, Any]], name: str, toughness: float = 1.0, l_f: float = L_F) -> list[float]:
    """Strengths [Pa] of the realisations that have one."""
    mine = [row for row in rows if (row["case"], row["toughness"], row["l_f"]) == (name, toughness, l_f)]
    return [row["strength_Pa"] for row in mine if np.isfinite(row["strength_Pa"])]


def _strength(rows: list[dict[str, Any]], name: str, toughness: float = 1.0, l_f: float = L_F) -> float:
    good = _good(rows, name, toughness, l_f)
    return mean(good) if good else float("nan")


def _ratio(value: float) -> str:
    return f"{value:.2f}" if np.isfinite(value) else "–"


def _line(rows: list[dict[str, Any]], name: str, rules: tuple[str, str] = ("", "")) -> list[str]:
    every = [row for row in rows if (row["case"], row["toughness"], row["l_f"]) == (name, 1.0, L_F)]
    good = _good(rows, name)
    told = shown((s / 1e6 for s in good), 2) if good else "–"
    return [
        name,
        f"{len(good)} of {len(every)}",
        told,
        _ratio(_strength(rows, name) / _strength(rows, pulled().name)),
        *rules,
        f"{mean(row['bodies'] for row in every):.0f}",
        f"{mean(row['cpu_s'] for row in every):.0f}",
    ]


def _varied(rows: list[dict[str, Any]], toughness: float) -> list[str]:
    material = pulled(toughness).case.material
    tension = _strength(rows, pulled().name, toughness)
    modulus, _ = macroscopic_elasticity().macroscopic(material.E, material.alpha)
    low, high = macroscopic_tension().energy(2.0 * material.E * material.G_t / (material.f_t**2 * L_F), material.alpha)
    energy = 0.5 * (low + high) * material.G_t
    depth = DEPTHS[1]
    cells = [
        f"{_ratio(_strength(rows, name, toughness) / tension)} ({len(_good(rows, name, toughness))})"
        for name in (bent(depth).name, split(zone=ZONES[1]).name)
    ]
    return [
        f"{material.G_t:g}",
        f"{tension / 1e6:.2f}",
        f"{energy:.0f}",
        f"{1e3 * modulus * energy / tension**2:.0f}",
        *cells,
    ]


def _markdown(rows: list[dict[str, Any]], cases: list[str]) -> str:
    material = pulled().case.material
    heads = [
        "test", "realisations", "strength [MPa]", "over direct tension", "EC2", "fib MC", "bodies", "time [s]",
    ]  # fmt: skip
    lines = [_line(rows, pulled().name)]
    lines += [
        _line(rows, bent(depth).name, (f"{eurocode(1e3 * depth):.2f}", f"{model_code(1e3 * depth):.2f}"))
        for depth in DEPTHS
    ]
    lines += [_line(rows, split(zone=zone).name, ("1.11", "1.00")) for zone in ZONES]
    parts = [
        "### Ratios: what was computed",
        f"Means ± standard deviations of single realisations, adaptive. `f_t` of the contacts is"
        f" {material.f_t / 1e6:g} MPa, `G_t` {material.G_t:g} J/m², `l_f` {1e3 * L_F:g} mm. All specimens are"
        f" {1e3 * SIDE:g} mm thick, prisms {1e3 * SIDE:g} mm wide; strengths are load over section, `F L/(b d²)` and"
        f" `2P/(πDL)`, the latter at the first peak that the load leaves by {100 * FALL:g} %. *Realisations* are those"
        " that have such a peak. *Elastic* is the depth of the zones under the strips that cannot crack.",
        "![Bending strength over direct tension](images/validation_ratios.png)",
        table(heads, lines),
    ]
    if "toughness" in cases:
        parts += _of_toughness(rows)
    if "bodies" in cases:
        parts.append(_of_bodies(rows))
    return "\n\n".join(parts)


def _of_toughness(rows: list[dict[str, Any]]) -> list[str]:
    heads = ["`G_t` [J/m²]", "`f_ct` [MPa]", "`G_F` [N/m]", "`l_ch` [mm]", "bending / tension"]
    heads.append(f"splitting / tension, elastic to {1e3 * ZONES[1]:g} mm")
    return [
        f"Other fracture energies, beams {1e3 * DEPTHS[1]:g} mm deep and discs; in brackets the number of"
        " realisations. `G_F` is the middle of what prisms of these contacts have, `l_ch = E G_F/f_ct²`.",
        table(heads, [_varied(rows, toughness) for toughness in TOUGHNESS]),
    ]


def _of_bodies(rows: list[dict[str, Any]]) -> str:
    names = (pulled().name, bent(DEPTHS[0]).name)
    (coarse, coarse_bent), (fine, fine_bent) = ([_strength(rows, n, l_f=l_f) for n in names] for l_f in (L_F, FINE))
    return (
        f"Bodies half as large ({1e3 * FINE:g} mm): direct tension {fine / 1e6:.2f} instead of {coarse / 1e6:.2f} MPa,"
        f" bending of beams {1e3 * DEPTHS[0]:g} mm deep {fine_bent / 1e6:.2f} instead of {coarse_bent / 1e6:.2f} MPa,"
        f" their ratio {fine_bent / fine:.2f} instead of {coarse_bent / coarse:.2f}."
    )


def _checks(rows: list[dict[str, Any]]) -> list[Check]:
    tension = _strength(rows, pulled().name)
    splitting = _strength(rows, split(zone=ZONES[1]).name) / tension
    checks = [
        Check("splitting over direct tension, small elastic zones", splitting, 1.2),
        Check("and at least", splitting, 1.0, at_least=True),
    ]
    for depth in DEPTHS:
        ratio = _strength(rows, bent(depth).name) / tension
        off = 100 * abs(ratio / model_code(1e3 * depth) - 1.0)
        checks.append(Check(f"{1e3 * depth:g} mm deep: bending over tension off the Model Code [%]", off, 20.0))
    return checks


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--runs", type=int, default=5, metavar="N", help="realisations of the main runs")
    parser.add_argument("--fewer", type=int, default=3, metavar="N", help="of the deepest beam and the variations")
    parser.add_argument("--keep", type=Path, default=ROOT / "results" / "validation", help="folder for the runs")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["codes", "toughness", "bodies"], [1], more=_more)))
