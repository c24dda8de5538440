"""Winkler's L-shaped panel, predicted from the quoted constants of its concrete: docs/winkler.md and its picture.

Runs of examples/winkler_lpanel.toml with several seeds, adaptive; one of them at full resolution, too; and one seed
with each end of the quoted range of the fracture energy. Nothing is fitted.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from statistics import mean
from typing import Any

from common import Check, Report, Run, changed, difference, example, main, measured, options, say, shown, table
from fissura import Case
from fissura.elasticity.tension import macroscopic_tension
from fissura.results.compare import compare_results
from plane_stress import panel_stiffness
from winkler_curves import LIGAMENT, NAME, Curve, inclination
from winkler_figure import draw

#: The concrete as quoted: E [Pa], nu, strength [Pa]; fracture energies: both ends of what is quoted, and the example's.
MODULUS, POISSON, STRENGTH = 25.85e9, 0.18, 2.7e6
LOW, USED, HIGH = 65.0, 90.0, 130.0
#: Parts of the crack over which its inclination is fitted, by x [m]: at the corner, and farther on.
FIRST, LATER = (0.2, 0.25), (0.05, 0.15)

TEXT = """\
{seeds} seeds, adaptive. Differences are those of the mean from the measured mean curve; *curve* is the root mean square
difference of the mean curve to 1 mm, over the measured peak. *Work* is that of the load to 1 mm over the ligament of
{ligament:g} cm². *With the compliance* adds to all computed displacements what the measured panel yields more than the
computed one up to 4 kN, as if it came from the clamp and the set-up; that is a guess. Inclinations are those of lines
through the cracked facets against the horizontal, near the corner (x from 200 to 250 mm) and farther on (50 to 150 mm).

Plane-stress finite elements with the quoted `E` and a fixed foot have a stiffness of {elements:.1f} kN/mm, these runs
{stiffness:.1f} at their start.
"""


def contacts(energy: float, spacing: float) -> tuple[float, float]:
    """Contacts' `f_t` [Pa] and `G_t` [J/m^2] for the quoted strength and a fracture energy, by the table of prisms."""
    material = example(NAME, 1).material
    return macroscopic_tension().contact(STRENGTH, energy, material.E, material.alpha, spacing)


def produce(found: argparse.Namespace) -> Report:
    """Run all panels, draw them, and compare."""
    seeds = found.seeds
    runs = []
    for seed in seeds:
        say(f"seed {seed}")
        runs.append(measured(example(NAME, seed)))
    say("full resolution")
    case = example(NAME, seeds[0])
    full = measured(case, full=True)
    shorter = measured(changed(case, control={"max_step": 0.5 * case.control.max_step}), full=True)
    ends = {}
    for energy in (LOW, HIGH):
        say(f"{energy:g} N/m")
        ends[energy] = measured(_with(energy, seeds[0]))
    pair = difference(runs[0], full)
    pair["itself"] = 100 * compare_results(full.result, shorter.result).max_load_difference
    if found.picture:
        draw(runs, Curve.measured(), found.picture)
    rows = [_row(seed, USED, run) for seed, run in zip(seeds, runs, strict=True)]
    rows += [_row(seeds[0], energy, run) for energy, run in ends.items()]
    return Report("winkler", [*rows, {"case": "pair", **pair}], _markdown(rows, runs, pair), _checks(rows, pair))


def _with(energy: float, seed: int) -> Case:
    case = example(NAME, seed)
    f_t, G_t = contacts(energy, case.discretization.l_f)
    return changed(case, material={"f_t": f_t, "G_t": G_t})


def _row(seed: int, energy: float, run: Run) -> dict[str, Any]:
    curve = Curve.of(run)
    return {
        "case": NAME,
        "seed": seed,
        "energy": energy,
        "finished": run.finished,
        "peak": curve.peak,
        "at_peak": curve.at_peak,
        "stiffness": curve.stiffness,
        "start": run.result.initial_stiffness,
        "work": curve.work,
        "first": inclination(run, FIRST),
        "later": inclination(run, LATER),
        "f_t": run.result.case.material.f_t,
        "G_t": run.result.case.material.G_t,
        "bodies": run.result.summary["bodies_end"],
        "cpu_s": run.cpu_s,
    }


def _markdown(rows: list[dict[str, Any]], runs: list[Run], pair: dict[str, Any]) -> str:
    wanted, own = Curve.measured(), [row for row in rows if row["energy"] == USED]
    found = Curve.mean([Curve.of(run) for run in runs])
    spring = 1.0 / wanted.stiffness - 1.0 / mean(row["stiffness"] for row in own)
    yielding = found.yielding(spring)
    text = TEXT.format(
        seeds=len(runs),
        ligament=1e4 * LIGAMENT,
        elements=panel_stiffness(MODULUS, POISSON) / 1e6,
        stiffness=mean(row["start"] for row in own) / 1e6,
    )
    lines = [
        ["peak [kN]", *_values(own, "peak", 1e-3, wanted.peak, 2), ""],
        ["at [mm]", *_values(own, "at_peak", 1e3, wanted.at_peak, 3), _off(yielding.at_peak, wanted.at_peak)],
        ["secant to 4 kN [kN/mm]", *_values(own, "stiffness", 1e-6, wanted.stiffness, 1), "0 %"],
        ["work [N/m]", *_values(own, "work", 1.0, wanted.work, 0), _off(yielding.work, wanted.work)],
        ["curve", "", "", f"{100 * found.off(wanted):.0f} %", f"{100 * yielding.off(wanted):.0f} %"],
    ]
    heads = ["", "computed", "measured", "difference", "with the compliance"]
    parts = ["## How far off", text, table(heads, lines), "\n### Seeds and fracture energies\n"]
    heads = ["fracture energy [N/m]", "`f_t` [MPa], `G_t` [J/m²]", "seed", "peak [kN]", "at [mm]", "inclination [°]"]
    lines = [
        [
            f"{row['energy']:g}",
            f"{row['f_t'] / 1e6:.2f}, {row['G_t']:.0f}",
            f"{row['seed']}",
            f"{row['peak'] / 1e3:.2f}",
            f"{1e3 * row['at_peak']:.3f}",
            f"{row['first']:.0f}, then {row['later']:.0f}",
        ]
        for row in rows
    ]
    parts += [
        table(heads, lines),
        "",
        f"Adaptive against full resolution, seed {own[0]['seed']}: loads differ by at most",
    ]
    parts.append(f"{pair['load_difference']:.2f} % of the peak, peaks by {pair['peak_difference']:+.2f} %;")
    parts.append(
        f"full resolution with half the length of steps differs from it by {pair['itself']:.2f} %. The adaptive run"
    )
    parts.append(f"ends with {pair['bodies_end']} of {pair['bodies_full']} bodies.")
    return "\n".join(parts)


def _values(rows: list[dict[str, Any]], key: str, unit: float, wanted: float, digits: int) -> list[str]:
    values = [row[key] for row in rows]
    return [shown((unit * v for v in values), digits), f"{unit * wanted:.{digits}f}", _off(mean(values), wanted)]


def _off(value: float, wanted: float) -> str:
    return f"{value / wanted - 1.0:+.0%}".replace("%", " %")


def _checks(rows: list[dict[str, Any]], pair: dict[str, Any]) -> list[Check]:
    own = [row for row in rows if row["energy"] == USED]
    case = example(NAME, 1)
    f_t, G_t = contacts(USED, case.discretization.l_f)
    off = max(abs(case.material.f_t / f_t - 1.0), abs(case.material.G_t / G_t - 1.0))
    peak = mean(row["peak"] for row in own) / Curve.measured().peak - 1.0
    stiff = mean(row["start"] for row in own) / panel_stiffness(MODULUS, POISSON) - 1.0
    return [
        Check("contacts of the example off those of the table [%]", 100 * off, 1.0),
        Check("start stiffness off finite elements [%]", 100 * abs(stiff), 3.0),
        Check("mean peak off the measured one [%]", 100 * abs(peak), 20.0),
        Check("adaptive against full: load [% of the peak]", pair["load_difference"], 1.0),
        Check("crack is steeper at the corner, in all seeds [°]", min(r["first"] - r["later"] for r in own), 0.0, True),
    ]


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--picture", type=Path, metavar="PATH", help="draw curves and cracks there")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, [NAME], [1, 2, 3, 4, 5], more=_more)))
