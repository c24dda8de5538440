"""The table of all runs of an ensemble: ``runs.csv`` and ``runs.parquet``."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.files import write_atomically

__all__ = ["COLUMNS", "PAST_PEAK", "Table", "read_table", "select", "table", "write_table"]

Table = dict[str, NDArray[Any]]
"""Column name -> 1-D array, one entry per run; what is unknown is nan, -1 in a column of whole numbers, or ``""``."""

COLUMNS: dict[str, type] = {
    "kind": str,
    "number": int,
    "status": str,
    "seed": int,
    "field_seed": int,
    "peak_load_N": float,
    "gauge_at_peak_m": float,
    "past_peak": bool,
    "load_at_end_N": float,
    "gauge_at_end_m": float,
    "dissipated_energy_J": float,
    "initial_stiffness_N_per_m": float,
    "bodies_start": int,
    "bodies_end": int,
    "bodies_full": int,
    "steps": int,
    "crack_start_x_m": float,
    "crack_start_y_m": float,
    "crack_start_z_m": float,
    "crack_start_gauge_m": float,
    "crack_start_load_N": float,
    "max_elastic_utilisation": float,
    "cpu_s": float,
    "wall_s": float,
    "error": str,
}
"""Columns in order, with their types; the part after the last underscore is the unit, if there is one."""

PAST_PEAK = 0.8
"""A run is past its peak when the magnitude of its last load is at most this part of that of its peak."""

_UNKNOWN: dict[type, Any] = {str: "", int: -1, float: math.nan, bool: False}


def table(summaries: Iterable[Mapping[str, Any]]) -> Table:
    """Table of runs.

    Parameters
    ----------
    summaries : iterable of mapping
        Contents of their ``summary.json``.
    """
    rows = [_row(summary) for summary in summaries]
    return {
        name: np.array([_UNKNOWN[kind] if row[name] is None else row[name] for row in rows], dtype=_dtype(kind))
        for name, kind in COLUMNS.items()
    }


def _row(summary: Mapping[str, Any]) -> dict[str, Any]:
    about = summary.get("realisation", {})
    start = about.get("crack_start") or {}
    peak, end = summary.get("peak_load_N"), about.get("load_at_end_N")
    known = {name: summary.get(name) for name in COLUMNS}
    return known | {
        "kind": about.get("kind"),
        "number": about.get("number"),
        "field_seed": about.get("field_seed"),
        "load_at_end_N": end,
        "past_peak": peak is not None and end is not None and abs(end) <= PAST_PEAK * abs(peak),
        "error": summary.get("message"),
        **{f"crack_start_{name}": start.get(name) for name in ("x_m", "y_m", "z_m", "gauge_m", "load_N")},
    }


def select(rows: Table, chosen: NDArray[np.bool_]) -> Table:
    """The rows for which a condition holds, shape (runs,)."""
    return {name: column[chosen] for name, column in rows.items()}


def write_table(rows: Table, folder: Path) -> None:
    """Write ``runs.csv``, and ``runs.parquet`` with unknown values as nulls.

    Raises
    ------
    InputError
        pyarrow, which writes Parquet, is not installed.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for k in range(len(rows["number"])):
        writer.writerow([_written(rows[name][k], kind) for name, kind in COLUMNS.items()])
    write_atomically(folder / "runs.csv", text.getvalue().encode())

    pyarrow, parquet = _parquet()
    arrays = {
        name: pyarrow.array([_plain(value, kind) for value in rows[name]], _arrow(kind))
        for name, kind in COLUMNS.items()
    }
    buffer = pyarrow.BufferOutputStream()
    parquet.write_table(pyarrow.table(arrays), buffer)
    write_atomically(folder / "runs.parquet", buffer.getvalue().to_pybytes())


def read_table(path: str | Path) -> Table:
    """Read ``runs.csv`` or ``runs.parquet``, or the former of an ensemble's folder.

    Raises
    ------
    InputError
        The file is missing, or is something else.
    """
    path = Path(path)
    if path.is_dir():
        path = path / "runs.csv"
    allowed = "the runs.csv or runs.parquet of an ensemble"
    try:
        if path.suffix == ".parquet":
            columns = _parquet()[1].read_table(io.BytesIO(path.read_bytes())).to_pydict()
        else:
            with path.open(encoding="utf-8", newline="") as file:
                names, *lines = csv.reader(file)
            columns = {name: [line[k] for line in lines] for k, name in enumerate(names)}
        return {
            name: np.array([_read(value, kind) for value in columns[name]], dtype=_dtype(kind))
            for name, kind in COLUMNS.items()
        }
    except OSError as error:
        raise InputError(str(path), "cannot be read", allowed) from error
    except (ValueError, KeyError, IndexError) as error:
        raise InputError(str(path), f"is not a table of runs ({error})", allowed) from error


def _parquet() -> tuple[Any, Any]:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise InputError("pyarrow", "is not installed", "pip install fissura[ensemble]") from error
    return pyarrow, pyarrow.parquet


def _arrow(kind: type) -> str:
    return {str: "string", int: "int64", float: "double", bool: "bool"}[kind]


def _dtype(kind: type) -> type:
    return {str: np.str_, int: np.int64, float: np.float64, bool: np.bool_}[kind]


def _plain(value: Any, kind: type) -> Any:
    """Python value, None for unknown."""
    plain = kind(value)
    unknown = plain == -1 if kind is int else kind is float and math.isnan(plain)
    return None if unknown else plain


def _written(value: Any, kind: type) -> str:
    plain = _plain(value, kind)
    if plain is None:
        return ""
    return str(plain).lower() if kind is bool else repr(plain) if kind is float else str(plain)


def _read(value: Any, kind: type) -> Any:
    if value is None or (value == "" and kind is not str):
        return _UNKNOWN[kind]
    return value == "true" if kind is bool and isinstance(value, str) else kind(value)
