"""Specimens of metres: how time, memory and bodies grow with the specimen, adaptive and at full resolution.

Half-notched beams in three-point bending, span 2.5 depths, of bodies of 10 mm. Cases:
  thin    depths of 100 to 1600 mm, 50 mm thick, adaptive and at full resolution
  solid   the same scaled in three dimensions: 50, 100 and 200 mm thick
  large   a depth of 3 m, 450 mm thick: ten million bodies at full resolution, which is not run

Every run is a process of its own, and its folder is kept: what is there is not run again.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from common import ROOT, Check, Report, main, options, say, table
from fissura import compare
from fissura.results.curve import read_curve
from metres_figure import figure
from validation.size_laws import notched

#: What is wanted: share of the time at full resolution at most, by depth [mm]; growth of time from 400 to 1600 mm; the
#: largest bound of the error [%]; memory [MB] and seconds at 1600 mm; the same of the largest beam.
SAVED = {400: 7.0, 800: 10.0, 1600: 18.0}
GROWTH, BOUND = 5.0, 1.0
LARGE_THIN = {"memory": 2000.0, "seconds": 300.0}
LARGEST = {"memory": 6000.0, "seconds": 1200.0}

#: Seconds on the clock after which a run is ended; what there is of it is compared.
LIMIT = 1320.0

#: How runs end that have something to compare.
ENDED = ("finished", "interrupted")


@dataclass(frozen=True)
class Beam:
    """Depth and thickness [mm]; how many specimens there are; whether they are run at full resolution, too."""

    family: str
    depth: int
    thickness: int
    specimens: int = 3
    full: bool = True

    @property
    def name(self) -> str:
        return f"beam_{self.depth}x{self.thickness}"

    @property
    def coarse(self) -> float:
        """Coarse spacing [mm]: a fifth of the depth, from 4 to 16 fine ones."""
        return min(max(self.depth / 5.0, 40.0), 160.0)

    @property
    def radius(self) -> float:
        """What is fine around critical bodies [mm]: more than by default where calibration is extrapolated."""
        return 70.0 if self.depth in (800, 1600) else 60.0

    @property
    def target(self) -> float:
        """Opening at which a run ends [mm], some past the peak: by linear fracture mechanics it goes with the root.

        The largest one ends as soon as its load falls, for its memory.
        """
        return 0.28 if self.depth == 3000 else float(0.09 * np.sqrt(self.depth / 200.0))

    @property
    def strength(self) -> float:
        """Nominal strength per load [Pa/N]: ``1.5 s / (t d^2)`` with the span s."""
        return 1.5 * 2.5 / (self.thickness * self.depth * 1e-6)

    def text(self) -> str:
        """The case file."""
        d = self.depth
        return f"""\
# Half-notched beam in three-point bending, depth {d} mm, thickness {self.thickness} mm, bodies of 10 mm.
specimen.size = ["{3.5 * d:g} mm", "{d} mm", "{self.thickness} mm"]
notch = {{ face = "bottom", position = "{1.75 * d:g} mm", depth = "{d / 2:g} mm" }}
supports = [
    {{ type = "pin", face = "bottom", at = "{d / 2:g} mm" }},
    {{ type = "roller", face = "bottom", at = "{3 * d:g} mm" }},
]
load = {{ face = "top", at = "{1.75 * d:g} mm" }}
gauge.a = {{ face = "bottom", at = "{1.75 * d - 5:g} mm" }}
gauge.b = {{ face = "bottom", at = "{1.75 * d + 5:g} mm" }}
material = {{ E = "60 GPa", alpha = 0.29, f_t = "2.2 MPa", G_t = "35 J/m^2" }}
discretization = {{ l_f = "10 mm", l_c = "{self.coarse:g} mm", placement = "blocks" }}
adaptivity = {{ coarse_part = "smooth", r_f = "{self.radius:g} mm" }}
control.target = "{self.target:.4g} mm"
output.vtk = 0
"""


FAMILIES = {
    "thin": [
        *(Beam("thin", depth, 50) for depth in (100, 200, 400)),
        Beam("thin", 800, 50, 1),
        Beam("thin", 1600, 50, 1),
    ],
    "solid": [Beam("solid", 100, 50), Beam("solid", 200, 100), Beam("solid", 400, 200, 1)],
    "large": [Beam("large", 3000, 450, 1, full=False)],
}


#: All depths [mm].
DEPTHS = sorted({beam.depth for family in FAMILIES.values() for beam in family})


def more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--depths", nargs="+", type=int, default=DEPTHS, metavar="MM", help="%(default)s")
    parser.add_argument("--keep", type=Path, default=ROOT / "results" / "metres", metavar="DIR", help="%(default)s")


def ran(beam: Beam, seed: int, keep: Path, *, full: bool) -> Path:
    """Folder of a run, which is made where it is not there."""
    folder = keep / f"{beam.name}_{seed}_{'full' if full else 'adaptive'}"
    told = folder / "summary.json"
    if told.exists() and json.loads(told.read_text())["status"] in ENDED:
        return folder
    case = keep / f"{beam.name}_{seed}.toml"
    case.parent.mkdir(parents=True, exist_ok=True)
    case.write_text(f"seed = {seed}\n{beam.text()}", encoding="utf-8")
    say(f"{folder.name}")
    words = ["run", str(case), "--output", str(folder), "--overwrite", *(["--full"] if full else [])]
    child = subprocess.Popen([sys.executable, "-m", "fissura", *words], stdout=subprocess.DEVNULL)
    try:
        child.wait(LIMIT)
    except subprocess.TimeoutExpired:
        child.terminate()  # what there is of the run is kept
        child.wait()
    if not told.exists() or json.loads(told.read_text())["status"] not in ENDED:
        raise SystemExit(f"{folder.name} has failed")
    return folder


def as_far_as_both(adaptive: Path, full: Path) -> dict[str, Any]:
    """Times of both runs as far as both go; a run at full resolution may have been ended by its limit."""
    curves = [read_curve(folder) for folder in (adaptive, full)]
    end = min(float(curve["gauge_m"][-1]) for curve in curves)
    out: dict[str, Any] = {"common_mm": 1e3 * end}
    for name, curve in zip(("adaptive", "full"), curves, strict=True):
        way = np.maximum.accumulate(curve["gauge_m"])
        for column in ("cpu_s", "wall_s"):
            out[f"{name}_{column}"] = float(np.interp(end, way, curve[column]))
    return out


def row_of(beam: Beam, seed: int, keep: Path) -> dict[str, Any]:
    """What an adaptive run took, and full resolution where it was run."""
    folders = {"adaptive": ran(beam, seed, keep, full=False)}
    if beam.full:
        folders["full"] = ran(beam, seed, keep, full=True)
    row: dict[str, Any] = {
        "family": beam.family,
        "name": beam.name,
        "depth": beam.depth,
        "thickness": beam.thickness,
        "seed": seed,
    }
    row["target_mm"] = beam.target
    for kind, folder in folders.items():
        told = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        row |= {
            f"{kind}_cpu_s": told["cpu_s"],
            f"{kind}_wall_s": told["wall_s"],
            f"{kind}_memory_MB": told["peak_memory_MB"],
            f"{kind}_bodies": told["bodies_end"],
            f"{kind}_steps": told["steps"],
            f"{kind}_iterations": told["linear_iterations"],
            f"{kind}_strength_MPa": told["peak_load_N"] * beam.strength / 1e6,
        }
        if kind == "adaptive":
            row |= {"bodies_start": told["bodies_start"], "bodies_full": told["bodies_full"]}
            row |= {"bound": 100.0 * told["load_error_bound"], "refinements": told["refinements"]}
    row |= {"whole_cpu_s": row["adaptive_cpu_s"], "whole_wall_s": row["adaptive_wall_s"]}
    if beam.full:
        row |= as_far_as_both(*folders.values())
        row["error"] = 100.0 * compare(folders["adaptive"], folders["full"]).max_load_difference
        row["saved"] = row["full_cpu_s"] / row["adaptive_cpu_s"]
        row["saved_wall"] = row["full_wall_s"] / row["adaptive_wall_s"]
    return row


def middle_of(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Medians over specimens of one size; the error of the worst."""
    out = {
        key: median(row[key] for row in rows) if isinstance(rows[0][key], (int, float)) else rows[0][key]
        for key in rows[0]
    }
    if "error" in out:
        out["worst"] = max(row["error"] for row in rows)
    return out | {"specimens": len(rows)}


def produce(found: argparse.Namespace) -> Report:
    beams = [beam for name in found.cases for beam in FAMILIES[name] if beam.depth in found.depths]
    each = [[row_of(beam, seed, found.keep) for seed in range(1, beam.specimens + 1)] for beam in beams]
    if found.depths != DEPTHS:
        return Report("metres", [row for rows in each for row in rows], "## A part of the beams", [])
    rows = [middle_of(rows) for rows in each]
    figure(rows, ROOT / "docs" / "images" / "metres.png")
    return Report("metres", rows, markdown(rows), checks(rows))


def law_of(rows: list[dict[str, Any]]) -> Any:
    """Bažant's law of the size effect, fitted to the beams that were run at full resolution, by adaptive strengths."""
    small = list({row["name"]: row for row in rows if row["family"] != "large"}.values())
    return notched([row["depth"] / 1e3 for row in small], [row["adaptive_strength_MPa"] * 1e6 for row in small])


def checks(rows: list[dict[str, Any]]) -> list[Check]:
    """The targets."""
    out = []
    thin = {row["depth"]: row for row in rows if row["family"] == "thin"}
    for depth, wanted in SAVED.items():
        if depth in thin:
            out.append(Check(f"{depth} mm: full over adaptive", thin[depth]["saved"], wanted, at_least=True))
    if 1600 in thin and 400 in thin:
        grown = thin[1600]["whole_cpu_s"] / thin[400]["whole_cpu_s"]
        out.append(Check("adaptive time, 1600 over 400 mm", grown, GROWTH))
        out.append(Check("1600 mm: memory [MB]", thin[1600]["adaptive_memory_MB"], LARGE_THIN["memory"]))
        out.append(Check("1600 mm: time on the clock [s]", thin[1600]["whole_wall_s"], LARGE_THIN["seconds"]))
    for row in {row["name"]: row for row in rows}.values():
        name = f"{row['depth']} mm, {row['thickness']} mm thick"
        out.append(Check(f"{name}: bound of the error [%]", row["bound"], BOUND))
        if "error" in row:
            out.append(Check(f"{name}: error [%]", row["worst"], BOUND))
        else:
            out.append(Check(f"{name}: memory [MB]", row["adaptive_memory_MB"], LARGEST["memory"]))
            out.append(Check(f"{name}: time on the clock [s]", row["whole_wall_s"], LARGEST["seconds"]))
    return out


def ended(rows: list[dict[str, Any]]) -> str:
    """Which runs did not come to their end, in words."""
    short = [row for row in rows if "common_mm" in row and row["common_mm"] < 0.98 * row["target_mm"]]
    each = [f"that of {row['depth']} mm went to an opening of {row['common_mm']:.3f} mm" for row in short]
    return "; ".join(each) or "none was"


def markdown(rows: list[dict[str, Any]]) -> str:
    heads = ["depth x thickness [mm]", "specimens", "bodies, start", "end", "full", "steps", "adaptive [s]", "full [s]"]
    heads += ["full over adaptive", "memory, adaptive [MB]", "full [MB]", "load error (worst) [%]", "bound [%]"]
    heads += ["strength [MPa]", "of the law [%]"]
    law = law_of(rows)
    lines = []
    for row in {row["name"]: row for row in rows}.values():
        fitted = law.first / np.sqrt(1.0 + row["depth"] / 1e3 / law.second) / 1e6
        full = "full_cpu_s" in row
        lines.append(
            [
                f"{row['depth']} x {row['thickness']}",
                f"{row['specimens']}",
                f"{row['bodies_start']:.0f}",
                f"{row['adaptive_bodies']:.0f}",
                f"{row['bodies_full']:.0f}",
                f"{row['adaptive_steps']:.0f}",
                f"{row['whole_cpu_s']:.1f} ({row['whole_wall_s']:.1f})",
                f"{row['full_cpu_s']:.0f} ({row['full_wall_s']:.0f})" if full else "not run",
                f"{row['saved']:.1f} ({row['saved_wall']:.1f})" if full else "",
                f"{row['adaptive_memory_MB']:.0f}",
                f"{row['full_memory_MB']:.0f}" if full else "",
                f"{row['error']:.2f} ({row['worst']:.2f})" if full else "",
                f"{row['bound']:.2f}",
                f"{row['adaptive_strength_MPa']:.3f}",
                f"{100.0 * (row['adaptive_strength_MPa'] / fitted - 1.0):+.1f}",
            ]
        )
    first, second = law.errors
    share = 3.0 / law.second / (1.0 + 3.0 / law.second)
    predicted = law.first / np.sqrt(1.0 + 3.0 / law.second)
    at_three = predicted, predicted * law.error(1.0, 0.5 * share)
    return f"""## How cost grows

Half-notched beams in three-point bending, bodies of 10 mm, `l_c` a fifth of the depth between 40 and 160 mm, a smooth
coarse part, nuclei in blocks; medians over specimens. Runs end at an opening of a quarter more than at the peak.
Processor time of the whole run without writing its files (time on the clock in brackets), one thread. Runs at full
resolution are ended after 22 minutes: {ended(rows)}. Times are compared as far
as both runs go.

{table(heads, lines)}

Bažant's law fitted to the strengths of all beams but the largest: `s_0` = {law.first / 1e6:.2f} ± {first / 1e6:.2f}
MPa, `d_0` = {1e3 * law.second:.0f} ± {1e3 * second:.0f} mm; the last column is how far a strength is from it. At 3 m it
gives {at_three[0] / 1e6:.3f} ± {at_three[1] / 1e6:.3f} MPa.

![Time, memory, bodies and strength over depth](images/metres.png)"""


if __name__ == "__main__":
    raise SystemExit(main(produce, options(__doc__, list(FAMILIES), [], more=more)))
