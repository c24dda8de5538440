"""Which runs do not reach their end: many seeds of a very small beam, and random specimens, each for a few seconds.

A run is refused (its case, before the first step), stops (no equilibrium, or a calculation failed), or is cut off after
some processor time. `--runs` and `--specimens` say how many are tried, `--first` where to begin; each that does not
finish is named with what it says, and `--show N` prints the case of specimen N.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from common import Report, main, options, say, table
from fissura import Case, RunStopped, Simulation
from fissura.case import case_from_dict
from fissura.errors import InputError

#: Processor time after which a run is cut off [s].
LONGEST = 30.0

TEXT = """\
A beam of 100 x 40 x 20 mm, notched, with bodies of 8 mm and a coarse start, for many seeds; and specimens with random
shape, notch, supports, load, control, material, spacings and fields. Runs are refused, stop, or are cut off after 30 s
of processor time.
"""

MATERIAL = {"E": "60 GPa", "alpha": 0.29, "f_t": "2.2 MPa", "G_t": "35 J/m^2"}


def small_beam(seed: int) -> dict[str, Any]:
    """Data of the beam: about 200 bodies at full resolution."""
    return {
        "seed": seed,
        "specimen": {"size": ["100 mm", "40 mm", "20 mm"]},
        "notch": {"face": "bottom", "position": "50 mm", "depth": "12 mm"},
        "supports": [
            {"type": "pin", "face": "bottom", "at": "10 mm"},
            {"type": "roller", "face": "bottom", "at": "90 mm"},
        ],
        "load": {"face": "top", "at": "50 mm"},
        "gauge": {"a": {"face": "bottom", "at": "46 mm"}, "b": {"face": "bottom", "at": "54 mm"}},
        "material": MATERIAL,
        "discretization": {"l_f": "8 mm", "l_c": "20 mm"},
        "adaptivity": {"r_f": "16 mm"},
        "control": {"target": "0.05 mm"},
        "output": {"vtk": 0},
    }


def random_specimen(number: int) -> dict[str, Any]:
    """Data of a specimen that depends on its number alone: a few hundred bodies at most."""
    rng = np.random.default_rng(number)
    l_f = float(rng.choice([0.004, 0.008, 0.01]))
    length, depth, thickness = (float(n) * l_f for n in (rng.uniform(6, 16), rng.uniform(3, 7), rng.uniform(3, 5)))
    data: dict[str, Any] = {
        "seed": number,
        "specimen": {"size": [length, depth, thickness]},
        "material": {
            "E": "60 GPa",
            "alpha": float(rng.uniform(0.1, 0.6)),
            "f_t": float(rng.uniform(1e6, 4e6)),
            "G_t": float(10.0 ** rng.uniform(0.8, 2.0)),
        },
        "discretization": {"l_f": l_f, "l_c": l_f * float(rng.choice([1.0, 2.0, 4.0]))},
        "adaptivity": {"r_f": l_f * float(rng.uniform(2, 6)), "coarsen": bool(rng.random() < 0.3)},
        "output": {"vtk": 0},
    }
    middle = float(rng.uniform(0.4, 0.6)) * length
    notched = bool(rng.random() < 0.6)
    if notched:
        data["notch"] = {"face": "bottom", "position": middle, "depth": float(rng.uniform(0.1, 0.5)) * depth}
        if rng.random() < 0.4:
            data["notch"]["width"] = 0.3 * l_f
    _loaded(data, str(rng.choice(["bent", "pulled", "pressed"])), length)
    opening = min(0.1 * length, 2.0 * l_f) if notched else 0.3 * length
    data["gauge"] = {"a": {"face": "bottom", "at": middle - opening}, "b": {"face": "bottom", "at": middle + opening}}
    kind = str(rng.choice(["gauge", "displacement", "dissipation"]))
    if "clamp" in str(data["supports"]) and data["load"]["face"] == "top":
        kind = "displacement"  # a pressed block's lower face hardly opens
    if kind == "displacement":
        del data["gauge"]
    data["control"] = {"type": kind, "target": float(10.0 ** rng.uniform(-4.5, -3.5)), "stop_load": 0.1}
    if rng.random() < 0.3:
        data["field"] = {"length": float(rng.uniform(2, 8)) * l_f, "cov": 0.2}
    return data


def _loaded(data: dict[str, Any], how: str, length: float) -> None:
    """Supports and load."""
    if how == "bent":
        ends = ("pin", 0.1 * length), ("roller", 0.9 * length)
        data["supports"] = [{"type": kind, "face": "bottom", "at": place} for kind, place in ends]
        data["load"] = {"face": "top", "at": 0.5 * length}
    elif how == "pulled":
        data["supports"] = [{"type": "clamp", "face": "left"}]
        data["load"] = {"face": "right", "direction": [1, 0, 0]}
    else:
        data["supports"] = [{"type": "clamp", "face": "bottom"}]
        data["load"] = {"face": "top"}


@dataclass(frozen=True)
class Ending:
    """How a run ended: what it was, how, why, after how many steps, how much of its peak was left, and its time [s]."""

    name: str
    how: str
    why: str
    steps: int
    left: float
    cpu_s: float


def tried(name: str, data: dict[str, Any], longest: float) -> Ending:
    """Run a case as far as it goes."""
    began, loads, how, why = time.process_time(), [0.0], "finished", ""
    try:
        case: Case = case_from_dict(data)
        for step in Simulation(case).steps():
            loads.append(abs(step.load))
            if time.process_time() - began > longest:
                how, why = "cut off", f"at {step.controlled:.3g} m"
                break
    except InputError as error:
        how, why = "refused", str(error)
    except RunStopped as error:
        how, why = "stopped", str(error)
    ending = Ending(name, how, why, len(loads) - 1, loads[-1] / max(*loads, 1e-300), time.process_time() - began)
    if how != "finished":
        say(f"{name}: {how} after {ending.steps} steps with {ending.left:.0%} of its peak, {why}")
    return ending


def produce(found: argparse.Namespace) -> Report:
    if found.show is not None:
        say(json.dumps(random_specimen(found.show), indent=2))
        return Report("robustness", [], "## Runs that do not end\n\nNothing was run.")
    first = found.first
    beams = [tried(f"beam {n}", small_beam(n), LONGEST) for n in range(first, first + found.runs)]
    numbers = range(first, first + found.specimens)
    specimens = [tried(f"specimen {n}", random_specimen(n), LONGEST) for n in numbers]
    rows = [vars(ending) for ending in (*beams, *specimens)]
    return Report("robustness", rows, _markdown({"seeds of the beam": beams, "random specimens": specimens}))


def _markdown(groups: dict[str, list[Ending]]) -> str:
    kinds = ["finished", "refused", "stopped", "cut off"]
    lines = []
    for name, endings in groups.items():
        count = Counter(ending.how for ending in endings)
        seconds = sum(ending.cpu_s for ending in endings)
        lines.append([name, str(len(endings)), *(str(count[kind]) for kind in kinds), f"{seconds:.0f}"])
    others = [ending for endings in groups.values() for ending in endings if ending.how != "finished"]
    said = [f"* {e.name}, {e.how} after {e.steps} steps with {e.left:.0%} of its peak left: {e.why}" for e in others]
    parts = ["## Runs that do not end", TEXT, table(["", "runs", *kinds, "time [s]"], lines), "", *said]
    return "\n".join(parts)


def more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--runs", type=int, default=300, metavar="N", help="seeds of the small beam")
    parser.add_argument("--specimens", type=int, default=60, metavar="N", help="random specimens")
    parser.add_argument("--first", type=int, default=1, metavar="N", help="first seed and first specimen")
    parser.add_argument("--show", type=int, metavar="N", help="print the case of a random specimen, and run nothing")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, [], [], more=more)))
