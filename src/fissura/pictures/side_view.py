"""One view of a specimen on the x-y plane: bodies, cracks and symbols, at any step of a run."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize, PowerNorm
from numpy.typing import NDArray

from fissura.arrays import FloatArray
from fissura.case import Case
from fissura.pictures.curves import INK
from fissura.pictures.support_symbols import Symbols, symbols
from fissura.results.history import Frame
from fissura.results.section import Outlines, Section, outlines
from fissura.specimen import domain_from_case

FINE, COARSE, EDGE = "#a9c6e3", "#f1ede3", "#7f8b99"
HEAT = LinearSegmentedColormap.from_list("opening", ["#f9c74f", "#f3892c", "#d6401f", "#96152f", "#4a0524", "#1c0210"])
TENSION = LinearSegmentedColormap.from_list("stress", ["#f7f5ef", "#d3e2ef", "#8db7da", "#3f7fb5", "#17456f"])

SHOWN = 0.01
"""Openings below this part of the largest one are not drawn."""

BENT = 0.045
"""Displacements are magnified until the largest is this part of the specimen's larger side, at most."""


@dataclass(frozen=True)
class Look:
    """What all views of one picture share.

    Attributes
    ----------
    magnify : float
        Factor on displacements.
    opening : Normalize
        Crack openings [µm] that `HEAT` stands for, by their square root: small ones must be seen, too.
    stress : Normalize or None
        Stresses [MPa] that the ends of `TENSION` stand for; None: bodies show whether they are fine.
    window : (4,) array
        Limits x0, x1, y0, y1 [mm].
    """

    magnify: float
    opening: Normalize
    stress: Normalize | None
    window: FloatArray

    @property
    def aspect(self) -> float:
        """Width of the window over its height."""
        return float((self.window[1] - self.window[0]) / (self.window[3] - self.window[2]))


def look_of(case: Case, frames: Sequence[Frame], *, stress: bool = False, magnify: float | None = None) -> Look:
    """Find scales and a window that suit all given frames.

    Parameters
    ----------
    case : Case
        What was run.
    frames : sequence of Frame
        What is to be drawn, of one run or of several.
    stress : bool, optional
        Colour bodies by their largest principal stress.
    magnify : float, optional
        Factor on displacements; by default a round number such that the largest is a few per cent of the specimen.
    """
    bounds = domain_from_case(case).bounds[:, :2]
    moved = [_moved(frame.section.lines[:, 0], frame.motion[frame.section.sides[:, 0]]) for frame in frames]
    if magnify is None:
        largest = max(float(np.linalg.norm(by, axis=1).max(initial=0.0)) for by in moved)
        magnify = magnification(largest, float(np.ptp(bounds, axis=0).max()))
    corners = [bounds]
    corners += [frame.section.lines[:, 0] + magnify * by for frame, by in zip(frames, moved, strict=True)]
    corners += [shape for symbol in symbols(case) for shape in (*symbol.filled, *symbol.lines)]
    points = np.concatenate(corners)
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.015 * float((high - low).max())
    widest = max(float(frame.opening.max(initial=0.0)) for frame in frames)
    largest_stress = max(float(np.quantile(frame.stress, 0.99)) for frame in frames) if stress else 0.0
    return Look(
        magnify,
        PowerNorm(0.5, 0.0, 1e6 * widest or 1.0),
        Normalize(0.0, 1e-6 * max(largest_stress, 0.0) or 1.0) if stress else None,
        1e3 * np.array([low[0] - margin, high[0] + margin, low[1] - margin, high[1] + margin]),
    )


def _moved(points: NDArray[Any], motion: NDArray[Any]) -> FloatArray:
    """Displacements (p, 2) of points by the motions (p, 3) of their bodies [m]."""
    a, b, turn = motion.T.astype(np.float64)
    return np.stack([a - turn * points[:, 1], b + turn * points[:, 0]], axis=1)


def _nearest(lines: FloatArray, point: FloatArray) -> int:
    """Which of lines (k, 2, 2) is nearest to a point (2,)."""
    start, along = lines[:, 0], lines[:, 1] - lines[:, 0]
    share = ((point - start) * along).sum(axis=1) / (along * along).sum(axis=1)
    foot = start + np.clip(share, 0.0, 1.0)[:, None] * along
    return int(np.argmin(((point - foot) ** 2).sum(axis=1)))


def magnification(largest: float, size: float) -> float:
    """A round factor on displacements, ... 0.5, 1, 2, 5, 10 ..., such that the largest is a few per cent of a size."""
    if largest <= 0.0:
        return 1.0
    value = BENT * size / largest
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(k for k in (1.0, 2.0, 5.0) if k * power <= value * (1 + 1e-9)))


class SideView:
    """A view of the specimen whose step can be changed.

    Parameters
    ----------
    axes : Axes
        Where to draw; its limits are set, its frame is taken away.
    case : Case
        What was run.
    look : Look
        Scales and window.
    thin : float, optional
        Factor on the width of the lines around bodies.
    """

    def __init__(self, axes: Axes, case: Case, look: Look, thin: float = 1.0) -> None:
        self._look = look
        self._shapes: tuple[Section, Outlines] | None = None
        self._bodies = PolyCollection([], linewidths=0.35 * thin, edgecolors=EDGE, zorder=2)
        self._cracks = PolyCollection([], zorder=4, joinstyle="round")
        self._skin = LineCollection([], colors=INK, linewidths=0.9 * thin, capstyle="round", zorder=3)
        for collection in (self._bodies, self._cracks, self._skin):
            axes.add_collection(collection, autolim=False)
        self._symbols = symbols(case)
        self._drawn = Symbols(axes, self._symbols)
        axes.set_xlim(look.window[0], look.window[1])
        axes.set_ylim(look.window[2], look.window[3])
        axes.set_aspect("equal")
        axes.set_axis_off()

    def show(self, frame: Frame) -> None:
        """Draw a step."""
        section, factor = frame.section, self._look.magnify
        if self._shapes is None or self._shapes[0] is not section:
            self._shapes = section, outlines(section)
        shapes = self._shapes[1]
        owner = np.repeat(np.arange(len(section.nucleus)), np.diff(shapes.offsets))
        corners = 1e3 * (shapes.points + factor * _moved(shapes.points, frame.motion[owner]))
        self._bodies.set_verts(np.split(corners, shapes.offsets[1:-1]))
        self._bodies.set_facecolor(self._colours(frame))

        outer = section.skin
        skin, body = section.lines[outer].astype(np.float64), section.sides[outer, 0]
        by = np.stack([_moved(skin[:, end], frame.motion[body]) for end in (0, 1)], axis=1)
        self._skin.set_segments(list(1e3 * (skin + factor * by)))
        self._show_cracks(frame)
        if self._symbols:
            anchors = np.array([symbol.anchor for symbol in self._symbols])
            holders = [int(body[_nearest(skin, anchor)]) for anchor in anchors]
            self._drawn.place(factor * _moved(anchors, frame.motion[holders]))

    def _colours(self, frame: Frame) -> Any:
        if self._look.stress is not None:
            return TENSION(self._look.stress(1e-6 * frame.stress)).tolist()
        return np.where(frame.section.fine, FINE, COARSE).tolist()

    def _show_cracks(self, frame: Frame) -> None:
        """Fill the gap that opened in each contact; a line where that would be too thin to be seen."""
        opening, section = 1e6 * frame.opening.astype(np.float64), frame.section
        shown = np.flatnonzero(opening > SHOWN * float(self._look.opening.vmax or 0.0))
        shown = shown[np.argsort(opening[shown], kind="stable")]
        lines, sides = section.lines[shown].astype(np.float64), section.sides[shown]
        p, q = lines[:, 0], lines[:, 1]
        corners = [
            point + self._look.magnify * _moved(point, frame.motion[sides[:, side]])
            for point, side in ((p, 0), (q, 0), (q, 1), (p, 1))
        ]
        share = np.asarray(self._look.opening(opening[shown]), dtype=np.float64)
        colours = HEAT(share).tolist()
        self._cracks.set_verts(list(1e3 * np.stack(corners, axis=1)))
        self._cracks.set_facecolor(colours)
        self._cracks.set_edgecolor(colours)
        self._cracks.set_linewidth((0.9 + 0.6 * share).tolist())
