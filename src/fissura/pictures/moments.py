"""Bodies and crack at four moments of a run beside its curve, and of two runs beside each other."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fissura.arrays import FloatArray
from fissura.pictures.curves import BLUE, DPI, INK, mark_point, note_above
from fissura.pictures.lettering import literal, may_shrink, save
from fissura.pictures.panels import draw_curve, draw_scales
from fissura.pictures.side_view import Look, SideView, look_of
from fissura.results.comparison import Comparison
from fissura.results.curve import COLUMN_OF, peak_position
from fissura.results.history import Frame
from fissura.results.result import Result
from fissura.text import quantities as text

WIDE = 10.0
"""Width of the pictures [inch]."""

NARROW = 3.6
"""Width of panels [inch] below which their captions take two lines."""

TALL = 6.0
"""Most height of a row of them [inch]."""

BEFORE_PEAK = 0.8
"""Without a refinement before the peak, the second moment is where the load reaches this part of it."""


@dataclass(frozen=True)
class Moment:
    """A step worth showing.

    Attributes
    ----------
    letter, name : str
        What it is called.
    frame : Frame
        The section then.
    """

    letter: str
    name: str
    frame: Frame


def moments(frames: Sequence[Frame]) -> list[Moment]:
    """Choose up to four moments: before and at the first refinement, at the peak, and at the end.

    Where nothing was refined before the peak the first two are in the elastic range and shortly before the peak. Runs
    that are too short, or end at their peak, have fewer moments.

    Parameters
    ----------
    frames : sequence of Frame
        All steps of a run.
    """
    load = np.array([abs(frame.load) for frame in frames])
    peak, last = peak_position(load), len(frames) - 1
    changed = [k for k in range(1, peak) if frames[k].section is not frames[0].section]
    if changed:
        second, names = changed[0], ("before refinement", "first refinement")
    else:
        second, names = int(np.argmax(load >= BEFORE_PEAK * load[peak])), ("elastic", "before the peak")
    first = int(np.abs(load[: max(second, 1)] - 0.5 * load[second]).argmin())
    chosen = {first: names[0], second: names[1], last: "end", peak: "peak"}
    return [Moment("abcd"[k], chosen[n], frames[n]) for k, n in enumerate(sorted(chosen))]


def plot_moments(folder: str | Path, path: Path, *, stress: bool = False) -> None:
    """Draw the four moments of a run, and its curve with them.

    Parameters
    ----------
    folder : str or Path
        Folder of the run's results.
    path : Path
        File to write; its ending decides the format.
    stress : bool, optional
        Colour bodies by their largest principal stress instead of showing which are fine.

    Raises
    ------
    InputError
        The folder does not hold the results of a run that has ended, with its section.

    Examples
    --------
    >>> plot_moments(folder, Path("moments.png"))
    """
    result = Result.load(folder)
    frames = result.frames
    shown = moments(frames)
    look = look_of(result.case, [moment.frame for moment in shown], stress=stress)
    rows = 2 if look.aspect > 1.2 else 1
    columns = -(-len(shown) // rows)
    tall = (WIDE / columns) / look.aspect + 0.45
    figure = Figure(figsize=(WIDE, rows * min(tall, TALL) + 2.7), layout="constrained")
    upper, lower = np.ravel(figure.subfigures(2, 1, squeeze=False, height_ratios=(rows * min(tall, TALL), 2.7)))
    panels = upper.subplots(rows, columns, squeeze=False, gridspec_kw={"wspace": 0.05}).ravel()
    for axes in panels[len(shown) :]:
        axes.set_axis_off()
    for axes, moment in zip(panels, shown, strict=False):
        SideView(axes, result.case, look).show(moment.frame)
        _caption(axes, f"{moment.letter}  {moment.name}", moment.frame, narrow=_narrow(look, columns))
    curve, scale = lower.subplots(1, 2, width_ratios=(2.6, 1.0))
    mark_moments(curve, shown, draw_curve(curve, result))
    draw_scales(scale, look, full=result.full)
    save(figure, path, DPI)


def bodies_figure(
    comparison: Comparison, *, stress: bool = False, make: Callable[..., Figure] = Figure
) -> tuple[Figure, list[Axes]]:
    """Draw two runs beside each other at the moments of the first.

    The moments of run B are the steps nearest in what `Comparison.over` says: the gauge, the displacement of the load,
    or the dissipated energy.

    Parameters
    ----------
    comparison : Comparison
        The runs.
    stress : bool, optional
        Colour bodies by their largest principal stress instead of showing which are fine.
    make : callable, optional
        Makes the figure: the class, or ``pyplot.figure`` for a figure that notebooks show.

    Returns
    -------
    figure : Figure
        What was drawn.
    axes : list of Axes
        Those of run A and run B in turn, moment after moment.

    Raises
    ------
    InputError
        A run was read from a folder without sections.
    """
    a, b = comparison.a, comparison.b
    frames_a, frames_b = a.frames, b.frames
    shown = moments(frames_a)
    others = [_counterpart(comparison, moment.frame, frames_b) for moment in shown]
    look = look_of(a.case, [moment.frame for moment in shown] + others, stress=stress)
    tall = min(0.5 * WIDE / look.aspect + 0.45, TALL)
    figure = make(figsize=(WIDE, len(shown) * tall + 1.2), layout="constrained")
    upper, lower = np.ravel(figure.subfigures(2, 1, squeeze=False, height_ratios=(len(shown) * tall + 0.3, 0.9)))
    panels = upper.subplots(len(shown), 2, squeeze=False, gridspec_kw={"wspace": 0.05})
    for row, (moment, other) in enumerate(zip(shown, others, strict=True)):
        for axes, result, frame in zip(panels[row], (a, b), (moment.frame, other), strict=True):
            SideView(axes, result.case, look, thin=0.7).show(frame)
            _caption(axes, f"{moment.letter}  {moment.name}" if result is a else "", frame, narrow=_narrow(look, 2))
    for axes, name in zip(panels[0], _titles(a, b), strict=True):
        raised = 36 if _narrow(look, 2) else 26
        note_above(axes, literal(name), raised, fontsize=12, fontweight="bold", color=BLUE, va="bottom")
    draw_scales(lower.subplots(), look, full=a.full and b.full, wide=True)
    return figure, list(panels.ravel())


def mark_moments(axes: Axes, shown: Sequence[Moment], scales: tuple[float, float]) -> None:
    """Mark moments on a curve that `draw_curve` drew, with the factors that it returned."""
    for moment in shown:
        x, y = moment.frame.value * scales[0], moment.frame.load * scales[1]
        mark_point(axes, x, y, size=7, markeredgewidth=1.7, clip_on=False)
        axes.annotate(
            moment.letter,
            (x, y),
            xytext=(0, 7),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=10,
            fontweight="bold",
            color=INK,
            zorder=5,
        )


def _narrow(look: Look, columns: int) -> bool:
    """Whether captions of panels take two lines, of which there are so many beside each other."""
    return min(WIDE / columns, TALL * look.aspect) < NARROW


def _caption(axes: Axes, name: str, frame: Frame, *, narrow: bool) -> None:
    """Name of a moment and numbers of its state: in one line, or below each other where a panel is narrow."""
    note = f"{text.length(frame.value)}, {text.force(frame.load)}, {text.count(frame.bodies)} bodies"
    may_shrink(axes.set_title(name, loc="left", fontsize=10, fontweight="bold", color=INK, pad=18 if narrow else None))
    if not narrow:
        axes.set_title(note, loc="right", fontsize=9, color=INK)
        return
    note_above(axes, note, 5)


def _titles(a: Result, b: Result) -> tuple[str, str]:
    kinds = tuple("full resolution" if result.full else "adaptive" for result in (a, b))
    if kinds[0] != kinds[1]:
        return kinds[0], kinds[1]
    return f"A: {a.case.name}, {kinds[0]}", f"B: {b.case.name}, {kinds[1]}"


def _counterpart(comparison: Comparison, frame: Frame, others: Sequence[Frame]) -> Frame:
    """The frame of run B that is nearest to one of run A."""
    far = _distances(comparison, COLUMN_OF[comparison.quantity], frame, others)
    if comparison.by_energy:
        far = far + 1e3 * _distances(comparison, "dissipated_J", frame, others)
    return others[int(far.argmin())]


def _distances(comparison: Comparison, column: str, frame: Frame, others: Sequence[Frame]) -> FloatArray:
    """Distances of frames of run B from one of run A in a column of the curve, over the largest value there."""
    values = np.array([_value(comparison.b, column, other) for other in others])
    distances: FloatArray = np.abs(values - _value(comparison.a, column, frame))
    return distances / max(float(np.abs(values).max()), 1e-300)


def _value(result: Result, column: str, frame: Frame) -> float:
    """Value of a column of the curve at a frame; 0 at the unloaded structure."""
    row = np.flatnonzero(result.curve["step"] == frame.number)
    return float(result.curve[column][row[0]]) if len(row) else 0.0
