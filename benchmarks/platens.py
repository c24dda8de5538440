"""Platens: cubes pressed with and without friction, prisms pulled with and without hinges; identities, and pictures.

Options of its own: --picture FOLDER draws the pictures of docs/platens.md there.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from common import Check, Report, changed, example, main, middle, options, say, shown, table
from fissura import RunStopped, run
from fissura.pictures.curves import BLUE, INK, ORANGE, headline, tidy
from fissura.pictures.lettering import save
from specimens_figure import RESOLUTION, crack

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fissura import Result

FloatArray = NDArray[np.float64]

PRESSED, PULLED = ("compression_glued", "compression_frictionless"), ("tension_fixed", "tension_hinged")
#: Loaded area of each kind [m^2], without notches.
AREA = dict.fromkeys(PRESSED, 0.1 * 0.1) | dict.fromkeys(PULLED, 0.08 * 0.05)
NAMES = {
    "compression_glued": "pressed, glued",
    "compression_frictionless": "pressed, no friction",
    "tension_fixed": "pulled, fixed",
    "tension_hinged": "pulled, hinged",
}
COLOURS = {PRESSED[0]: BLUE, PRESSED[1]: ORANGE, PULLED[0]: BLUE, PULLED[1]: ORANGE}


@dataclass(frozen=True)
class Done:
    """A run and its processor time [s]."""

    result: Result
    cpu_s: float

    def column(self, name: str) -> FloatArray:
        """Column of the curve."""
        return np.asarray(self.result.curve[name], float)

    @property
    def peak(self) -> int:
        """Position of the largest load."""
        return int(np.abs(self.column("load_N")).argmax())

    @property
    def half(self) -> int:
        """Step after the peak at which half of the load is left, or less; the last one where there is none."""
        load, peak = np.abs(self.column("load_N")), self.peak
        found = np.flatnonzero(load[peak:] <= 0.5 * load[peak])
        return int(peak + found[0]) if len(found) else len(load) - 1


def done(name: str, seed: int) -> Done:
    """Run an example."""
    begun = time.process_time()
    try:
        result = run(changed(example(name, seed), output={"vtk": 0}))
    except RunStopped as error:
        say(f"  {name} stopped: {error}")
        result = error.result  # type: ignore[attr-defined]
    found = Done(result, time.process_time() - begun)
    say(f"{name}, seed {seed}: {found.cpu_s:.1f} s, peak {result.peak_load:.5g} N, {len(found.column('step'))} steps")
    return found


def row(name: str, seed: int, found: Done) -> dict[str, float | str]:
    """What is told of a run."""
    result, half = found.result, found.half
    load, work = found.column("load_N"), found.column("work_J")
    gap = found.column("stored_J") + found.column("dissipated_J") - work - found.column("exchanged_J")
    out: dict[str, float | str] = {
        "case": name,
        "seed": seed,
        "strength": result.peak_load / AREA[name] / 1e6,
        "at_peak": 1e3 * found.column("load_displacement_m")[found.peak],
        "left": abs(load[-1]) / result.peak_load,
        "dissipated": found.column("dissipated_J")[-1],
        "balance": float(np.abs(gap).max() / work.max()),
        "rest": float(found.column("unbalanced_N").max() / result.peak_load),
        "steps": len(load),
        "cpu_s": found.cpu_s,
        "bodies": int(found.column("bodies")[-1]),
    }
    if name in PULLED:
        both = np.array([found.column(f"gauge_{side}_m")[half] for side in ("left", "right")])
        out |= {"less": 1e6 * both.min(), "more": 1e6 * both.max()}
        moment = found.column("support_0_moment_z_Nm")
        out["arm"] = 1e3 * float(np.abs(moment).max() / result.peak_load)
    return out


def produce(found: argparse.Namespace) -> Report:
    """Run all examples with all seeds."""
    runs = {(name, seed): done(name, seed) for name in found.cases for seed in found.seeds}
    rows = [row(name, seed, of) for (name, seed), of in runs.items()]
    if found.picture is not None:
        drawn(found.picture, {name: of for (name, seed), of in runs.items() if seed == found.seeds[0]})

    def of(name: str) -> list[dict[str, float | str]]:
        return [r for r in rows if r["case"] == name]

    def told(name: str, key: str, digits: int) -> str:
        return shown([float(r[key]) for r in of(name)], digits) if key in of(name)[0] else "-"

    columns = [
        ("strength [MPa]", "strength", 2), ("displacement at the peak [mm]", "at_peak", 3),
        ("dissipated [J]", "dissipated", 2), ("openings at half of the load [µm], less", "less", 1),
        ("more", "more", 1), ("reaction off the axis [mm], most", "arm", 2),
    ]  # fmt: skip
    more = [
        ("load left at the end", "left", 2), ("steps", "steps", 0), ("bodies", "bodies", 0), ("CPU [s]", "cpu_s", 0),
    ]  # fmt: skip
    seeds = ", ".join(map(str, found.seeds))
    identities = [("balance", "balance"), ("rest", "rest")]
    text = "\n\n".join(
        [
            "## Measured",
            f"Adaptive runs of the four examples, seeds {seeds}: means, and standard deviations.",
            table(
                ["", *(c[0] for c in columns)],
                [[NAMES[n], *(told(n, *c[1:]) for c in columns)] for n in found.cases],
            ),
            "*Balance* is the largest difference of stored and dissipated energy from the work of the load, over the"
            " largest work; *rest* the largest force that load and reactions leave, over the peak load.",
            table(
                ["", *(c[0] for c in more), *(c[0] for c in identities)],
                [
                    [
                        NAMES[n],
                        *(told(n, *c[1:]) for c in more),
                        *(f"{max(float(r[key]) for r in of(n)):.0e}" for _, key in identities),
                    ]
                    for n in found.cases
                ],
            ),
        ]
    )
    checks = [
        Check("largest error of the balance of energy", max(float(r["balance"]) for r in rows), 1e-5),
        Check("largest force out of balance", max(float(r["rest"]) for r in rows), 1e-9),
    ]
    if set(PRESSED) <= set(found.cases):
        ratio = middle(of(PRESSED[0]), "strength") / middle(of(PRESSED[1]), "strength")
        checks.append(Check("strength glued over without friction", ratio, 1.1, at_least=True))
        checks.append(Check("load left of pressed cubes", max(float(r["left"]) for n in PRESSED for r in of(n)), 0.5))
    if set(PULLED) <= set(found.cases):
        ratio = min(float(r["less"]) / float(r["more"]) for r in of(PULLED[0]))
        checks.append(Check("smaller over larger opening, fixed", ratio, 0.7, at_least=True))
        ratio = max(float(r["less"]) / float(r["more"]) for r in of(PULLED[1]))
        checks.append(Check("smaller over larger opening, hinged", ratio, 0.3))
        checks.append(Check("moment of hinges, over the load [mm]", max(float(r["arm"]) for r in of(PULLED[1])), 1e-3))
    return Report("platens", rows, text, checks)


def curves(axes: Axes, runs: dict[str, Done], names: tuple[str, ...], title: str) -> None:
    """Loads over the displacement of the platen."""
    for name in names:
        x, y = (np.append(0.0, runs[name].column(key)) for key in ("load_displacement_m", "load_N"))
        axes.plot(1e3 * x, 1e-3 * y, color=COLOURS[name], linewidth=1.5, label=NAMES[name])
    axes.set_xlabel("displacement of the platen [mm]", color=INK)
    axes.set_ylabel("load [kN]", color=INK)
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)
    axes.legend(frameon=False, fontsize=8.5)
    tidy(axes)
    headline(axes, title, "")


def drawn(folder: Path, runs: dict[str, Done]) -> None:
    """Two pictures: curves, and cracks of both kinds of platens."""
    told = {
        PRESSED[0]: ("Glued", "cones below the platens stay whole"),
        PRESSED[1]: ("Without friction", "cracked from platen to platen"),
        PULLED[0]: ("Fixed", "both notches open alike"),
        PULLED[1]: ("Hinged", "one notch opens, the platen turns"),
    }
    for file, names, title in (
        ("platens_pressed.png", PRESSED, "Cubes pressed until half of the load is left"),
        ("platens_pulled.png", PULLED, "Notched prisms pulled"),
    ):
        figure = Figure(figsize=(10.0, 3.9), layout="constrained")
        first, second, third = figure.subplots(1, 3, width_ratios=(1.25, 1.0, 1.0))
        curves(first, runs, names, title)
        for axes, name in zip((second, third), names, strict=True):
            crack(axes, runs[name].result.last, *told[name], 0.03 if names is PRESSED else np.inf)
        save(figure, folder / file, RESOLUTION)
        say(f"written: {folder / file}")


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--picture", type=Path, metavar="FOLDER", help="draw the pictures there")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, (*PRESSED, *PULLED), (1, 2, 3), more=_more)))
