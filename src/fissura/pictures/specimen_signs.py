"""What holds, loads and measures a specimen, as pictures of it show it: signs at places, platens as plates, names."""

from dataclasses import dataclass

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.case import Case
from fissura.case.platen import Platen
from fissura.specimen import Domain, Place, gauge_from_part, load_direction, place_from_part
from fissura.specimen.planes import unit
from fissura.tessellation import SurfaceFacets
from fissura.tessellation.tessellation import LEDGE

SUPPORT = "#4b5563"
LOADS = ("#b42318", "#d97706", "#a21caf", "#7c2d12", "#db2777", "#854d0e")
GAUGES = ("#1d4ed8", "#0e7490", "#6d28d9", "#15803d", "#4338ca", "#0f766e")
WEIGHT = "#3f6212"
PLATES = {"glued": "#7b8794", "frictionless": "#c3cbd4"}
"""Colours; those of loads and gauges come again where there are more."""

MOST_POINTS = 60
"""Sample points of a place that are drawn, at most."""

MOST_ARROWS = 9
"""Arrows of a load, at most."""

THICKNESS = 0.03
"""Thickness of a drawn platen over the largest dimension of the specimen."""


@dataclass(frozen=True, eq=False)
class Spots:
    """Points at which a sign stands: on the surface, or on the platen there.

    Attributes
    ----------
    points, normals : (k, 3) array
        The points [m], and unit normals out of the specimen.
    """

    points: FloatArray
    normals: FloatArray

    @property
    def middle(self) -> FloatArray:
        """Mean of the points, shape (3,) [m]."""
        return np.asarray(self.points.mean(axis=0))


@dataclass(frozen=True, eq=False)
class SupportSign:
    """A support: its kind, and where it holds."""

    kind: str
    spots: Spots

    @property
    def label(self) -> str:
        """Its name for a legend."""
        return f"support, {self.kind}"


@dataclass(frozen=True, eq=False)
class LoadSign:
    """A load.

    Attributes
    ----------
    label, colour : str
        Its name for a legend, and its colour.
    spots : Spots
        Where it acts.
    direction : (3,) array
        Unit vector along it.
    """

    label: str
    colour: str
    spots: Spots
    direction: FloatArray

    def arrows(self, length: float) -> tuple[FloatArray, FloatArray]:
        """Begins and ends of its arrows, shape (k, 3) [m]: they end where it presses, and begin where it pulls."""
        some = _evenly(len(self.spots.points), MOST_ARROWS)
        points, shift = self.spots.points[some], length * self.direction
        presses = self.spots.normals[some] @ self.direction <= 0.0
        begin = np.where(presses[:, None], points - shift, points)
        return begin, begin + shift


@dataclass(frozen=True, eq=False)
class GaugeSign:
    """A gauge: its name for a legend, its colour, and its places."""

    label: str
    colour: str
    places: tuple[Spots, ...]

    @property
    def line(self) -> FloatArray:
        """From the middle of one place to that of the next, shape (p, 3) [m]."""
        return np.array([spots.middle for spots in self.places])


@dataclass(frozen=True, eq=False)
class Plate:
    """A platen as a plate on the surface.

    Attributes
    ----------
    label, colour : str
        For a legend.
    faces : tuple of (k, 3) array
        Polygons [m], counterclockwise from outside.
    normals : (f, 3) array
        Their outward unit normals.
    outward : (3,) array
        The way in which the plate stands off the specimen; the mean of all ways where it goes around it.
    """

    label: str
    colour: str
    faces: tuple[FloatArray, ...]
    normals: FloatArray
    outward: FloatArray


@dataclass(frozen=True, eq=False)
class Signs:
    """All that is drawn of a case besides its bodies; the weight as a unit vector (3,), None without gravity."""

    supports: tuple[SupportSign, ...]
    loads: tuple[LoadSign, ...]
    gauges: tuple[GaugeSign, ...]
    plates: tuple[Plate, ...]
    weight: FloatArray | None

    @property
    def legend(self) -> list[tuple[str, str]]:
        """Names and colours of what holds, loads and measures, each once."""
        entries = [(support.label, SUPPORT) for support in self.supports]
        entries += [(load.label, load.colour) for load in self.loads]
        entries += [(gauge.label, gauge.colour) for gauge in self.gauges]
        return list(dict(entries if self.weight is None else [*entries, ("gravity", WEIGHT)]).items())


def signs_of(case: Case, domain: Domain) -> Signs:
    """Place the signs of a case on its specimen.

    Parameters
    ----------
    case : Case
        What is held, loaded and measured.
    domain : Domain
        Its specimen.

    Raises
    ------
    InputError
        A place is not on the surface.
    """
    l_f, thickness = case.discretization.l_f, THICKNESS * float(domain.size.max())
    plates: list[Plate] = []

    def spots(place: Place, platen: Platen | None) -> Spots:
        lift = 0.0
        if platen is not None and place.parts:
            plates.append(_plate(place, platen, thickness))
            lift = thickness
        some = _evenly(len(place.points), MOST_POINTS)
        ways = place.normals[some] if place.outward is None else place.outward
        return Spots(place.points[some] + lift * ways, place.normals[some])

    supports, loads, gauges = [], [], []
    for k, part in enumerate(case.supports):
        place = place_from_part(part, domain, l_f, f"supports[{k}]")
        supports.append(SupportSign(part.type, spots(place, part.platen)))
    for k, load in enumerate(case.named_loads):
        place = place_from_part(load.part, domain, l_f, load.key)
        label = "load" if len(case.named_loads) == 1 else f"load {load.name}"
        along = load_direction(load.part, place, load.key)
        loads.append(LoadSign(label, LOADS[k % len(LOADS)], spots(place, load.part.platen), along))
    for k, gauge in enumerate(case.named_gauges):
        places = gauge_from_part(gauge.part, domain, l_f, gauge.key)[1]
        label = "gauge" if len(case.named_gauges) == 1 else f"gauge {gauge.name}"
        what = "from a to b" if gauge.part.own_name is None else gauge.part.own_name
        found = tuple(spots(place, None) for place in places)
        gauges.append(GaugeSign(f"{label}, {what}", GAUGES[k % len(GAUGES)], found))
    weight = None if case.gravity is None else np.asarray(case.gravity.direction, float)
    return Signs(tuple(supports), tuple(loads), tuple(gauges), tuple(plates), weight)


def named_facets(surface: SurfaceFacets, weight: FloatArray) -> dict[str, int | None]:
    """Where to write the name of each surface: the facet nearest to its middle, by weights (f,) of the facets.

    The middle of a bent surface itself may lie inside the specimen. None stands for a surface without any weight.
    """
    found: dict[str, int | None] = {}
    for number, name in enumerate(surface.names):
        own = surface.surface == number
        if name == LEDGE or not own.any():
            continue
        some = np.flatnonzero(own & (weight > 0.0))
        found[name] = None
        if len(some):
            middle = weight[some] @ surface.centroid[some] / weight[some].sum()
            found[name] = int(some[np.argmin(np.linalg.norm(surface.centroid[some] - middle, axis=1))])
    return found


def _evenly(count: int, most: int) -> IntArray:
    """Evenly many of some points."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))


def _plate(place: Place, platen: Platen, thickness: float) -> Plate:
    """What a place covers, made thick; walls stand at its edges only."""
    turning = getattr(platen, "turning", "free")
    label = f"platen, {platen.contact}{'' if turning == 'free' else f', {turning}'}"
    polygons = [part.polygon for part in place.parts]
    ways = [part.normal if place.outward is None else place.outward for part in place.parts]
    faces = [polygon + thickness * way for polygon, way in zip(polygons, ways, strict=True)]
    normals = [part.normal for part in place.parts]
    begin = np.concatenate(polygons)
    end = np.concatenate([np.roll(polygon, -1, axis=0) for polygon in polygons])
    way = np.repeat(ways, [len(polygon) for polygon in polygons], axis=0)
    for k in np.flatnonzero(_at_the_rim(begin, end)):
        a, b, up = begin[k], end[k], thickness * way[k]
        faces.append(np.array([a, b, b + up, a + up]))
        normals.append(unit(np.cross(b - a, up)))
    mean = np.mean(ways, axis=0)
    return Plate(label, PLATES[platen.contact], tuple(faces), np.array(normals), mean)


def _at_the_rim(begin: FloatArray, end: FloatArray) -> BoolArray:
    """Which edges of polygons no other one has, by their middles and lengths, shape (e,)."""
    length = np.linalg.norm(end - begin, axis=1)
    key = np.column_stack([0.5 * (begin + end), length]) / (1e-6 * max(float(length.max()), 1e-300))
    _, inverse, count = np.unique(key.round(), axis=0, return_inverse=True, return_counts=True)
    return np.asarray((count[inverse.ravel()] == 1) & (length > 1e-9 * length.max()))
