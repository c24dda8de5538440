"""Drawing that may fail without an end to the run; Matplotlib, which takes long to import, is not needed for it."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import TypeVar

__all__ = ["attempted"]

T = TypeVar("T")

_log = logging.getLogger(__name__)


def attempted(name: str, draw: Callable[[], T]) -> T | None:
    """What drawing a picture returns; where it fails say so by its name, and go on with None.

    Results are worth more than pictures of them.
    """
    try:
        return draw()
    except Exception as error:
        _log.warning("%s was not drawn: %s", name, str(error) or type(error).__name__)
        return None
