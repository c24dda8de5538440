"""Elastic specimens of several shapes against closed forms: a plate with a hole, a cylinder, an L-shaped frame.

Undamaged structures. The constants of the closed forms are those of the bulk that docs/elastic.md tells of; nothing is
fitted. Cases:
  kirsch    plate with a hole under the tractions of Kirsch's solution on its sides: stress of bodies, shape of the hole
  cylinder  clamped and pulled: E A / L
  frame     L-shaped, clamped at its foot, pushed at its tip: bending, shear and compression of beams
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Iterator
from itertools import pairwise, product
from statistics import mean
from typing import Any

from common import Check, Report, main, options, say, shown, table
from elastic_specimens import (
    ALPHA,
    DEPTH,
    L_F,
    PLATE,
    RINGS,
    THICK,
    E,
    axial_stiffness,
    beam_theory,
    cylinder,
    edge,
    frame,
    hoop_stress,
    plate,
    solved,
    system_of,
)
from fissura.case.macroscopic import macroscopic_elasticity

#: Radii of holes and diameters of cylinders, which are twice as long, in spacings.
HOLES, CYLINDERS = (4.0, 8.0, 12.0), (6.0, 10.0, 15.0)
#: Length of both legs of frames over their depth.
SLENDER = (5.0, 10.0, 20.0)

TEXT = """\
Contacts have `E` = 60 GPa and `alpha` = 0.29, so `E` = {modulus:.2f} GPa and ν = {poisson:.3f} in the bulk
([elastic.md](elastic.md)). Full resolution but for *graded* plates and cylinders, which are fine near the hole (within
two radii) or at half of the length, and four times coarser elsewhere, without calibration. Means over {seeds} seeds ±
standard deviation.
"""

KIRSCH = """\
A square plate, {plate:g} radii wide and {thick:g} `l_f` thick, has the tractions of Kirsch's solution for an infinite
plate on its four sides, so that the solution is exact at any distance. *Stress* is the hoop stress of bodies within 25°
of the equator, where it is largest, weighted by volume, over the remote stress; *Kirsch* is his field averaged over the
same bodies, sampled at points `l_f`/4 apart (at the edge itself it is 3). Rings are by the distance of nuclei from the
edge, in `l_f`. *Opening* is the lengthening of the diameter along the tension over `6 σ a/E`, *closing* the shortening
of the one across it over `2 σ a/E`, both fitted to the whole edge. Bodies at the edge carry 2 to 4 % more than they
should, as they do along every free surface ([elastic.md](elastic.md#the-surface-layer)); all others are right within
their scatter.
"""

OTHERS = """\
*Ends* is the stiffness between the mean displacements of whole ends over `E A / L`, or over that of beams; parts of the
outermost bodies are rigid, which makes cylinders `0.2 l_f / diameter` too stiff. *Inside* is from the strain of bodies
farther than a quarter of the length from both ends. Frames have legs of square section, {depth:g} `l_f` deep, bend and
shear. Their beams end where centre lines cross; what the corner does is in proportion to depth over length, so that the
ratio tends to 1 with the slenderness.
"""


def produce(found: argparse.Namespace) -> Report:
    """Solve all structures of all cases."""
    rows: list[dict[str, Any]] = []
    solve = {"kirsch": _plates, "cylinder": _cylinders, "frame": _frames}
    for name, seed in product(found.cases, found.seeds):
        say(f"{name}, seed {seed}")
        rows += [{"case": name, "seed": seed, **row} for row in solve[name](seed)]
    return Report("closed_forms", rows, _markdown(rows, len(found.seeds)), _checks(rows))


def _plates(seed: int) -> Iterator[dict[str, Any]]:
    for spacings, full in [*((size, False) for size in HOLES), (HOLES[0], True)]:
        case, load = plate(spacings, seed)
        system = system_of(case, full=full, load=load)
        u = solved(system)
        row = {"size": spacings, "full": full, "bodies": len(system.tessellation)}
        yield row | hoop_stress(system, u, spacings * L_F) | edge(case, system, u, spacings * L_F)


def _cylinders(seed: int) -> Iterator[dict[str, Any]]:
    for spacings, full in [*((size, True) for size in CYLINDERS), (CYLINDERS[-1], False)]:
        system = system_of(cylinder(spacings, seed), full=full)
        row = {"size": spacings, "full": full, "bodies": len(system.tessellation)}
        yield row | axial_stiffness(system, solved(system), spacings)


def _frames(seed: int) -> Iterator[dict[str, Any]]:
    for slender in SLENDER:
        system = system_of(frame(slender, seed), full=True)
        ratio = beam_theory(slender) / float(system.load @ solved(system))
        yield {"size": slender, "full": True, "bodies": len(system.tessellation), "ratio": ratio}


def _cells(rows: list[dict[str, Any]], key: str) -> list[float]:
    return [row[key] for row in rows]


def _groups(rows: list[dict[str, Any]], name: str) -> Iterable[tuple[tuple[float, bool], list[dict[str, Any]]]]:
    """Rows of a case by size and resolution."""
    own = [row for row in rows if row["case"] == name]
    for key in dict.fromkeys((row["size"], row["full"]) for row in own):
        yield key, [row for row in own if (row["size"], row["full"]) == key]


def _markdown(rows: list[dict[str, Any]], seeds: int) -> str:
    modulus, poisson = macroscopic_elasticity().macroscopic(E, ALPHA)
    names = {row["case"] for row in rows}
    parts = ["## Closed forms", TEXT.format(modulus=modulus / 1e9, poisson=poisson, seeds=seeds)]
    if "kirsch" in names:
        parts += ["### Plate with a hole\n", KIRSCH.format(plate=PLATE, thick=THICK), _holes(rows)]
    if names & {"cylinder", "frame"}:
        parts += ["\n### Cylinders and L-shaped frames\n", OTHERS.format(depth=DEPTH), _stiffness(rows)]
    return "\n".join(parts)


def _holes(rows: list[dict[str, Any]]) -> str:
    rings = [f"{a:g} to {b:g}" for a, b in pairwise(RINGS)]
    lines = []
    for (size, full), own in _groups(rows, "kirsch"):
        of = [f"{shown(_cells(own, f'stress {b:g}'), 2)}, {mean(_cells(own, f'kirsch {b:g}')):.2f}" for b in RINGS[1:]]
        edge = [shown(_cells(own, key), 3) for key in ("opening", "closing")]
        kind = f"{size:g}, {'full' if full else 'graded'}"
        lines.append([kind, f"{mean(_cells(own, 'bodies')):.0f}", *of, *edge])
    heads = ["radius / `l_f`", "bodies", *(f"stress, Kirsch: {ring}" for ring in rings), "opening", "closing"]
    return table(heads, lines)


def _stiffness(rows: list[dict[str, Any]]) -> str:
    lines = []
    for (size, full), own in _groups(rows, "cylinder"):
        name = f"cylinder, diameter {size:g} `l_f`, {'full' if full else 'graded'}"
        of = [shown(_cells(own, key), 3) for key in ("ends", "inside")]
        lines.append([name, f"{mean(_cells(own, 'bodies')):.0f}", *of])
    for (size, _), own in _groups(rows, "frame"):
        name = f"frame, legs {size:g} depths long"
        lines.append([name, f"{mean(_cells(own, 'bodies')):.0f}", shown(_cells(own, "ratio"), 3), "–"])
    return table(["specimen", "bodies", "ends", "inside"], lines)


def _checks(rows: list[dict[str, Any]]) -> list[Check]:
    checks = []
    for (size, full), own in _groups(rows, "kirsch"):
        first = f"{RINGS[1]:g}"
        off = mean(_cells(own, f"stress {first}")) / mean(_cells(own, f"kirsch {first}")) - 1.0
        name = f"hole of {size:g} l_f, {'full' if full else 'graded'}"
        checks.append(Check(f"{name}: stress at its edge off Kirsch's [%]", 100 * abs(off), 5.0))
    for (size, full), own in _groups(rows, "cylinder"):
        off = abs(mean(_cells(own, "inside")) - 1.0)
        name = f"cylinder of {size:g} l_f, {'full' if full else 'graded'}"
        checks.append(Check(f"{name}: stiffness inside off E A / L [%]", 100 * off, 2.0))
    for (size, _), own in _groups(rows, "frame"):
        if size == SLENDER[-1]:
            off = abs(mean(_cells(own, "ratio")) - 1.0)
            checks.append(Check(f"frame, legs {size:g} depths long: stiffness off beam theory [%]", 100 * off, 2.0))
    return checks


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["kirsch", "cylinder", "frame"], [1, 2, 3, 4, 5])))
