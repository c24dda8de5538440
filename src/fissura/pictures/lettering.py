"""Text in pictures: what users wrote stands there letter by letter, and lines end before they meet something."""

import io
import re
import warnings
from collections.abc import Iterable
from pathlib import Path
from weakref import WeakSet

from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.text import Text

from fissura.files.atomic import write_atomically

SMALLEST = 7.0
"""Letters of a line that does not fit shrink to this size [points]; then its middle is left out."""

GAP = 10.0
"""What a line keeps from the next thing on its right, and from the edge [points]."""

_marked: WeakSet[Text] = WeakSet()


def literal(text: str) -> str:
    """Text of a user for a picture: no part of it is taken for mathematics, a control character, or half a letter."""
    printed = re.sub(r"[\x00-\x1f\x7f]+", " ", text).encode(errors="replace").decode()
    return printed.replace("$", r"\$")


def may_shrink(text: Text) -> Text:
    """Mark a line, set flush left, that shrinks where there is no room for it; returns it."""
    _marked.add(text)
    return text


def legend_below(
    figure: Figure, entries: Iterable[tuple[Artist, str]], *, colour: str, most: int = 4, size: float = 8.5
) -> Legend:
    """Put a legend below everything, in as many columns as its names leave room for.

    Parameters
    ----------
    figure : Figure
        Where.
    entries : iterable of (Artist, str)
        What stands for a name, and the name, ready to be drawn.
    colour : str
        Of the letters.
    most : int, optional
        Most columns.
    size : float, optional
        Of the letters [points].
    """
    handles, names = zip(*entries, strict=True)
    longest = max(len(name) for name in names)
    # A letter is about 0.6 times as wide as it is high; the sign and the blanks round it take as much as five.
    columns = int(72.0 * figure.get_figwidth() / (0.6 * size * (longest + 5)))
    legend: Legend = figure.legend(
        handles,
        [f"{k}" for k in range(len(names))],
        loc="outside lower center",
        ncols=min(max(columns, 1), most),
        fontsize=size,
        frameon=False,
        labelcolor=colour,
    )
    for text, name in zip(legend.get_texts(), names, strict=True):
        text.set_text(name)  # a name that begins with a low line would be left out
    return legend


def fit(figure: Figure) -> None:
    """Shrink or shorten marked lines that would meet other text or leave the figure."""
    lines = [text for text in figure.findobj(Text) if text in _marked and text.get_visible() and text.get_text()]
    if not lines:
        return
    gap, words = GAP * figure.dpi / 72.0, [line.get_text() for line in lines]
    for line, text in zip(lines, words, strict=True):  # lines far too long would drive the layout mad
        line.set_text("\n".join("x" for _ in text.split("\n")))
    for _ in range(2):  # the layout of axes whose shape is fixed needs both
        figure.draw_without_rendering()
    figure.set_layout_engine("none")  # everything has its place now
    others = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]
    boxes = {id(artist): artist.get_window_extent() for artist in (*others, *figure.findobj(Legend))}
    for line, text in zip(lines, words, strict=True):
        line.set_text(text)
        own = boxes[id(line)]
        right = [box.x0 for box in boxes.values() if box.x0 > own.x0 + 1.0 and box.y0 < own.y1 and box.y1 > own.y0]
        _shrink(line, min([figure.bbox.x1, *right]) - gap - own.x0)


def _shrink(line: Text, width: float) -> None:
    """Make a line, or each of several, no wider than so many pixels."""
    while (whole := line.get_window_extent().width) > width:
        size = float(line.get_fontsize())
        if size <= SMALLEST:
            line.set_text("\n".join(_shortened(line, row, width) for row in line.get_text().split("\n")))
            return
        line.set_fontsize(max(0.99 * size * max(width, 0.0) / whole, SMALLEST))


def _shortened(line: Text, row: str, width: float) -> str:
    """A row, its middle left out as far as it must be, in the letters of a line."""
    whole, kept = row.replace(r"\$", "$"), len(row)
    while kept > 2:
        line.set_text(row)
        if line.get_window_extent().width <= width:
            break
        kept -= 1
        row = literal(f"{whole[: kept - kept // 2]}…{whole[len(whole) - kept // 2 :]}")
    return row


def rendered(figure: Figure, *, form: str | None, dpi: float) -> bytes:
    """The file that a figure makes, lines fitted.

    Parameters
    ----------
    figure : Figure
        What to draw.
    form : str or None
        Ending of the file, such as ``"png"``, which None stands for.
    dpi : float
        Pixels per inch.

    Raises
    ------
    ValueError
        The ending is not known.
    """
    buffer = io.BytesIO()
    # LaTeX, which a user may have set, would take low lines of names for mathematics.
    with rc_context({"text.usetex": False}), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from", UserWarning)
        for text in figure.findobj(Text):
            text.set_usetex(False)
        fit(figure)
        figure.savefig(buffer, format=form, dpi=dpi)
    return buffer.getvalue()


def save(figure: Figure, path: Path, dpi: float) -> None:
    """Write a figure, as a whole or not at all; the ending of the name decides the format.

    Raises
    ------
    ValueError
        The ending is not known.
    OSError
        The file cannot be written.
    """
    write_atomically(path, rendered(figure, form=path.suffix.lower().removeprefix(".") or None, dpi=dpi))
