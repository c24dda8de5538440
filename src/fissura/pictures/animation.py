"""Animation of a run: bodies grow finer, the crack opens, and the curve grows beside them."""

import errno
import logging
import os
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from matplotlib.animation import FFMpegWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from fissura.errors import InputError
from fissura.files.atomic import replacing
from fissura.pictures.curves import BLUE, GREY, INK, mark_point
from fissura.pictures.lettering import fit, literal, may_shrink
from fissura.pictures.panels import draw_curve, draw_scales
from fissura.pictures.side_view import Look, SideView, look_of
from fissura.results.history import Frame, read_history
from fissura.results.result import Result
from fissura.text import quantities as text

MOST_FRAMES = 100
"""A run of more steps is shown at this many of them."""

HOLD = 1.5
"""How long the last frame is shown before the animation begins again [s]."""

INCHES = 9.6
"""Width of the figure; text has its natural size at 960 pixels."""

FORMATS = (".gif", ".mp4")


def animate(
    folder: str | Path,
    path: str | Path,
    *,
    fps: int = 10,
    width: int = 960,
    stress: bool = False,
    most: int = MOST_FRAMES,
) -> int:
    """Write an animation of a run.

    Parameters
    ----------
    folder : str or Path
        Folder of the run's results.
    path : str or Path
        File to write: ``.gif``, or ``.mp4`` where the program ffmpeg is installed.
    fps : int, optional
        Frames per second. GIF counts in hundredths of a second.
    width : int, optional
        Width in pixels; the height follows from the specimen's shape. Both are made even.
    stress : bool, optional
        Colour bodies by their largest principal stress instead of showing which are fine.
    most : int, optional
        Most frames; see `chosen`.

    Returns
    -------
    int
        Number of frames: the unloaded structure and every step, or ``most``.

    Raises
    ------
    InputError
        The folder does not hold the results of a run that has ended, with its section; the ending of the file is none
        of the two; or ffmpeg is needed and missing, or fails.
    OSError
        The file cannot be written.

    Examples
    --------
    >>> animate(folder, "run.gif", width=320, most=3)
    3
    """
    path = Path(path)
    _check_format(path)
    every = read_history(folder)
    if not path.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path.parent))
    result, shown = Result.load(folder), [every[k] for k in chosen(every, most)]
    drawn = _drawn(result, shown, look_of(result.case, shown, stress=stress), width)
    with replacing(path) as part:
        if path.suffix.lower() == ".gif":
            _write_gif(drawn, part, fps)
        else:
            _write_mp4(drawn, part, fps)
    return len(shown)


def chosen(frames: Sequence[Frame], most: int = MOST_FRAMES) -> list[int]:
    """Which frames to show: all, or ``most`` spread evenly, among them the first and the last one."""
    if len(frames) <= most:
        return list(range(len(frames)))
    return [int(k) for k in np.unique(np.linspace(0, len(frames) - 1, most).round())]


def _check_format(path: Path) -> None:
    if path.suffix.lower() not in FORMATS:
        raise InputError("--output", f"{path}: {path.suffix or 'no ending'} is not known", "a name in .gif or .mp4")
    if path.suffix.lower() == ".mp4" and not FFMpegWriter.isAvailable():
        raise InputError("--output", f"{path}: the program ffmpeg is not installed", "a name in .gif, or ffmpeg")


def _drawn(result: Result, frames: Sequence[Frame], look: Look, width: int) -> Iterator[FigureCanvasAgg]:
    """One figure, set to show one frame after another."""
    canvas, stage, curve, (x_scale, y_scale) = _canvas(result, look, width)
    figure = canvas.figure
    for line in curve.get_lines():
        line.set(color=GREY, linewidth=1.2)
    grown = curve.plot([], [], color=BLUE, linewidth=2.0, zorder=4)[0]
    dot = mark_point(curve, [], [], zorder=5, markeredgewidth=1.7, clip_on=False)
    title = figure.text(0.012, 0.965, "", fontsize=11, fontweight="bold", color=INK, va="top")
    note = figure.text(0.988, 0.965, "", fontsize=10, color=INK, va="top", ha="right")
    may_shrink(title).set_text(literal(result.case.name))
    note.set_text(max((_note(frame) for frame in frames), key=len))
    fit(figure)
    value, load = np.append(0.0, result.controlled) * x_scale, np.append(0.0, result.load_values) * y_scale
    steps = np.append(0, result.curve["step"])
    for frame in frames:
        stage.show(frame)
        until = int(np.searchsorted(steps, frame.number, side="right"))
        grown.set_data(value[:until], load[:until])
        dot.set_data([frame.value * x_scale], [frame.load * y_scale])
        note.set_text(_note(frame))
        yield canvas


def _note(frame: Frame) -> str:
    return f"{text.length(frame.value)},  {text.force(frame.load)},  {text.count(frame.bodies)} bodies"


def _canvas(result: Result, look: Look, width: int) -> tuple[FigureCanvasAgg, SideView, Axes, tuple[float, float]]:
    """Figure with the specimen on the left, the curve on the right, and what colours mean below."""
    share = 0.64 if look.aspect > 1.5 else 0.54
    head, foot = 0.45, 0.72
    height = float(np.clip(share * INCHES / look.aspect + head + foot, 3.4, 7.0))
    figure = Figure(figsize=(INCHES, height), dpi=2 * (width // 2) / INCHES)
    figure.set_figheight(2 * round(0.5 * height * figure.dpi) / figure.dpi)
    high = (height - head - foot) / height
    stage = figure.add_axes((0.005, foot / height, share - 0.01, high))
    curve = figure.add_axes((share + 0.065, (foot + 0.25) / height, 0.92 - share, high - 0.25 / height))
    scales = draw_curve(curve, result)
    draw_scales(figure.add_axes((0.005, 0.0, share - 0.02, foot / height)), look, full=result.full, wide=True)
    return FigureCanvasAgg(figure), SideView(stage, result.case, look, thin=0.9), curve, scales


def _write_gif(drawn: Iterator[FigureCanvasAgg], path: Path, fps: int) -> None:
    """Write a GIF whose frames share one palette: a third smaller than with matplotlib's PillowWriter."""
    whole = []
    for canvas in drawn:
        canvas.draw()  # type: ignore[no-untyped-call]
        whole.append(Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy()))  # type: ignore[no-untyped-call]
    some = [*whole[:: max(len(whole) // 6, 1)][-6:], whole[-1]]
    width, height = whole[0].size
    mosaic = Image.new("RGB", (width, height * len(some)))
    for k, picture in enumerate(some):
        mosaic.paste(picture, (0, k * height))
    # Unlike a median cut, an octree keeps the colours of cracks and thin lines, which cover little of a picture.
    palette = mosaic.quantize(256, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    flat = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in whole]
    pause = max(round(100 / fps), 2) * 10
    durations = [pause] * (len(flat) - 1) + [max(int(1000 * HOLD), pause)]
    flat[0].save(path, format="GIF", save_all=True, append_images=flat[1:], duration=durations, loop=0, optimize=False)


def _write_mp4(drawn: Iterator[FigureCanvasAgg], path: Path, fps: int) -> None:
    """Write a film with ffmpeg; the last frame stays for as long as a GIF shows it."""
    figure = next(drawn).figure
    writer = FFMpegWriter(fps=fps, extra_args=["-vf", f"tpad=stop_mode=clone:stop_duration={HOLD}"])
    log = logging.getLogger("matplotlib.animation")
    level = log.level
    log.setLevel(logging.ERROR)  # what ffmpeg says is in the error below
    try:
        with writer.saving(figure, path, figure.dpi):
            writer.grab_frame()
            for _ in drawn:
                writer.grab_frame()
    except subprocess.CalledProcessError as error:
        problem = str(error.stderr).strip().splitlines()
        raise InputError(
            "--output", f"ffmpeg failed: {problem[-1] if problem else error.returncode}", "a .gif"
        ) from None
    finally:
        log.setLevel(level)
