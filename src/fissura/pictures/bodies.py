"""Bodies and cracks of a run at any step, in axes of matplotlib."""

import numpy as np
from matplotlib.axes import Axes

from fissura.errors import InputError
from fissura.pictures.curves import headline
from fissura.pictures.panels import bar_beside, kinds_above
from fissura.pictures.plotting import new_axes
from fissura.pictures.side_view import COARSE, EDGE, FINE, HEAT, TENSION, Look, SideView, look_of
from fissura.results.history import Frame
from fissura.results.run_data import RunData
from fissura.text import quantities as text

WIDE, TALL = 9.0, 6.0
"""Width and most height of a new figure [inch]."""


def bodies_axes(result: RunData, step: int | None, ax: Axes | None, *, stress: bool, magnify: float | None) -> Axes:
    """Draw a step; see `Result.plot_bodies`."""
    frame = _frame(result, step)
    look = look_of(result.case, [frame], stress=stress, magnify=magnify)
    mine = ax is None
    if ax is None:
        ax = new_axes((WIDE, min(0.9 * WIDE / look.aspect + 0.9, TALL)))
    SideView(ax, result.case, look).show(frame)
    if mine:
        note = f"step {frame.number}, {text.length(frame.value)}, {text.force(frame.load)}, {text.count(frame.bodies)} "
        headline(ax, result.case.name, f"{note}bodies, displacements × {look.magnify:g}")
        _explain(ax, look, frame)
    return ax


def _frame(result: RunData, step: int | None) -> Frame:
    frames = {frame.number: frame for frame in result.frames}
    if not frames:
        raise InputError(str(result.folder or result.case.name), "has no sections of steps")
    if step is None:
        return frames[max(frames)]
    if step not in frames:
        raise InputError("step", f"there is no step {step}", f"a whole number from {min(frames)} to {max(frames)}")
    return frames[step]


def _explain(ax: Axes, look: Look, frame: Frame) -> None:
    """Say what the colours of bodies and cracks mean."""
    if look.stress is None:
        fine = frame.section.fine
        kinds = [(FINE, EDGE, "fine bodies")] if fine.any() else []
        kinds_above(ax, kinds if fine.all() else [*kinds, (COARSE, EDGE, "coarse bodies")])
    else:
        bar_beside(ax, TENSION, look.stress, "largest principal stress [MPa]")
    if np.any(frame.opening > 0.0):
        bar_beside(ax, HEAT, look.opening, "crack opening [µm]")
