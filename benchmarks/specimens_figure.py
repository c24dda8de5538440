"""Picture of docs/specimens.md: cracks of discs and a dog-bone, and the twisted crack of torsion."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from broken_specimens import BRITTLE, CRACKED, OPEN, disc, template
from common import ROOT, say
from fissura import run
from fissura.pictures.crack import HEAT
from fissura.pictures.curves import INK, headline, tidy
from fissura.pictures.lettering import save

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fissura.simulation.step import Snapshot

FloatArray = NDArray[np.float64]

#: Points per inch.
RESOLUTION = 95
#: Openings below this part of the largest one are not drawn.
SHOWN = 0.03


def corners_of(snapshot: Snapshot, chosen: NDArray[np.bool_]) -> tuple[list[FloatArray], NDArray[np.int64]]:
    """Corners (k, 3) of the polygons of chosen contacts [mm], and the contact of each; the widest come last."""
    polygons = snapshot.tessellation.contacts.polygons
    shown = np.flatnonzero(chosen[polygons.facet])
    shown = shown[np.argsort(snapshot.opening[polygons.facet[shown]], kind="stable")]
    return [1e3 * polygons.points[polygons.offsets[k] : polygons.offsets[k + 1]] for k in shown], polygons.facet[shown]


def crack(axes: Axes, snapshot: Snapshot, name: str, note: str, slab: float = np.inf) -> None:
    """Opened facets seen along z, in the outline of the specimen; only those in a slab about its middle, if wanted."""
    z = snapshot.tessellation.contacts.centroid[:, 2]
    ends = snapshot.tessellation.surface.centroid[:, 2]
    middle = 0.5 * (ends.max() + ends.min())
    opening = np.where(np.abs(z - middle) <= 0.5 * slab, snapshot.opening, 0.0)
    shapes, facet = corners_of(snapshot, opening > SHOWN * opening.max())
    colours = HEAT(opening[facet] / opening.max())
    flat = [shape[:, :2] for shape in shapes]
    axes.add_collection(PolyCollection(flat, facecolors=colours, edgecolors=colours, linewidths=0.3))
    surface = snapshot.tessellation.surface
    edge_on = np.flatnonzero(np.abs(surface.normal[surface.polygons.facet, 2]) < 0.1)
    points, offsets = 1e3 * surface.polygons.points[:, :2], surface.polygons.offsets
    for k in edge_on:
        axes.plot(*points[offsets[k] : offsets[k + 1]].T, color=INK, linewidth=1.0)
    axes.set_aspect("equal")
    axes.set_xlabel("x [mm]", color=INK)
    axes.set_ylabel("y [mm]", color=INK)
    tidy(axes)
    headline(axes, name, note)


def twisted(figure: Figure, axes: Axes, snapshot: Snapshot) -> None:
    """Cracked facets below the inclined notch, seen along its normal, coloured by their distance from its plane."""
    shapes, facet = corners_of(snapshot, (snapshot.damage > CRACKED) & (snapshot.opening > OPEN))
    at = 1e3 * snapshot.tessellation.contacts.centroid[facet] - [200.0, 0.0, 50.0]
    away = (at[:, 0] - at[:, 2]) / np.sqrt(2.0)
    norm = Normalize(-20.0, 20.0)
    seen = [np.column_stack([(s[:, 0] - 200.0 + s[:, 2] - 50.0) / np.sqrt(2.0), s[:, 1]]) for s in shapes]
    colours = colormaps["RdBu_r"](norm(away))
    axes.add_collection(PolyCollection(seen, facecolors=colours, edgecolors="white", linewidths=0.4))
    axes.plot([-70.7, 70.7], [50.0, 50.0], color=INK, linewidth=2.0)
    axes.plot([-70.7, 70.7], [0.0, 0.0], color=INK, linewidth=1.0)
    axes.set_aspect("equal")
    axes.set_xlim(-90, 90)
    axes.set_ylim(-5, 65)
    axes.set_xlabel("along the notch's front [mm]", color=INK)
    axes.set_ylabel("y [mm]", color=INK)
    tidy(axes)
    bar = figure.colorbar(ScalarMappable(norm, "RdBu_r"), ax=axes, fraction=0.03, pad=0.02)
    bar.set_label("from the notch's plane [mm]", color=INK)
    bar.outline.set_visible(False)
    headline(axes, "Torsion", "the crack below the notch, seen along the notch's normal: it is twisted")


def main() -> int:
    """Break four specimens and draw them."""
    parser = argparse.ArgumentParser(description=__doc__)
    place = ROOT / "docs" / "images" / "specimens_broken.png"
    parser.add_argument("--picture", type=Path, default=place, metavar="PATH")
    found = parser.parse_args()
    cases = {
        "disc": disc(1, BRITTLE),
        "hole": template("disc-with-hole", 1, control={"stop_load": 0.97}),
        "dog-bone": template("dog-bone", 1),
        "torsion": template("torsion", 2, control={"stop_load": 0.1}),
    }
    last = {}
    for name, case in cases.items():
        say(name)
        last[name] = run(case).last
    figure = Figure(figsize=(10.0, 8.4), layout="constrained")
    upper, lower = figure.subfigures(2, 1, height_ratios=(1.15, 1.0))
    first, second, third = upper.subplots(1, 3, width_ratios=(1.5, 1.5, 1.0))
    crack(first, last["disc"], "Brazilian disc", "splits along the loaded diameter")
    crack(second, last["hole"], "Disc with a hole", "cracks from the hole")
    crack(third, last["dog-bone"], "Dog-bone", "breaks in its neck")
    twisted(lower, lower.subplots(), last["torsion"])
    save(figure, found.picture, RESOLUTION)
    say(f"written: {found.picture}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
