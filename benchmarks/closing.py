"""How far broken contacts overlap in compression, under the published law and under the one whose cracks close.

Cubes are pressed between whole faces at full resolution, until little of their largest load is left. Their outermost
layers, 0.8 l_f thick, stay elastic.
"""

from __future__ import annotations

import argparse
import sys
from typing import Any

from common import Report, main, options, say, table
from fissura import Case, RunStopped, run
from fissura.case import case_from_dict
from fissura.simulation.step import Step

L_F, WIDTH, LAYER = 0.01, 0.05, 0.008
BROKEN = 0.9
TARGET = 2e-4
LAWS = ("cusatis-cedolin", "cusatis-cedolin-closing")

TEXT = """\
Cubes of {width:g} `l_f` at full resolution, pressed by {target:g} mm between whole faces, the outermost {layer:g} `l_f`
elastic (`E` 60 GPa, `alpha` 0.29, `f_t` 2.2 MPa, `G_t` 35 J/m², `l_f` {l_f:g} mm). A contact overlaps where it is
pressed and its damage is above {broken:g}.
"""


def cube(seed: int, law: str) -> Case:
    """A cube to be pressed, under a law."""
    low, high = WIDTH - LAYER, LAYER
    return case_from_dict(
        {
            "name": "cube",
            "seed": seed,
            "specimen": {"size": [WIDTH, WIDTH, WIDTH]},
            "supports": [{"type": "clamp", "face": "bottom"}],
            "load": {"face": "top"},
            "material": {
                "law": law,
                "E": 60e9,
                "alpha": 0.29,
                "f_t": 2.2e6,
                "G_t": 35.0,
                "elastic": [
                    {"type": "box", "lower": [0, 0, 0], "upper": [WIDTH, high, WIDTH]},
                    {"type": "box", "lower": [0, low, 0], "upper": [WIDTH, WIDTH, WIDTH]},
                ],
            },
            "discretization": {"l_f": L_F, "l_c": 2.0 * L_F},
            "control": {"type": "displacement", "target": TARGET, "stop_load": 0.2},
            "output": {"vtk": 0},
        }
    )


def pressed(seed: int, law: str) -> dict[str, Any]:
    """Load and overlaps of one cube."""
    loads, overlaps, counts = [], [], []

    def see(step: Step) -> None:
        shot = step.snapshot
        closed = -shot.strain[:, 0] * shot.tessellation.contacts.length
        pressed = (shot.damage > BROKEN) & (closed > 0.0)
        loads.append(abs(step.load))
        overlaps.append(float(closed[pressed].max(initial=0.0)))
        counts.append(float(pressed.mean()))

    try:
        run(cube(seed, law), full=True, on_step=see)
    except RunStopped as error:
        say(f"  stopped: {error}")
    row = {
        "law": law,
        "seed": seed,
        "stress_MPa": max(loads) / WIDTH**2 / 1e6,
        "left": loads[-1] / max(loads),
        "overlap_m": max(overlaps),
        "overlapping": max(counts),
    }
    say(f"{law}, seed {seed}: {row}")
    return row


def produce(found: argparse.Namespace) -> Report:
    """Press all cubes."""
    rows = [pressed(seed, law) for law in LAWS for seed in found.seeds]
    lines = [
        [
            f"`{row['law']}`",
            f"{row['seed']}",
            f"{row['stress_MPa']:.0f}",
            f"{100 * row['left']:.0f}",
            f"{1e3 * row['overlap_m']:.3f}",
            f"{100 * row['overlapping']:.0f}",
        ]
        for row in rows
    ]
    heads = [
        "law",
        "seed",
        "largest load / section [MPa]",
        "left of it [%]",
        "overlap [mm]",
        "overlapping [% of contacts]",
    ]
    text = TEXT.format(width=WIDTH / L_F, target=1e3 * TARGET, layer=LAYER / L_F, l_f=1e3 * L_F, broken=BROKEN)
    return Report("closing", rows, f"### How far cracks overlap\n\n{text}\n{table(heads, lines)}\n")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, [], [1, 2, 3])))
