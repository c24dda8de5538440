"""Symbols of supports, load and gauge for views along z; they follow the specimen's surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

from fissura.arrays import FloatArray
from fissura.case import Case
from fissura.specimen import Place, domain_from_case, gauge_from_part, load_direction, place_from_part

if TYPE_CHECKING:
    from matplotlib.axes import Axes


SUPPORT, LOAD = "#6b7280", "#30343b"

SIZE = 0.085
"""Size of a symbol as part of the smaller side of the view; see `symbols`."""

WHOLE = 0.08
"""A patch longer than this part of the specimen is drawn along its length, not as one point."""


@dataclass(frozen=True)
class Symbol:
    """Shapes that move together with one point of the surface.

    Attributes
    ----------
    anchor : (2,) array
        The point (x, y) [m].
    filled : list of (k, 2) array
        Filled shapes [m].
    lines : list of (k, 2) array
        Lines [m].
    colour : str
        Of both.
    """

    anchor: FloatArray
    filled: list[FloatArray]
    lines: list[FloatArray]
    colour: str


def symbols(case: Case) -> list[Symbol]:
    """Symbols of a case's supports, loads and gauges; places on the front and the back have none.

    A pin is a triangle, a roller a triangle on a line, a clamp a hatched line, a guide one apart from the surface, the
    load arrows, a gauge two dots.
    """
    domain = domain_from_case(case)
    l_f = case.discretization.l_f
    length, depth = domain.size[:2]
    size = SIZE * min(max(length, depth) / 2.5, 1.5 * min(length, depth))
    found = []
    for k, part in enumerate(case.supports):
        place = place_from_part(part, domain, l_f, f"supports[{k}]")
        if _outward(place) is not None:
            found += _support(part.type, place, size, max(length, depth))
    for load in case.named_loads:
        place = place_from_part(load.part, domain, l_f, load.key)
        found += _load(place, load_direction(load.part, place, load.key)[:2], size, max(length, depth))
    for gauge in case.named_gauges:
        found += [_gauge(place, size) for place in gauge_from_part(gauge.part, domain, l_f, gauge.key)[1]]
    return found


def _outward(place: Place) -> FloatArray | None:
    """Unit vector (2,) out of the surface in the view; None where that is along the line of sight, or all around."""
    outward = place.outward
    if outward is None or np.linalg.norm(outward[:2]) < 0.5:
        return None
    return np.asarray(outward[:2] / np.linalg.norm(outward[:2]))


def _frame(place: Place) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Middle of a place, unit vectors along the surface and out of it, and half its length in the view."""
    outward = _outward(place)
    if outward is None:
        return place.centroid[:2], np.array([1.0, 0.0]), np.zeros(2), 0.0
    along = np.array([-outward[1], outward[0]])
    along = along if along[np.argmax(np.abs(along))] > 0.0 else -along
    reach = place.points[:, :2] @ along
    middle = place.centroid[:2] + along * (0.5 * (reach.min() + reach.max()) - place.centroid[:2] @ along)
    return middle, along, outward, 0.5 * float(np.ptp(reach))


def _shape(
    middle: FloatArray, along: FloatArray, outward: FloatArray, corners: list[tuple[float, float]]
) -> FloatArray:
    a, b = np.array(corners, dtype=np.float64).T[:, :, None]
    return np.asarray(middle + a * along + b * outward)


def _support(kind: str, place: Place, size: float, extent: float) -> list[Symbol]:
    middle, along, outward, half = _frame(place)
    if kind in ("clamp", "guide") or 2.0 * half > WHOLE * extent:
        half = max(half, 0.6 * size)
        gap = 0.0 if kind == "clamp" else 0.25 * size
        ticks = np.arange(-half, half + 1e-9, 2.0 * half / max(round(2.0 * half / (0.45 * size)), 1))
        lines = [_shape(middle, along, outward, [(-half, gap), (half, gap)])]
        lines += [_shape(middle, along, outward, [(t, gap), (t - 0.35 * size, gap + 0.4 * size)]) for t in ticks]
        return [Symbol(middle, [], lines, SUPPORT)]
    plate = 0.0
    filled = []
    if half > 0.0:
        plate = 0.18 * size
        filled.append(_shape(middle, along, outward, [(-half, 0), (half, 0), (half, plate), (-half, plate)]))
    filled.append(
        _shape(
            middle, along, outward, [(0, plate), (0.55 * size, plate + 0.9 * size), (-0.55 * size, plate + 0.9 * size)]
        )
    )
    base = plate + (0.9 if kind == "pin" else 1.12) * size
    lines = [_shape(middle, along, outward, [(-0.85 * size, base), (0.85 * size, base)])]
    return [Symbol(middle, filled, lines, SUPPORT)]


def _load(place: Place, direction: FloatArray, size: float, extent: float) -> list[Symbol]:
    middle, along, outward, half = _frame(place)
    norm = float(np.linalg.norm(direction))
    if norm < 1e-9:  # along the line of sight
        return []
    ahead = direction / norm
    side = np.array([-ahead[1], ahead[0]])
    pushes = float(ahead @ outward) < 0.0
    plate = 0.18 * size if 0.0 < 2.0 * half <= WHOLE * extent else 0.0
    filled, lines = [], []
    if plate:
        filled.append(_shape(middle, along, outward, [(-half, 0), (half, 0), (half, plate), (-half, plate)]))
    shifts = np.linspace(-0.85, 0.85, 5) * half if 2.0 * half > WHOLE * extent else np.zeros(1)
    for shift in shifts:
        start = middle + shift * along + outward * plate
        tip = start if pushes else start + 2.4 * size * ahead
        filled.append(_shape(tip, side, -ahead, [(0, 0), (0.42 * size, 0.95 * size), (-0.42 * size, 0.95 * size)]))
        lines.append(np.array([tip - 0.9 * size * ahead, tip - 2.4 * size * ahead]))
    return [Symbol(middle, filled, lines, LOAD)]


def _gauge(place: Place, size: float) -> Symbol:
    middle = _frame(place)[0]
    angle = np.linspace(0.0, 2.0 * np.pi, 17)
    return Symbol(middle, [middle + 0.2 * size * np.stack([np.cos(angle), np.sin(angle)], axis=1)], [], LOAD)


class Symbols:
    """Symbols in a picture.

    Parameters
    ----------
    axes : Axes
        Where to draw, in mm.
    found : list of Symbol
        What to draw.
    """

    def __init__(self, axes: Axes, found: list[Symbol]) -> None:
        self._found = found
        self._filled = PolyCollection([], facecolors=[s.colour for s in found for _ in s.filled], zorder=6)
        self._lines = LineCollection([], colors=[s.colour for s in found for _ in s.lines], linewidths=1.3, zorder=6)
        for collection in (self._filled, self._lines):
            collection.set_clip_on(False)
            axes.add_collection(collection, autolim=False)

    def place(self, moved: FloatArray) -> None:
        """Move the symbols by the displacements of their anchors, shape (n, 2) [m]."""
        pairs = list(zip(self._found, moved, strict=True))
        self._filled.set_verts([1e3 * (shape + by) for symbol, by in pairs for shape in symbol.filled])
        self._lines.set_segments([1e3 * (line + by) for symbol, by in pairs for line in symbol.lines])
