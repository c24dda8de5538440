"""Specimens of several kinds, broken: where the energy went, and what their cracks are like.

`specimens.py` measures with them.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from common import Run, changed, say
from fissura import Case, RunStopped, load_case, run
from fissura.simulation.step import Snapshot, Step
from meaning import F_T, L_F, MODULUS, Group, prism

FloatArray = NDArray[np.float64]

TEMPLATES = Path(str(files("fissura") / "templates"))
#: Fracture energies of discs [J/m^2]: that of the template, and one with which the load falls far when the disc splits.
TOUGH, BRITTLE = 12.0, 6.0
#: A peak is followed by a load lower by this share.
FALL = 0.03
#: Contacts with more damage are cracked [1]; twisted surfaces are fitted to those that are open wider [m].
CRACKED, OPEN = 0.9, 20e-6


def template(name: str, seed: int, **parts: Any) -> Case:
    """A case that ``fissura new`` prints, with other values."""
    return changed(load_case(TEMPLATES / f"{name}.toml"), seed=seed, output={"vtk": 0}, **parts)


def disc(seed: int, energy: float) -> Case:
    """The Brazilian test, until it has split; `energy` is the contacts' fracture energy [J/m^2]."""
    return template("brazilian", seed, material={"G_t": energy}, control={"stop_load": 0.9})


def pulled_prism(seed: int, energy: float) -> Case:
    """A prism as thick as the disc, of the same material, until just past its peak."""
    brittleness = 2.0 * MODULUS * energy / (F_T**2 * L_F)
    return changed(prism(Group(brittleness=brittleness), seed), control={"stop_load": 0.8})


@dataclass(frozen=True)
class Broken:
    """A run and where it dissipated energy.

    Attributes
    ----------
    run : Run
        What it left.
    places : (k, 3) array
        Centroids of facets, one for every step and contact that dissipated [m].
    spent : (k,) array
        Energies [J].
    first : (3,) array
        Centroid of the facet that was cracked first [m].
    """

    run: Run
    places: FloatArray
    spent: FloatArray
    first: FloatArray

    @property
    def load(self) -> FloatArray:
        return self.run.result.load_values

    @property
    def last(self) -> Snapshot:
        return self.run.result.last

    @property
    def first_peak(self) -> float:
        """Largest load before it falls for the first time, or of all if it never does [N]."""
        peaks = np.maximum.accumulate(self.load)
        fallen = np.flatnonzero(self.load < (1.0 - FALL) * peaks)
        return float(peaks[fallen[0]] if len(fallen) else peaks[-1])

    @property
    def fall(self) -> float:
        """Share of the first peak by which the load falls after it, before it rises above the peak if it ever does."""
        after = self.load[np.flatnonzero(self.load >= self.first_peak)[0] :]
        above = np.flatnonzero(after > self.first_peak)
        return 1.0 - float(after[: above[0] if len(above) else None].min()) / self.first_peak

    def share(self, chosen: Callable[[FloatArray], NDArray[np.bool_]]) -> float:
        """Share of the energy in places that a predicate of (k, 3) coordinates picks."""
        return float(self.spent[chosen(self.places)].sum() / self.spent.sum())

    @property
    def cracked(self) -> NDArray[np.bool_]:
        """Contacts of the last state that are cracked, (m,)."""
        return self.last.damage > CRACKED


def broken(case: Case, *, full: bool = False) -> Broken:
    """Break a specimen."""
    places, spent, first = [], [], []

    def look(step: Step) -> None:
        here, at = step.spent > 0.0, step.snapshot.tessellation.contacts.centroid
        places.append(at[here])
        spent.append(step.spent[here])
        worst = step.snapshot.damage.argmax()
        if not first and step.snapshot.damage[worst] > CRACKED:
            first.append(at[worst])

    cpu, wall, finished = time.process_time(), time.perf_counter(), True
    try:
        result = run(case, full=full, on_step=look)
    except RunStopped as error:
        say(f"  stopped: {error}")
        result, finished = error.result, False  # type: ignore[attr-defined]
    done = Run(result, finished, time.process_time() - cpu, time.perf_counter() - wall)
    return Broken(done, np.concatenate(places), np.concatenate(spent), first[0])


@dataclass(frozen=True)
class Twist:
    """Shape of the crack below an inclined notch, by least squares over the cracked area.

    The distance along x from the notch's plane is ``d (lean + rate q)`` at the depth ``d`` below the front of the notch
    and the coordinate ``q`` across the specimen.

    Attributes
    ----------
    angle : float
        Angle of the crack's trace in a horizontal plane to z, `depth` below the front [degrees]; 45 on the plane.
    near, far : float
        Distances from the notch's plane there, at both sides of the specimen [m].
    off, off_plane : float
        Root mean square distance of the crack from this surface, and from the notch's plane [m].
    """

    angle: float
    near: float
    far: float
    off: float
    off_plane: float


def twist(snapshot: Snapshot, depth: float = 0.045) -> Twist:
    """Fit the crack of the torsion template: notch through (200, 50, 50) mm along (1, 0, 1), 50 mm of ligament."""
    contacts = snapshot.tessellation.contacts
    opened = (snapshot.damage > CRACKED) & (snapshot.opening > OPEN)
    (x, y, z), weight = contacts.centroid[opened].T, contacts.area[opened]
    below, across = 0.05 - y, z - 0.05
    away = x - 0.2 - across
    terms, root = np.stack([below, across * below], axis=1), np.sqrt(weight)
    lean, rate = np.linalg.lstsq(terms * root[:, None], away * root)[0]
    rest = away - terms @ np.array([lean, rate])
    near, far = (depth * (lean + rate * side) for side in (-0.05, 0.05))
    angle = np.degrees(np.arctan(1.0 + rate * depth))
    off, off_plane = (float(np.sqrt(np.average(values**2, weights=weight))) for values in (rest, away))
    return Twist(float(angle), float(near), float(far), off, off_plane)
