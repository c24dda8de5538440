"""Loading programmes: the examples with several loads, stages, cycles and weight, their identities and what they show.

Options of its own: --pictures FOLDER draws the pictures of docs/loading.md there.
"""

from __future__ import annotations

import argparse
import sys
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from common import ROOT, Check, Report, main, options, say, table
from fissura import Case, Result, RunStopped, run
from fissura.case import case_from_dict
from fissura.simulation.step import Snapshot, Step
from loading_figures import draw

FloatArray = NDArray[np.float64]

#: Example, and what is changed in it, of each run.
RUNS: dict[str, tuple[str, dict[str, Any]]] = {
    "four-point bending": ("four_point_bending", {}),
    "four-point shear": ("four_point_shear", {}),
    "shear of 10 kN, then tension": ("nooru_mohamed", {}),
    "shear of 5 kN, then tension": ("nooru_mohamed", {"shear": "5 kN"}),
    "tension alone": ("nooru_mohamed", {"shear": None}),
    "cycles": ("beam_d100_cycles", {}),
    "the same, without cycles": ("beam_d100_cycles", {"to": ["10 um", "20 um", "35 um", "50 um", "70 um", "0.1 mm"]}),
    "load turned round, published law": ("beam_d100_cycles", {"to": ["50 um", "-50 % of load", "0.1 mm"]}),
    "load turned round, closing law": (
        "beam_d100_cycles",
        {"to": ["50 um", "-50 % of load", "0.1 mm"], "law": "cusatis-cedolin-closing"},
    ),
    "beam under its weight": ("long_beam_weight", {}),
    "the same without weight": ("long_beam_weight", {"weight": False}),
}

#: A crack begins within so much of the tip of its notch [m]; contacts count that have opened by this share of the most.
NEAR, OPEN = 0.03, 0.2

TEXT = """\
Adaptive runs, seed 1. *Peak* is the largest load factor of the last stage. *Balance* is the largest difference of
stored and dissipated energy from the work of all loads (with what refinements put in), over the largest work; *rest*
is the largest force that loads and reactions leave, over the largest sum of the loads.
"""


@dataclass(frozen=True)
class Done:
    """A run and what was seen of it.

    Attributes
    ----------
    result : Result
        The run.
    steps : list of Step
        Its steps; their snapshots are those of the peak and of the end only.
    at_peak : Snapshot
        State at the largest load of the last stage.
    cpu_s : float
        Processor time [s].
    """

    result: Result
    steps: list[Step]
    at_peak: Snapshot
    cpu_s: float

    def column(self, name: str) -> FloatArray:
        """Column of the curve."""
        return np.asarray(self.result.curve[name], float)

    @property
    def balance(self) -> float:
        """Largest error of the energies over the largest work."""
        gap = self.column("stored_J") + self.column("dissipated_J") - self.column("work_J") - self.column("exchanged_J")
        return float(np.abs(gap).max() / np.abs(self.column("work_J")).max())

    @property
    def rest(self) -> float:
        """Largest force out of balance over the largest sum of loads."""
        return float(self.column("unbalanced_N").max() / max(sum(map(abs, s.forces.values())) for s in self.steps))


def case_of(example: str, changes: dict[str, Any], seed: int) -> Case:
    """An example with changes."""
    data = tomllib.loads((ROOT / "examples" / f"{example}.toml").read_text(encoding="utf-8"))
    data |= {"name": example, "seed": seed}
    if "shear" in changes:
        data["stage"] = data["stage"][1:] if changes["shear"] is None else data["stage"]
        data["stage"][0] |= {"to": changes["shear"]} if changes["shear"] else {}
    if "to" in changes:
        data["stage"][0]["to"] = changes["to"]
    if "law" in changes:
        data["material"]["law"] = changes["law"]
    if not changes.get("weight", True):
        del data["gravity"]
    data["output"] = {"vtk": 0}
    return case_from_dict(data)


def done(name: str, seed: int, folder: Path) -> Done:
    """Run one."""
    steps: list[Step] = []
    most: list[tuple[float, Snapshot]] = []
    begun = time.process_time()

    def see(step: Step) -> None:
        steps.append(step)
        if not most or abs(step.load) > most[0][0]:
            most[:] = [(abs(step.load), step.snapshot)]

    try:
        result = run(case_of(*RUNS[name], seed), output=folder / name.replace(" ", "_"), on_step=see)
    except RunStopped as error:
        say(f"  {name} stopped: {error}")
        result = error.result  # type: ignore[attr-defined]
    found = Done(result, steps, most[0][1], time.process_time() - begun)
    say(f"{name}: {found.cpu_s:.1f} s, peak {result.peak_load:.5g} N")
    return found


def angle(snapshot: Snapshot, tip: tuple[float, float], along: int) -> float:
    """Inclination [degrees] against the plane of the notch of what has opened near its tip, seen along z.

    Parameters
    ----------
    snapshot : Snapshot
        A state.
    tip : (float, float)
        x and y of the tip [m].
    along : int
        Axis along which the notch is deep.
    """
    arm = snapshot.tessellation.contacts.centroid[:, :2] - tip
    near = np.linalg.norm(arm, axis=1) < NEAR
    weight = np.where(near, snapshot.opening * snapshot.tessellation.contacts.area, 0.0)
    weight[snapshot.opening < OPEN * snapshot.opening[near].max()] = 0.0
    across, ahead = (abs(float(weight @ arm[:, axis])) for axis in (1 - along, along))
    return float(np.degrees(np.arctan2(across, ahead)))


def findings(runs: dict[str, Done]) -> tuple[list[tuple[str, str]], list[Check]]:
    """What the runs show, in words, and what must hold of it."""
    shear, straight = runs["four-point shear"], runs["the same, without cycles"]
    lower, upper = shear.column("gauge_lower_m"), shear.column("gauge_upper_m")
    peak = int(np.abs(shear.result.load_values).argmax())
    ends = max(shear.result.last, shear.at_peak, key=lambda shot: float(shot.opening.max()))
    tips = {"lower": (0.22, 0.02), "upper": (0.22, 0.08)}
    winner = "lower" if lower[-1] > upper[-1] else "upper"
    rows = [
        (
            "four-point shear",
            f"at the peak the notches have opened by {1e6 * lower[peak]:.1f} and {1e6 * upper[peak]:.1f} µm (lower,"
            f" upper), at the end by {1e6 * lower[-1]:.0f} and {1e6 * upper[-1]:.1f} µm; the crack leaves the"
            f" {winner} notch at {angle(ends, tips[winner], 1):.0f}° to its plane",
        )
    ]
    for name in ("tension alone", "shear of 5 kN, then tension", "shear of 10 kN, then tension"):
        shot, found = runs[name].result.last, runs[name]
        angles = [angle(shot, tip, 0) for tip in ((0.025, 0.1), (0.175, 0.1))]
        text = f"cracks leave the notches at {angles[0]:.0f} and {angles[1]:.0f}° (left, right)"
        rows.append((name, f"peak {found.result.peak_load / 1e3:.1f} kN; {text}"))
    turns, slopes = cycles(runs["cycles"])
    cyclic, single = runs["cycles"].result, straight.result
    common = [(k, np.flatnonzero(single.gauge == g)) for k, g in enumerate(cyclic.gauge)]
    off = [abs(cyclic.load_values[k] - single.load_values[j[0]]) for k, j in common if len(j)]
    envelope = max(off) / single.peak_load
    text = f"after {turns} turns slopes of reloading are those of unloading to {slopes:.1e}; at the turns loads"
    rows.append(("cycles", f"{text} differ from those of a run without cycles by {100 * envelope:.2f} % of the peak"))
    for name in ("load turned round, published law", "load turned round, closing law"):
        load, gauge = runs[name].result.load_values, runs[name].result.gauge
        low, turn = int(load.argmin()), int(np.flatnonzero(gauge == 50e-6)[0])
        secant, back = load[turn] / gauge[turn], load[low] / gauge[low]
        text = f"at {load[low]:.0f} N the notch is {-1e6 * gauge[low]:.1f} µm closed; stiffness pressed over that of"
        rows.append((name, f"{text} unloading {back / secant:.2f}"))
    heavy, light = (runs[name].result.peak_load for name in ("beam under its weight", "the same without weight"))
    w, span, end = 2400.0 * 9.81 * 0.1 * 0.05, 1.0, 0.025
    equal = 4.0 / span * w * (span**2 / 8.0 - end**2 / 2.0)
    rows.append(
        (
            "beam under its weight",
            f"peak {heavy:.1f} N instead of {light:.1f} N: {light - heavy:.1f} N less, where a load of {equal:.1f} N"
            " has the moment of the weight in the middle",
        )
    )
    checks = [
        Check("reloading is as stiff as unloading", slopes, 1e-5),
        Check("loads at the turns against a run without cycles, of the peak", envelope, 0.01),
        Check("loss of the peak by weight against its moment", abs((light - heavy) / equal - 1.0), 0.05),
    ]
    return rows, checks


def cycles(found: Done) -> tuple[int, float]:
    """Number of turns under load, and largest relative difference of slopes just after a turn and before its return."""
    gauge, load, leads = found.result.gauge, found.result.load_values, found.result.curve["control"]
    worst, turns = 0.0, 0
    for k in range(1, len(gauge) - 1):
        if leads[k] != "force" or leads[k - 1] == "force":
            continue
        turns += 1
        top, slope = gauge[k - 1], load[k - 1] / gauge[k - 1]
        back = [j for j in range(k, len(gauge)) if gauge[j] < top and gauge[k:j].max(initial=0.0) < top]
        worst = max(worst, *(abs(load[j] / gauge[j] / slope - 1.0) for j in back))
    return turns, worst


def produce(found: argparse.Namespace) -> Report:
    """Run everything."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        runs = {name: done(name, found.seeds[0], folder) for name in found.cases}
        shown, checks = findings(runs)
        if found.pictures is not None:
            draw({name: one.result for name, one in runs.items()}, found.pictures)
    rows, lines = [], []
    for name, one in runs.items():
        s = one.result.summary
        row = {
            "run": name,
            "peak_N": one.result.peak_load,
            "dissipated_J": one.result.dissipated_energy,
            "steps": one.result.steps,
            "bodies": [s["bodies_start"], s["bodies_end"], s["bodies_full"]],
            "balance": one.balance,
            "rest": one.rest,
            "cpu_s": one.cpu_s,
            "status": s["status"],
        }
        rows.append(row)
        checks += [
            Check(f"energies of {name}, of the work", one.balance, 1e-5),
            Check(f"loads and reactions of {name}, of the loads", one.rest, 1e-9),
            Check(f"{name} runs to its end", float(s["status"] != "finished"), 0.0),
        ]
        lines.append(
            [
                name,
                f"{row['peak_N'] / 1e3:.3f}",
                f"{1e3 * row['dissipated_J']:.1f}",
                f"{row['steps']}",
                f"{s['bodies_start']} → {s['bodies_end']} of {s['bodies_full']}",
                f"{one.balance:.0e}",
                f"{one.rest:.0e}",
                f"{one.cpu_s:.0f}",
            ]
        )
    heads = ["run", "peak [kN]", "dissipated [mJ]", "steps", "bodies", "balance", "rest", "processor time [s]"]
    what = "\n".join(f"| {name} | {text} |" for name, text in shown)
    text = f"{TEXT}\n{table(heads, lines)}\n\n| run | what it shows |\n| --- | --- |\n{what}"
    return Report("loading", rows, f"### The examples, measured\n\n{text}\n", checks)


def more(parser: argparse.ArgumentParser) -> None:
    """Options of this script."""
    parser.add_argument("--pictures", type=Path, metavar="FOLDER", help="draw the pictures there")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, list(RUNS), [1], more=more)))
