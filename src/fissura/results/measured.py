"""Measured load bands to show next to a computed curve."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError

__all__ = ["MeasuredBand", "read_measured"]

KEY = "output.measured"


@dataclass(frozen=True)
class MeasuredBand:
    """Smallest and largest measured load over the gauge.

    Attributes
    ----------
    gauge : (k,) array
        Crack mouth opening [m], ascending.
    lower, upper : (k,) array
        Loads [N].
    """

    gauge: NDArray[np.float64]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]


def read_measured(path: str | Path) -> MeasuredBand:
    """Read a CSV file of columns ``cmod_mm,min_N,max_N``; lines that start with ``#`` are skipped.

    Raises
    ------
    InputError
        The file is missing or has a line that is not three numbers.
    """
    path = Path(path)
    rows = []
    try:
        with path.open(encoding="utf-8", newline="") as file:
            for number, line in enumerate(csv.reader(file), 1):
                if not line or line[0].lstrip().startswith("#"):
                    continue
                rows.append(_three(line, f"line {number} of {path}"))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(KEY, f"{path} cannot be read", "a CSV file of cmod_mm,min_N,max_N") from error
    if not rows:
        raise InputError(KEY, f"{path} holds no numbers", "a CSV file of cmod_mm,min_N,max_N")
    table = np.array(sorted(rows))
    return MeasuredBand(table[:, 0] * 1e-3, table[:, 1], table[:, 2])


def _three(line: list[str], where: str) -> tuple[float, float, float]:
    try:
        cmod, lower, upper = map(float, line)
    except ValueError:
        raise InputError(KEY, f"{where} is {','.join(line)!r}", "three numbers cmod_mm,min_N,max_N") from None
    return cmod, lower, upper
