"""Pictures that pages show by name: those of Fissura, of other packages, and of the running program."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from matplotlib.figure import Figure

from fissura.pictures.attempted import attempted
from fissura.pictures.curves import DPI
from fissura.pictures.lettering import rendered


@dataclass(frozen=True)
class Picture:
    """A picture for the page of a run or of an ensemble.

    Attributes
    ----------
    draw : callable
        Draws a `Result`, or an `EnsembleResult`; None where there is nothing to draw.
    caption : str
        Its title on the page.
    text : str, optional
        What to say below it.
    """

    draw: Callable[[Any], Figure | None]
    caption: str
    text: str = ""


def drawn(registry: Mapping[str, Picture], result: Any) -> Iterator[tuple[str, Picture, bytes | None]]:
    """Draw all pictures of a registry.

    Parameters
    ----------
    registry : mapping of str to Picture
        By name.
    result : Result or EnsembleResult
        What is drawn.

    Yields
    ------
    name : str
        Its name.
    picture : Picture
        What it is.
    data : bytes or None
        PNG; None where there is nothing to draw. One that cannot be drawn is left out, with a warning.
    """
    for name in registry:
        picture = attempted(f"{name}.png", partial(registry.__getitem__, name))
        if picture is None:
            continue
        figure = attempted(f"{name}.png", partial(picture.draw, result))
        if figure is None:
            yield name, picture, None
            continue
        data = attempted(f"{name}.png", partial(rendered, figure, form="png", dpi=DPI))
        if data is not None:
            yield name, picture, data
