"""Cubes and prisms pressed between glued and frictionless platens, against the tensile strength: docs/validation.md.

The material of examples/compression_glued.toml; prisms are twice as high as wide. Only strength and the first cracks
count, so that runs end behind the peak. Runs are kept in a folder, and what is there is not run again.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from statistics import mean
from typing import Any

import above  # noqa: F401
import numpy as np

from common import ROOT, Check, Report, example, main, options, say, shown, table
from fissura import Case, run_ensemble
from meaning import Group, prism

#: Platens and height over width; the load is followed until this part of its peak is left.
PLATENS = {"glued": "compression_glued", "no friction": "compression_frictionless"}
HEIGHTS, WIDTH, STOP = (1, 2), 0.1, 0.8
#: Names of what is pressed: platens, and height over width.
CASES = {
    f"{'cube' if height == 1 else 'prism'}-{'glued' if platens == 'glued' else 'frictionless'}": (platens, height)
    for platens in PLATENS
    for height in HEIGHTS
}
#: Contacts with more damage are cracked [1]; layers at the platens are this thick [m].
CRACKED, LAYER = 0.9, 0.015
#: Facets with a smaller component of their normal along the load are within 30 degrees of it.
ALONG = 0.5


def pressed(platens: str, height: int) -> Case:
    """A cube or a prism between platens."""
    return example(PLATENS[platens], 1).with_(
        {
            "specimen.size": [WIDTH, height * WIDTH, WIDTH],
            "control.target": height * 0.3e-3,
            "control.stop_load": STOP,
        }
    )


def produce(found: argparse.Namespace) -> Report:
    """Press all specimens, pull prisms of the same material."""
    rows = []
    for name in found.cases:
        say(f"{name}: {found.runs} realisations")
        rows += _of(*CASES[name], found)
    folder = found.keep / "compression_pulled"
    group, of = Group(), prism(Group(), 1)
    material = pressed("glued", 1).material
    if (of.material.E, of.material.alpha, of.material.f_t) != (material.E, material.alpha, material.f_t):
        raise ValueError("prisms that are pulled are of another material")
    pulled = of.with_({"material.G_t": material.G_t, "control.stop_load": STOP})
    there = (folder / "ensemble.json").exists()
    ensemble = run_ensemble(pulled, found.runs, output=folder, companions="none", resume=there, seed=1)
    section = (group.width * pulled.discretization.l_f) ** 2
    tension = mean(ensemble.runs["peak_load_N"]) / section
    return Report("compression", rows, _markdown(rows, tension, pulled), _checks(rows, tension))


def _of(platens: str, height: int, found: argparse.Namespace) -> list[dict[str, Any]]:
    folder = found.keep / f"compression_{PLATENS[platens]}_{height}"
    there = (folder / "ensemble.json").exists()
    ensemble = run_ensemble(
        pressed(platens, height), found.runs, output=folder, companions="none", keep=True, resume=there, seed=1
    )
    rows = []
    for k, number in enumerate(ensemble.runs["number"]):
        if not (ensemble.runs["past_peak"][k] or ensemble.runs["status"][k] == "finished"):
            say(f"  realisation {number} has no peak")
            continue
        last = ensemble.result(int(number)).last
        contacts = last.tessellation.contacts
        cracked = last.damage > CRACKED
        y, area = contacts.centroid[:, 1], contacts.area
        top = height * WIDTH
        ends, middle = (y < LAYER) | (y > top - LAYER), abs(y - 0.5 * top) < 0.25 * top
        along = abs(contacts.normal[:, 1]) < ALONG
        rows.append(
            {
                "case": f"{platens}, {height}",
                "platens": platens,
                "height": height,
                "number": int(number),
                "strength_Pa": float(ensemble.runs["peak_load_N"][k]) / WIDTH**2,
                "along": float(area[cracked & along].sum() / area[cracked].sum()),
                "ends": float(area[cracked & ends].sum() / area[ends].sum()),
                "middle": float(area[cracked & middle].sum() / area[middle].sum()),
            }
        )
    return rows


def _mine(rows: list[dict[str, Any]], platens: str, height: int) -> list[dict[str, Any]]:
    return [row for row in rows if (row["platens"], row["height"]) == (platens, height)]


def _strength(rows: list[dict[str, Any]], platens: str, height: int) -> float:
    return mean(row["strength_Pa"] for row in _mine(rows, platens, height))


def _markdown(rows: list[dict[str, Any]], tension: float, pulled: Case) -> str:
    heads = [
        "platens", "height / width", "realisations", "strength [MPa]", "over tension", "facets along the load [%]",
        "cracked at the platens [%]", "in the middle [%]",
    ]  # fmt: skip
    lines = [
        [
            platens,
            f"{height}",
            f"{len(mine)}",
            shown((row["strength_Pa"] / 1e6 for row in mine), 1),
            f"{_strength(rows, platens, height) / tension:.1f}",
            *(shown((100 * row[key] for row in mine), 0) for key in ("along", "ends", "middle")),
        ]
        for platens in PLATENS
        for height in HEIGHTS
        if (mine := _mine(rows, platens, height))
    ]
    return "\n\n".join(
        [
            "### Compression: what was computed",
            f"Width {1e3 * WIDTH:g} mm, adaptive, until {100 * STOP:g} % of the peak are left. The same contacts have a"
            f" strength of {tension / 1e6:.2f} MPa in direct tension (prisms 60 mm wide; `f_t` of the contacts is"
            f" {pulled.material.f_t / 1e6:g} MPa). *Facets along the load*: of the area of cracked contacts (damage"
            f" above {CRACKED:g}), the part within 30° of the load's axis; it is half where cracks have no direction."
            f" *Cracked*: part of the area of all contacts, in layers of {1e3 * LAYER:g} mm at the platens and in the"
            " middle half of the height.",
            table(heads, lines),
        ]
    )


def _checks(rows: list[dict[str, Any]], tension: float) -> list[Check]:
    got = {name: _mine(rows, *of) for name, of in CASES.items() if _mine(rows, *of)}
    mean_of = {name: mean(row["strength_Pa"] for row in mine) for name, mine in got.items()}
    checks = [Check(f"{name}: realisations", len(mine), 3, at_least=True) for name, mine in got.items()]
    if {"cube-glued", "prism-glued"} <= got.keys():
        checks.append(Check("prism over cube, glued", mean_of["prism-glued"] / mean_of["cube-glued"], 0.95))
    if {"cube-frictionless", "prism-frictionless"} <= got.keys():
        ratio = mean_of["prism-frictionless"] / mean_of["cube-frictionless"]
        checks.append(Check("prism over cube without friction, off 1", abs(ratio - 1.0), 0.1))
    for name in [name for name in got if name.endswith("frictionless")]:
        checks.append(Check(f"{name} over tension, off 10", abs(mean_of[name] / tension - 10.0), 5.0))
        along = float(np.mean([row["along"] for row in got[name]]))
        checks.append(Check(f"{name}: part of facets along the load", along, 0.5, at_least=True))
    return checks


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--runs", type=int, default=3, metavar="N", help="realisations of each")
    parser.add_argument("--keep", type=Path, default=ROOT / "results" / "validation", help="folder for the runs")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, list(CASES), [1], more=_more)))
