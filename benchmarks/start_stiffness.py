"""Initial stiffness of the adaptive start against full resolution, with and without elastic calibration."""

from __future__ import annotations

import argparse
import sys
from itertools import product
from typing import Any

from common import Check, Report, changed, example, main, middle, options, say, table, worst
from fissura import Case, Simulation

#: Coarse spacings in fine ones, and ramps r_c - r_f in coarse ones.
COARSE = (2.0, 3.0, 4.0)
RAMPS = (1.0, 2.0, 3.0)
#: Largest difference of a calibrated start [per cent].
LIMIT = 1.0

TEXT = """\
Load over gauge of the first elastic solution; difference from full resolution in per cent, median (largest size) over
the seeds. `r_f` is that of the case.
"""


def produce(found: argparse.Namespace) -> Report:
    rows: list[dict[str, Any]] = []
    for name, seed in product(found.cases, found.seeds):
        say(f"{name}, seed {seed}")
        case = example(name, seed)
        full, bodies = _start(case, full=True)
        for coarse, ramp, calibrate in product(COARSE, RAMPS, (False, True)):
            stiffness, start = _start(_with(case, coarse, ramp, calibrate=calibrate), full=False)
            row = {"case": name, "seed": seed, "l_c/l_f": coarse, "ramp/l_c": ramp, "calibrate": calibrate}
            row |= {"bodies_start": start, "bodies_full": bodies, "stiffness": stiffness, "stiffness_full": full}
            rows.append(row | {"difference": 100 * (stiffness / full - 1)})
    return Report("start_stiffness", rows, _markdown(rows), _checks(rows))


def _with(case: Case, coarse: float, ramp: float, *, calibrate: bool) -> Case:
    l_c = coarse * case.discretization.l_f
    adaptivity = {"r_c": case.adaptivity.r_f + ramp * l_c, "calibrate": calibrate}
    return changed(case, discretization={"l_c": l_c}, adaptivity=adaptivity)


def _start(case: Case, *, full: bool) -> tuple[float, int]:
    """Initial stiffness [N/m], known from the first step on, and bodies at the start."""
    simulation = Simulation(case, full=full)
    next(simulation.steps())
    return simulation.initial_stiffness, simulation.bodies_start


def _markdown(rows: list[dict[str, Any]]) -> str:
    parts = ["## Stiffness of the coarse start", TEXT]
    heads = ["l_c / l_f", "(r_c − r_f) / l_c", "bodies at start (full)", "as it is [%]", "calibrated [%]"]
    for name in dict.fromkeys(row["case"] for row in rows):
        lines = []
        for coarse, ramp in product(COARSE, RAMPS):
            chosen = [r for r in rows if (r["case"], r["l_c/l_f"], r["ramp/l_c"]) == (name, coarse, ramp)]
            bodies = f"{middle(chosen, 'bodies_start'):.0f} ({middle(chosen, 'bodies_full'):.0f})"
            differences = [_difference([r for r in chosen if r["calibrate"] is flag]) for flag in (False, True)]
            lines.append([f"{coarse:g}", f"{ramp:g}", bodies, *differences])
        parts += [f"### `{name}`, start\n", table(heads, lines), ""]
    return "\n".join(parts)


def _difference(rows: list[dict[str, Any]]) -> str:
    return f"{middle(rows, 'difference'):+.2f} ({worst(rows, 'difference'):.2f})"


def _checks(rows: list[dict[str, Any]]) -> list[Check]:
    calibrated = [row for row in rows if row["calibrate"]]
    return [Check("largest difference of a calibrated start [%]", worst(calibrated, "difference"), LIMIT)]


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["beam_d100"], [1, 2, 3, 4, 5])))
