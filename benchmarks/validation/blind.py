"""Tests that are predicted before their measurement is looked at: docs/validation.md and its pictures.

An unnotched beam of the series whose notched beam was calibrated, a beam in mixed mode and wedge splitting. The
measured curves are not in this repository. Several realisations of the random structure each, adaptive; they are kept
in a folder, and what is there is not run again.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from statistics import mean
from typing import Any

import above  # noqa: F401
import numpy as np
from numpy.typing import NDArray
from predicted import LINE, MEAN, Predicted

from common import ROOT, Check, Report, example, main, options, shown, table
from fissura import Case
from fissura.elasticity.tension import macroscopic_tension
from fissura.pictures.curves import DPI, INK, headline, tidy
from fissura.pictures.lettering import save

FloatArray = NDArray[np.float64]

#: Mixed mode: strength [Pa] and fracture energy [J/m^2] of the concrete as published, and sizes of bodies [m].
MIXED = (3.5e6, 125.0)
SIZES = (6e-3, 8e-3)
#: Wedge splitting: pairs that are predicted, the middle one first.
WEDGE = ((2.5e6, 105.0), (2.0e6, 80.0), (2.0e6, 130.0), (3.0e6, 80.0), (3.0e6, 130.0))
#: Facets that are open wider are crack [m]; heights at which its place is told, and of the strips for it [m].
OPEN, HEIGHTS, STRIP = 10e-6, (0.03, 0.04, 0.05, 0.06, 0.07), 0.01


def concrete(case: Case, strength: float, energy: float, l_f: float | None = None) -> Case:
    """The case with contacts for a tensile strength [Pa] and a fracture energy [J/m^2] of the concrete."""
    l_f = case.discretization.l_f if l_f is None else l_f
    material = case.material
    f_t, G_t = macroscopic_tension().contact(strength, energy, material.E, material.alpha, l_f)
    return case.with_(
        {"material.f_t": f_t, "material.G_t": G_t, "discretization.l_f": l_f, "discretization.l_c": 4.0 * l_f}
    )


def produce(found: argparse.Namespace) -> Report:
    """Run what is asked for, draw it, and tell the numbers."""
    rows: list[dict[str, Any]] = []
    parts = [TITLE]
    checks: list[Check] = []
    for name in found.cases:
        section, predictions = SECTIONS[name](found)
        parts.append(section)
        rows += [
            {"case": one.name, "number": number, "peak_N": peak, "opening_m": at, "work_J_m2": work}
            for one in predictions
            for number, peak, at, work in zip(one.numbers, one.peaks, one.at_peaks, one.work, strict=True)
        ]
        checks += [
            Check(f"{one.name}: realisations that stopped", one.ensemble.plan.runs - len(one.numbers), 0)
            for one in predictions
        ]
    return Report("blind", rows, "\n\n".join(parts), checks)


#: What each section opens with.
OPENING = {
    "Grégoire's beam": (
        "**Fitted:** nothing here. **Predicted:** peak, curve and scatter, **blind**. **Case:** "
        "`gregoire_d50_unnotched.toml`. **Constants:** those that were fitted to the half-notched beam. "
        "**Seeds:** 10, other structures than those of the fit."
    ),
    "Mixed mode": (
        "**Fitted:** nothing. **Predicted:** peak, curve and path of the crack, **blind**. **Case:** "
        "`garcia_alvarez_mixed_mode.toml`. **Constants:** as published for the concrete, by the rule above. "
        "**Seeds:** 10, and 3 with larger bodies."
    ),
    "Wedge splitting": (
        "**Fitted:** nothing. **Predicted:** splitting force for a range of concretes, **blind**. **Case:** "
        "`wedge_splitting.toml`. **Constants:** `E` and ν as published, strength and fracture energy over a "
        "range, by the rule above. **Seeds:** 10 of the middle concrete, 3 of the others."
    ),
}

TITLE = """\
## Predicted: what was computed

Means ± standard deviations of single realisations of the random structure. *Work* is that of the load on the opening up
to the end of the range, over the ligament."""

HEADS = ["", "realisations", "peak [kN]", "opening at the peak [µm]", "first step [kN/mm]", "work [N/m]"]


def _told(values: list[float], unit: float, digits: int) -> str:
    """Mean and standard deviation in another unit."""
    return shown((unit * value for value in values), digits)


def _line(one: Predicted) -> list[str]:
    return [
        one.name,
        f"{len(one.numbers)}",
        _told(one.peaks, 1e-3, 2),
        _told(one.at_peaks, 1e6, 1),
        _told(one.stiffness, 1e-6, 0),
        _told(one.work, 1.0, 0),
    ]


def _curve(one: Predicted, openings: list[float]) -> list[str]:
    return [f"{one.name}: load [kN]", *(_told(one.loads_at(opening), 1e-3, 2) for opening in openings)]


def unnotched(found: argparse.Namespace) -> tuple[str, list[Predicted]]:
    """Grégoire's beam without a notch, over both lengths of the gauge."""
    case, about = example("gregoire_d50_unnotched", 1), {"ligament": 0.05 * 0.05, "until": 0.15e-3}
    folder = found.keep / "gregoire_d50_unnotched"
    short = Predicted.of("over 70 mm", case, found.runs, folder, **about)
    long = Predicted("over 100 mm", short.ensemble, gauge="gauge_over_100mm_m", **about)
    openings = [5e-6, 10e-6, 20e-6, 40e-6, 80e-6, 150e-6]
    strength = mean(1.5 * peak * 0.125 / (0.05 * 0.05**2) for peak in short.peaks)
    picture = _picture(
        "blind_gregoire", found, [short], "Beam without a notch", "over 70 mm; constants of the notched one"
    )
    text = [
        "### Grégoire's beam without a notch",
        OPENING["Grégoire's beam"],
        picture,
        table(HEADS, [_line(short), _line(long)]),
        table(["opening [µm]", *(f"{1e6 * u:g}" for u in openings)], [_curve(short, openings), _curve(long, openings)]),
        f"Bending strength by beam theory, `1.5 F L/(b d²)`, of the mean peak: {strength / 1e6:.2f} MPa.",
    ]
    return "\n\n".join(text), [short]


def mixed(found: argparse.Namespace) -> tuple[str, list[Predicted]]:
    """The beam of García-Álvarez, Gettu and Carol."""
    case, every = example("garcia_alvarez_mixed_mode", 1), []
    for k, l_f in enumerate(SIZES):
        folder = found.keep / f"garcia_alvarez_{1e3 * l_f:g}mm"
        runs = found.runs if k == 0 else found.fewer
        name = f"bodies of {1e3 * l_f:g} mm"
        about = {"ligament": 0.06 * 0.05, "until": 0.3e-3}
        every.append(Predicted.of(name, concrete(case, *MIXED, l_f), runs, folder, **about))
    openings = [10e-6, 20e-6, 50e-6, 100e-6, 200e-6, 300e-6]
    paths = [_path(every[0], number) for number in every[0].numbers]
    middle = np.nanmean(paths, axis=0)
    spread = np.nanstd(paths, axis=0, ddof=1) if len(paths) > 1 else np.zeros(len(HEIGHTS))
    places = [f"{1e3 * x:.0f} ± {1e3 * s:.0f}" for x, s in zip(middle, spread, strict=True)]
    rise = np.array(HEIGHTS) - 0.02
    angle = float(np.degrees(np.arctan2(*np.polyfit(rise, middle - 0.075, 1)[:1], 1.0)))
    text = [
        "### Mixed mode, García-Álvarez, Gettu and Carol",
        OPENING["Mixed mode"],
        _picture("blind_mixed", found, every[:1], "Notch beside the middle", "constants as published", paths=paths),
        table(HEADS, [_line(one) for one in every]),
        table(["opening [µm]", *(f"{1e6 * u:g}" for u in openings)], [_curve(one, openings) for one in every]),
        table(
            ["height above the lower face [mm]", *(f"{1e3 * y:g}" for y in HEIGHTS)],
            [["place of the crack, from the left end [mm]", *places]],
        ),
        f"The notch is at 75 mm and ends at a height of 20 mm, the load is at 125 mm. The mean path leans by"
        f" {angle:.0f}° from the vertical towards the load.",
    ]
    return "\n\n".join(text), every


def wedge(found: argparse.Namespace) -> tuple[str, list[Predicted]]:
    """The block, for the middle and the ends of what its concrete may be."""
    case, every = example("wedge_splitting", 1), []
    for k, (strength, energy) in enumerate(WEDGE):
        name = f"{strength / 1e6:g} MPa, {energy:g} N/m"
        runs = found.runs if k == 0 else found.fewer
        folder = found.keep / f"wedge_{strength / 1e6:g}_{energy:g}"
        about = {"ligament": 0.085 * 0.097, "until": 1e-3}
        every.append(Predicted.of(name, concrete(case, strength, energy), runs, folder, **about))
    openings = [0.05e-3, 0.1e-3, 0.2e-3, 0.4e-3, 0.7e-3, 1e-3]
    text = [
        "### Wedge splitting",
        OPENING["Wedge splitting"],
        _picture("blind_wedge", found, every, "Splitting force", "opening at the load line"),
        table(HEADS, [_line(one) for one in every]),
        table(["opening [µm]", *(f"{1e6 * u:g}" for u in openings)], [_curve(one, openings) for one in every]),
    ]
    return "\n\n".join(text), every


def _path(one: Predicted, number: int) -> FloatArray:
    """Places of the crack of a realisation at `HEIGHTS` [m], along the beam, weighted by opened volume."""
    last = one.ensemble.result(number).last
    opened = last.opening > OPEN
    centres = last.tessellation.contacts.centroid[opened]
    weight = (last.tessellation.contacts.area * last.opening)[opened]
    found = []
    for height in HEIGHTS:
        here = abs(centres[:, 1] - height) < 0.5 * STRIP
        found.append(np.average(centres[here, 0], weights=weight[here]) if here.any() else np.nan)
    return np.array(found)


def _picture(
    name: str,
    found: argparse.Namespace,
    predictions: list[Predicted],
    title: str,
    note: str,
    paths: list[FloatArray] | None = None,
) -> str:
    """Draw the curves, and cracks beside them where there are paths; returns Markdown that shows the picture."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0 if paths else 7.0, 4.2), layout="constrained")
    axes = figure.subplots(1, 2 if paths else 1, squeeze=False)[0]
    predictions[0].draw(axes[0], title, note if len(predictions) == 1 else f"{note}; thin: {predictions[0].name}")
    for one, style in zip(predictions[1:], ("--", "-.", ":", (0, (1, 3))), strict=False):
        axes[0].plot(1e6 * one.openings, one.loads.mean(axis=0) / 1e3, color=MEAN, linestyle=style, label=one.name)
    if len(predictions) > 1:
        axes[0].legend(frameon=False, fontsize=8)
    top = max(float(one.loads.mean(axis=0).max()) for one in predictions)
    axes[0].set_ylim(0.0, 1.1e-3 * max(top, *predictions[0].peaks))
    if paths:
        heights = 1e3 * np.array(HEIGHTS)
        for path in paths:
            axes[1].plot(1e3 * path, heights, color=LINE, linewidth=0.9)
        axes[1].plot(1e3 * np.nanmean(paths, axis=0), heights, color=MEAN, linewidth=2.0)
        axes[1].plot([0, 250, 250, 0, 0], [0, 0, 80, 80, 0], color=INK, linewidth=1.2)
        axes[1].plot([75, 75], [0, 20], color=INK, linewidth=2.5)
        axes[1].plot([125], [84], "v", color=INK)
        axes[1].plot([25, 225], [-4, -4], "^", color=INK)
        axes[1].set_aspect("equal")
        axes[1].set_xlabel("x [mm]", color=INK)
        axes[1].set_ylabel("y [mm]", color=INK)
        tidy(axes[1])
        headline(axes[1], "Crack", "middle of what is open, by realisation; their mean")
    save(figure, ROOT / "docs" / "images" / f"{name}.png", DPI)
    return f"![{title}](images/{name}.png)"


SECTIONS = {"unnotched": unnotched, "mixed": mixed, "wedge": wedge}


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--runs", type=int, default=10, metavar="N", help="realisations of the main predictions")
    parser.add_argument("--fewer", type=int, default=3, metavar="N", help="realisations of the variations")
    parser.add_argument("--keep", type=Path, default=ROOT / "results" / "validation", help="folder for the runs")


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, list(SECTIONS), [1], more=_more)))
