"""Supports, loads and gauges of a case, placed on its specimen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fissura.arrays import FloatArray
from fissura.case import Case, Load, LoadingStage
from fissura.case.platen import Platen as PlatenPart
from fissura.case.programme import GRAVITY
from fissura.case.registry import SUPPORTS
from fissura.errors import InputError
from fissura.specimen.domain import Domain
from fissura.specimen.functional import Functional, mean_displacement, mean_rotation
from fissura.specimen.gauge_kinds import gauge_from_part
from fissura.specimen.place import Place, place_from_part
from fissura.specimen.surface_part import SurfacePart


@dataclass(frozen=True)
class Held:
    """A support as a whole, or what guides the platen of a load.

    Attributes
    ----------
    middle : (3,) array
        Centroid of its place [m].
    functionals : int
        How many functionals it has.
    name : str
        Its name in results.
    """

    middle: FloatArray
    functionals: int
    name: str = "support_0"


@dataclass(frozen=True)
class Platen:
    """A rigid body on a part of the surface.

    Attributes
    ----------
    key : str
        Where the case has it.
    parts : tuple of SurfacePart
        What it covers.
    middle : (3,) array
        Its centroid [m].
    contact : str
        "glued" or "frictionless".
    """

    key: str
    parts: tuple[SurfacePart, ...]
    middle: FloatArray
    contact: str


@dataclass(frozen=True)
class Weight:
    """The weight of the specimen: a load that acts on all of its volume.

    Attributes
    ----------
    direction : (3,) array
        Unit vector.
    size : float
        Force [N].
    """

    direction: FloatArray
    size: float


@dataclass(frozen=True)
class Drive:
    """What a stage drives, and what it controls.

    Attributes
    ----------
    ratios : (L,) array
        Force of every load per unit of the load factor.
    quantity : str
        "gauge", "displacement" of the loads, or "force", the load factor itself.
    gauge : int or None
        Which gauge, where one is controlled or watched.
    """

    ratios: FloatArray
    quantity: str
    gauge: int | None


@dataclass(frozen=True)
class Conditions:
    """Boundary conditions and measurements of a test.

    Attributes
    ----------
    supports : tuple of Functional
        Each is held at zero; those of the first support come first.
    loads : tuple of Functional
        Distributions of unit loads; as functionals, mean displacements along the loads. The weight is not among them.
    load_names, load_keys : tuple of str
        Names of all L loads, the weight last, and where the case has them.
    gauges : tuple of Functional
        Gauges.
    gauge_names, gauge_keys : tuple of str
        Their names, and where the case has them.
    drives : tuple of Drive
        What each stage drives.
    held : tuple of Held
        The supports, to whom `supports` belong in this order.
    pulls : bool
        Whether the load of the last stage points out of the specimen.
    weight : Weight or None
        The weight, where there is gravity.
    platens : tuple of Platen
        Platens on which supports and loads act.
    """

    supports: tuple[Functional, ...]
    loads: tuple[Functional, ...]
    load_names: tuple[str, ...]
    load_keys: tuple[str, ...]
    gauges: tuple[Functional, ...]
    gauge_names: tuple[str, ...]
    gauge_keys: tuple[str, ...]
    drives: tuple[Drive, ...]
    held: tuple[Held, ...] = ()
    pulls: bool = False
    weight: Weight | None = None
    platens: tuple[Platen, ...] = ()

    @classmethod
    def single(cls, supports: tuple[Functional, ...], load: Functional) -> Conditions:
        """A single load, whose displacement is controlled."""
        drive = Drive(np.ones(1), "displacement", None)
        return cls(supports, (load,), ("load",), ("load",), (), (), (), (drive,))

    @property
    def main(self) -> Drive:
        """What the last stage drives; where it controls the load factor, with the quantity that it is told over."""
        last = self.drives[-1]
        if last.quantity != "force":
            return last
        return replace(last, quantity="displacement" if last.gauge is None else "gauge")

    @property
    def points(self) -> FloatArray:
        """Points at which supports, loads and gauges are, shape (p, 3) [m]."""
        found = [functional.points for functional in (*self.supports, *self.loads, *self.gauges)]
        return np.unique(np.concatenate([np.empty((0, 3)), *found]), axis=0)

    @property
    def middle(self) -> FloatArray:
        """Point about which moments are told, shape (3,) [m]: the middle of the first load of the last stage.

        The first support's where that is the weight.
        """
        driven = [k for k in np.flatnonzero(self.main.ratios) if k < len(self.loads)]
        return self.loads[driven[0]].middle if driven else self.held[0].middle


def _check_stability(supports: list[Functional], centre: FloatArray, size: float) -> None:
    """The supports, and what guides platens, must stop all six rigid motions."""
    rows = np.empty((len(supports), 6))
    for row, f in zip(rows, supports, strict=True):
        row[:3] = f.coefficients.sum(axis=0)
        row[3:] = np.cross((f.points - centre) / size, f.coefficients).sum(axis=0)
    rows = rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-300)
    singular = np.linalg.svd(rows, compute_uv=False)
    if len(singular) < 6 or singular[-1] < 1e-6:
        held = int(np.sum(singular > 1e-6))
        raise InputError(
            "supports",
            f"they hold {held} of the 6 rigid motions of the specimen",
            "a pin and a roller apart from it, or a clamp",
        )


def conditions_from_case(case: Case, domain: Domain) -> Conditions:
    """Place supports, loads and gauges of a case on its specimen.

    Raises
    ------
    InputError
        A place off the surface, an unknown kind of support, supports that leave the specimen movable.
    """
    l_f = case.discretization.l_f
    supports: list[Functional] = []
    held: list[Held] = []
    names = case.held_names
    platens: list[Platen] = []
    for k, part in enumerate(case.supports):
        key = f"supports[{k}]"
        kind = SUPPORTS.named(part.type, f"{key}.type")
        place = place_from_part(part, domain, l_f, key)
        rows = [row for row in kind(place, f"{key}.{part.naming}") if row is not None]
        supports += _on_platen(rows, place, part.platen, platens, f"{key}.platen")
        held.append(Held(place.centroid, len(rows), names[len(held)]))
    loads, pulls = [], []
    for load in case.named_loads:
        place = place_from_part(load.part, domain, l_f, load.key)
        outward, direction = place.outward, load_direction(load.part, place, load.key)
        platen = load.part.platen
        loads += _on_platen([mean_displacement(place, direction)], place, platen, platens, f"{load.key}.platen")
        pulls.append(outward is not None and float(direction @ outward) > 0.0)
        if platen is not None and platen.guided:
            guides = _guides(place, direction, platen.turning, f"{load.key}.platen.turning")
            supports += [replace(row, platen=len(platens) - 1) for row in guides]
            held.append(Held(place.centroid, len(guides), names[len(held)]))
    _check_stability(supports, domain.bounds.mean(axis=0), float(domain.size.max()))
    keys = [load.key for load in case.named_loads]
    weight = None
    if case.gravity is not None:
        keys = [*keys, GRAVITY]
        size = case.gravity.density * case.gravity.acceleration * domain.volume
        weight = Weight(np.asarray(case.gravity.direction, float), size)
        pulls.append(False)
    gauges = case.named_gauges
    gauge_names = tuple(gauge.name for gauge in gauges)
    drives = tuple(_drive(stage, case.load_names, gauge_names) for stage in case.stages)
    return Conditions(
        tuple(supports),
        tuple(loads),
        tuple(case.load_names),
        tuple(keys),
        tuple(gauge_from_part(gauge.part, domain, l_f, gauge.key)[0] for gauge in gauges),
        gauge_names,
        tuple(gauge.key for gauge in gauges),
        drives,
        tuple(held),
        pulls[int(np.argmax(drives[-1].ratios != 0.0))],
        weight,
        tuple(platens),
    )


def _on_platen(
    rows: Sequence[Functional], place: Place, part: PlatenPart | None, platens: list[Platen], key: str
) -> list[Functional]:
    """Functionals of a place, on a platen where the case has one; that is added to the list."""
    if part is None:
        return list(rows)
    if not place.parts:
        raise InputError(key, "lies on a line or a point, and has no area", "a place with a width, a box or a surface")
    platens.append(Platen(key, place.parts, place.centroid, part.contact))
    return [replace(row, platen=len(platens) - 1) for row in rows]


def _guides(place: Place, direction: FloatArray, turning: str, key: str) -> list[Functional]:
    """What a platen that moves along a load cannot do: go sideways, turn about any axis, or any but its hinge."""
    across = np.linalg.svd(direction[None, :])[2][1:]
    axes = list(np.eye(3))
    if turning == "hinged":
        if place.hinge is None:
            raise InputError(key, "the place has no line about which the platen could turn", '"free" or "held"')
        axes = list(np.linalg.svd(place.hinge[None, :])[2][1:])
    rows = [mean_displacement(place, unit) for unit in across] + [mean_rotation(place, unit) for unit in axes]
    return [row for row in rows if row is not None]


def _drive(stage: LoadingStage, loads: Sequence[str], gauges: Sequence[str]) -> Drive:
    """What a stage drives, by position among all loads and gauges."""
    ratios = np.zeros(len(loads))
    for name, ratio in stage.ratios:
        ratios[loads.index(name)] = ratio
    return Drive(ratios, stage.quantity, None if stage.gauge is None else gauges.index(stage.gauge))


def load_direction(part: Load, place: Place, key: str = "load") -> FloatArray:
    """Unit vector (3,) along the load: as the case says, or into the specimen.

    Raises
    ------
    InputError
        The case does not say, and the place faces all ways.
    """
    if part.direction is not None:
        given: FloatArray = np.asarray(part.direction, float)
        return np.asarray(given / np.linalg.norm(given))
    if place.outward is not None:
        return -place.outward
    problem = "missing, and the place of the load faces all ways"
    raise InputError(f"{key}.direction", problem, "three numbers, the direction in which it pushes")
