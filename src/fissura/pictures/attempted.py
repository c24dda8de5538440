"""Drawing that may fail without an end to the run; Matplotlib, which takes long to import, is not needed for it."""

import logging
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")

_log = logging.getLogger(__name__)


def attempted(name: str, draw: Callable[[], T]) -> T | None:
    """Draw a picture; where that fails say so, and go on: results are worth more than pictures of them.

    Parameters
    ----------
    name : str
        Of the file, for the message.
    draw : callable
        Draws it.

    Returns
    -------
    Whatever `draw` returns, or None where it failed.
    """
    try:
        return draw()
    except Exception as error:
        _log.warning("%s was not drawn: %s", name, str(error) or type(error).__name__)
        return None
