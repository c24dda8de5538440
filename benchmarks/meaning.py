"""What f_t and G_t of the contacts mean for the material as a whole: strength and dissipated energy of prisms.

Prisms without a notch are pulled apart at full resolution; their ends, half a width each, stay elastic. Strength is the
peak load over the section, energy what was dissipated until 5 per cent of the peak load are left, over the section.
Results depend on sizes in l_f and on the brittleness l_t / l_f, l_t = 2 E G_t / f_t^2, but not on units.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from common import Check, Report, main, measured, options, say, table
from fissura import Case
from fissura.case import case_from_dict

NAME = "src/fissura/elasticity/macroscopic_tension.csv"
HEAD = """\
# Strength over f_t, and dissipated energy over section and G_t, of prisms in direct tension: mean, standard deviation.
# width, length: of the part that may crack, in l_f; brittleness: l_t / l_f. Other ratios are the defaults (f_s = 3 f_t,
# f_c = 16 f_t, G_s = 16 G_t). Made by:
# python benchmarks/meaning.py --table src/fissura/elasticity/macroscopic_tension.csv
"""

L_F, F_T, MODULUS = 0.01, 2.2e6, 60e9
STOP = 0.05
BROKEN = 0.9


@dataclass(frozen=True)
class Group:
    """Prisms that differ in their seed only: sizes in l_f, brittleness l_t / l_f, alpha, number of seeds."""

    width: float = 6.0
    length: float = 12.0
    brittleness: float = 87.0
    alpha: float = 0.29
    seeds: int = 5


#: Groups by name; the first ones tell of size, the others of one number each at a width of 6 l_f.
GROUPS = {
    "width 4": Group(4.0, 8.0, seeds=10),
    "width 6": Group(seeds=10),
    "width 8": Group(8.0, 16.0),
    "twice as long": Group(length=24.0),
    "brittle": Group(brittleness=25.0),
    "tough": Group(brittleness=350.0),
    "alpha 0.15": Group(alpha=0.15),
    "alpha 0.5": Group(alpha=0.5),
}

TEXT = """\
Square prisms without a notch in direct tension at full resolution, the ends (half a width each) elastic; means ±
standard deviations of single prisms over the seeds. *Strength* is the peak load over the section. *Energy* is all that
was dissipated until {stop:.0%} of the peak load were left, over the section, and *past the peak* the part of it after
the peak. *Facets* is the area of all contacts with damage above {broken:g} at the end, over the section. Width and
length, of the part that may crack, are in `l_f`; `l_t = 2 E G_t/f_t²`. Contacts have the default ratios
(`f_s = 3 f_t`, `f_c = 16 f_t`, `G_s = 16 G_t`).
"""


def prism(group: Group, seed: int) -> Case:
    """A prism to be pulled apart."""
    width, free = group.width * L_F, group.length * L_F
    end = 0.5 * width
    G_t = group.brittleness * L_F * F_T**2 / (2.0 * MODULUS)
    length = free + 2.0 * end
    ends = [([0.0, 0.0, 0.0], [end, width, width]), ([length - end, 0.0, 0.0], [length, width, width])]
    return case_from_dict(
        {
            "name": "prism",
            "seed": seed,
            "specimen": {"size": [length, width, width]},
            "supports": [{"type": "clamp", "face": "left"}],
            "load": {"face": "right", "direction": [1, 0, 0]},
            "gauge": {"a": {"face": "top", "at": end}, "b": {"face": "top", "at": length - end}},
            "material": {
                "E": MODULUS,
                "alpha": group.alpha,
                "f_t": F_T,
                "G_t": G_t,
                "elastic": [{"type": "box", "lower": lower, "upper": upper} for lower, upper in ends],
            },
            "discretization": {"l_f": L_F, "l_c": 4.0 * L_F},
            "control": {"type": "dissipation", "target": 20.0 * G_t / F_T, "stop_load": STOP},
            "output": {"vtk": 0},
        }
    )


def broken(name: str, seed: int) -> dict[str, Any]:
    """Numbers of one prism."""
    group = GROUPS[name]
    case = prism(group, seed)
    run = measured(case, full=True)
    curve, last = run.result.curve, run.result.last
    section, G_t = case.specimen.size[1] * case.specimen.size[2], case.material.G_t
    peak, spent = int(np.argmax(curve["load_N"])), curve["dissipated_J"] / (section * G_t)
    row = {
        "case": name,
        "seed": seed,
        "finished": run.finished,
        "bodies": run.result.summary["bodies_full"],
        "strength": float(curve["load_N"][peak]) / (section * F_T),
        "energy": float(spent[-1]),
        "past_peak": float(spent[-1] - spent[peak]),
        "facets": float(last.tessellation.contacts.area[last.damage > BROKEN].sum()) / section,
        "cpu_s": run.cpu_s,
    }
    say(f"{name}, seed {seed}: strength {row['strength']:.3f}, energy {row['energy']:.2f}, {run.cpu_s:.0f} s")
    return row


def produce(found: argparse.Namespace) -> Report:
    """Break the prisms of all groups; those that stop early are left out and counted."""
    rows = [broken(name, seed) for name in found.cases for seed in range(1, GROUPS[name].seeds + 1)]
    lines, out = [], []
    for name in found.cases:
        group, good = GROUPS[name], [row for row in rows if row["case"] == name and row["finished"]]
        values = {key: np.array([row[key] for row in good]) for key in ("strength", "energy", "past_peak", "facets")}
        mean = {key: float(v.mean()) for key, v in values.items()}
        std = {key: float(v.std(ddof=1)) for key, v in values.items()}
        lines.append(
            [
                f"{group.width:g} x {group.length:g}",
                f"{group.brittleness:g}",
                f"{group.alpha:g}",
                f"{len(good)} of {group.seeds}",
                f"{mean['strength']:.3f} ± {std['strength']:.3f}",
                f"{mean['energy']:.2f} ± {std['energy']:.2f}",
                f"{mean['past_peak']:.2f} ± {std['past_peak']:.2f}",
                f"{mean['facets']:.2f}",
            ]
        )
        numbers = (mean["strength"], std["strength"], mean["energy"], std["energy"])
        head = f"{group.width:g},{group.length:g},{group.brittleness:g},{group.alpha:g},{len(good)}"
        out.append(head + "".join(f",{number:.4f}" for number in numbers))
    heads = [
        "width x length",
        "l_t / l_f",
        "alpha",
        "prisms",
        "strength / f_t",
        "energy / G_t",
        "past the peak",
        "facets",
    ]
    if found.table:
        columns = "width,length,brittleness,alpha,prisms,strength,strength_std,energy,energy_std"
        found.table.write_text("\n".join([HEAD + columns, *out]) + "\n", encoding="utf-8")
    text = f"### What f_t and G_t mean, measured\n\n{TEXT.format(stop=STOP, broken=BROKEN)}\n{table(heads, lines)}\n"
    stopped = sum(not row["finished"] for row in rows)
    return Report("meaning", rows, text, [Check("prisms that stopped early", stopped, 0.1 * len(rows))])


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--table", type=Path, metavar="PATH", help=f"write the table there, {NAME} for the package")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, list(GROUPS), [], more=_more)))
