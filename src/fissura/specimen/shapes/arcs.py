"""Round outlines as polygons: flat enough beside the bodies, and of the same area."""

from collections.abc import Sequence

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.case.shape import Corner
from fissura.errors import InputError
from fissura.specimen.limits import FEWEST_SIDES, MOST_SIDES, SAGITTA
from fissura.specimen.planar import area_of
from fissura.specimen.shapes.convex_parts import check_simple


def _sides(angle: float, radius: float, l_f: float, least: int) -> int:
    """Sides for an arc of a given angle."""
    reach = min(SAGITTA * l_f / radius, 1.0)
    return int(np.clip(np.ceil(angle / (2.0 * np.arccos(1.0 - reach)) - 1e-9), least, MOST_SIDES))


def circle(diameter: float, l_f: float) -> FloatArray:
    """A regular polygon with the area of a circle around the origin, counterclockwise, shape (k, 2) [m].

    Its number of sides is a multiple of four, and the middles of four of them lie on the axes.

    Parameters
    ----------
    diameter : float
        Diameter of the circle [m].
    l_f : float
        Spacing of fine nuclei [m].
    """
    radius = 0.5 * diameter
    count = 4 * int(np.ceil(_sides(2.0 * np.pi, radius, l_f, FEWEST_SIDES) / 4.0))
    outer = radius * np.sqrt(2.0 * np.pi / (count * np.sin(2.0 * np.pi / count)))
    angle = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    out: FloatArray = outer * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return out


def flattened(corners: Sequence[Corner], l_f: float, key: str) -> tuple[FloatArray, IntArray]:
    """An outline whose arcs are polygons of the same area, counterclockwise.

    Parameters
    ----------
    corners : sequence of Corner
        Corners and arcs of the case.
    l_f : float
        Spacing of fine nuclei [m].
    key : str
        Where the outline stands in the case file.

    Returns
    -------
    points : (n, 2) array
        Corners [m].
    side : (n,) array
        For each corner the side of the outline that goes on from it; side 0 leads from its first corner to its second.

    Raises
    ------
    InputError
        Corners that coincide, an arc that does not reach from one corner to the next, an outline without area.
    """
    ends = np.array([corner.to for corner in corners])
    size = float(np.ptp(ends, axis=0).max())
    area = area_of(ends)
    if size == 0.0 or abs(area) <= 1e-9 * size**2:
        if np.linalg.svd(ends - ends.mean(axis=0), compute_uv=False)[1] > 1e-9 * size:
            check_simple(ends, key)
        raise InputError(key, "it encloses no area", "corners around an area")
    turn = 1.0 if area > 0.0 else -1.0
    points: list[FloatArray] = []
    side: list[int] = []
    for k, corner in enumerate(corners):
        a, b = ends[k - 1], ends[k]
        if np.linalg.norm(b - a) <= 1e-9 * size:
            raise InputError(f"{key}[{k}]", "is the same corner as the one before it", "corners apart from each other")
        points.append(a)
        side.append((k - 1) % len(corners))
        if corner.radius is not None:
            inner = _arc(a, b, turn * corner.radius, l_f, f"{key}[{k}].radius")
            points += list(inner)
            side += [side[-1]] * len(inner)
    out, sides = np.array(points), np.array(side)
    return (out, sides) if turn > 0.0 else (out[::-1], np.roll(sides[::-1], -1))


def _arc(a: FloatArray, b: FloatArray, radius: float, l_f: float, key: str) -> FloatArray:
    """Corners between the ends of an arc that keeps to the right of its chord when its radius is positive."""
    chord = float(np.linalg.norm(b - a))
    size = abs(radius)
    if 2.0 * size < chord * (1.0 - 1e-9):
        raise InputError(
            key,
            f"an arc of radius {size:g} m does not reach over the {chord:g} m between its ends",
            f"{0.5 * chord:g} m or more",
        )
    half = float(np.arcsin(min(0.5 * chord / size, 1.0)))
    along = (b - a) / chord
    left = np.array([-along[1], along[0]]) * np.sign(radius)
    centre = 0.5 * (a + b) + size * np.cos(half) * left
    count = _sides(2.0 * half, size, l_f, 2)
    step = 2.0 * half / count
    # The ends stay; corners between them are moved out until the area is that of the sector.
    sector = 2.0 * half / np.sin(step)
    outer = sector / 2.0 if count == 2 else (np.sqrt(1.0 + (count - 2) * sector) - 1.0) / (count - 2)
    start = a - centre
    angle = np.sign(radius) * step * np.arange(1, count)
    turned = np.stack(
        [start[0] * np.cos(angle) - start[1] * np.sin(angle), start[0] * np.sin(angle) + start[1] * np.cos(angle)],
        axis=1,
    )
    out: FloatArray = centre + outer * turned
    return out
