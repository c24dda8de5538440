"""``curve.csv``, written one row after another."""

import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from fissura.files.atomic import csv_bytes, force, write_atomically
from fissura.results.curve import COLUMNS, COUNTS, Curve


class CurveWriter:
    """Writes ``curve.csv`` row by row, so that a run that is killed keeps its curve.

    Parameters
    ----------
    path : Path
        File to write; an older one is replaced.
    names : sequence of str
        Its columns.
    curve : dict of str to (steps,) array, optional
        Rows that it begins with.

    Raises
    ------
    OSError
        It cannot be written.
    """

    def __init__(self, path: Path, names: Sequence[str] = COLUMNS, curve: Curve | None = None) -> None:
        self._names = tuple(names)
        rows = () if curve is None else zip(*(curve[name] for name in self._names), strict=True)
        lines = [csv_bytes([self._names]), *(self._row(dict(zip(self._names, row, strict=True))) for row in rows)]
        write_atomically(path, b"".join(lines))
        self._file = path.open("ab", buffering=0)

    def _row(self, values: Mapping[str, float | str]) -> bytes:
        return csv_bytes([[_written(name, values[name]) for name in self._names]])

    def write(self, values: Mapping[str, float | str]) -> None:
        """Append one row and hand it to the operating system; a row that does not fit on the disk is not there at all.

        Raises
        ------
        OSError
            It cannot be written.
        """
        end, line = self._file.seek(0, os.SEEK_END), self._row(values)
        try:
            written = 0
            while written < len(line):
                written += self._file.write(line[written:])
        except OSError:
            with suppress(OSError):
                self._file.truncate(end)
            raise

    def close(self) -> None:
        """Force the file to the disk and close it; may be called twice."""
        if not self._file.closed:
            force(self._file.fileno())
            self._file.close()


def _written(name: str, value: float | str) -> str:
    if isinstance(value, str):
        return value
    return str(int(value)) if name in COUNTS else repr(float(value))
