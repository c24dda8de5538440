"""Which arrays are worth compressing: most real numbers are not, and trying costs more than all else in a file."""

from __future__ import annotations

import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["level"]

SAMPLE = 1 << 16
"""Bytes at its start by which an array is judged."""

SHRUNK = 0.85
"""Compressed part of this sample above which an array is stored as it is."""


def level(values: NDArray[Any]) -> int:
    """Level of zlib for an array: 1, or 0 (stored) when its start hardly shrinks.

    Higher levels take several times longer for a few per cent.
    """
    start = np.ascontiguousarray(values.reshape(-1)[: SAMPLE // values.itemsize]).data
    return 1 if len(zlib.compress(start, 1)) < SHRUNK * start.nbytes else 0
