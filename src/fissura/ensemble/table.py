"""The table of all runs of an ensemble: ``runs.csv`` and ``runs.parquet``."""

import csv
import io
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.files.atomic import csv_bytes, write_atomically

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

STUDY: dict[str, type] = {"point": int, "realisation": int}
"""Further columns of parameter studies, followed by one for each varied key: numbers in SI units, or text."""

PAST_PEAK = 0.8
"""A run is past its peak when the magnitude of its last load is at most this part of that of its peak."""

#: Of each type of column: what is unknown, types of NumPy and of Arrow.
_UNKNOWN: dict[type, Any] = {str: "", int: -1, float: math.nan, bool: False}
_DTYPES: dict[type, type] = {str: np.str_, int: np.int64, float: np.float64, bool: np.bool_}
_ARROW = {str: "string", int: "int64", float: "double", bool: "bool"}


def table(summaries: Iterable[Mapping[str, Any]]) -> Table:
    """Table of runs.

    Parameters
    ----------
    summaries : iterable of mapping
        Contents of their ``summary.json``.
    """
    rows, values = [], []
    for summary in summaries:
        rows.append(_row(summary))
        values.append(summary.get("realisation", {}).get("values") or {})
    kinds = dict(COLUMNS)
    if any(values):
        varied = dict.fromkeys(key for value in values for key in value)
        texts = {key for value in values for key in value if isinstance(value[key], str)}
        kinds = _with_study({key: str if key in texts else float for key in varied})
    rows = [
        row | {key: str(v) if kinds[key] is str else v for key, v in value.items()}
        for row, value in zip(rows, values, strict=True)
    ]
    return {
        name: np.array([_UNKNOWN[kind] if row.get(name) is None else row[name] for row in rows], dtype=_DTYPES[kind])
        for name, kind in kinds.items()
    }


def _with_study(varied: Mapping[str, type]) -> dict[str, type]:
    """All columns of a parameter study: its own ones come after the number of the run."""
    head = {name: COLUMNS[name] for name in ("kind", "number")}
    return head | STUDY | dict(varied) | {name: kind for name, kind in COLUMNS.items() if name not in head}


def columns_of(rows: Table) -> dict[str, type]:
    """Columns of a table with their types, in order."""
    known = COLUMNS | STUDY
    return {name: known.get(name, str if column.dtype.kind == "U" else float) for name, column in rows.items()}


def varied_keys(rows: Table) -> list[str]:
    """Names of the columns of varied keys."""
    return [name for name in rows if name not in COLUMNS and name not in STUDY]


def _row(summary: Mapping[str, Any]) -> dict[str, Any]:
    about = summary.get("realisation", {})
    start = about.get("crack_start") or {}
    peak, end = summary.get("peak_load_N"), about.get("load_at_end_N")
    known = {name: summary.get(name) for name in COLUMNS}
    return known | {
        "kind": about.get("kind"),
        "number": about.get("number"),
        "point": about.get("point"),
        "realisation": about.get("realisation"),
        "field_seed": about.get("field_seed"),
        "load_at_end_N": end,
        "past_peak": peak is not None and end is not None and abs(end) <= PAST_PEAK * abs(peak),
        "error": summary.get("message"),
        **{f"crack_start_{name}": start.get(name) for name in ("x_m", "y_m", "z_m", "gauge_m", "load_N")},
    }


def select(rows: Table, chosen: NDArray[np.bool_]) -> Table:
    """The rows for which a condition holds, shape (runs,)."""
    return {name: column[chosen] for name, column in rows.items()}


def write_csv(rows: Table, path: Path, kinds: Mapping[str, type] | None = None) -> None:
    """Write a table as CSV; what is unknown is empty.

    Parameters
    ----------
    rows : Table
        At least one column.
    path : Path
        The file.
    kinds : mapping of str to type, optional
        Types of columns that the table of runs does not have; by default numbers and texts.
    """
    columns = columns_of(rows) | dict(kinds or {})
    lines = (
        [_written(value, kind) for value, kind in zip(values, columns.values(), strict=True)]
        for values in zip(*(rows[name] for name in columns), strict=True)
    )
    write_atomically(path, csv_bytes([list(columns), *lines]))


def write_table(rows: Table, folder: Path) -> None:
    """Write ``runs.csv``, and ``runs.parquet`` with unknown values as nulls.

    Raises
    ------
    InputError
        pyarrow, which writes Parquet, is not installed.
    """
    columns = columns_of(rows)
    write_csv(rows, folder / "runs.csv")
    pyarrow, parquet = _parquet()
    arrays = {
        name: pyarrow.array([_plain(value, kind) for value in rows[name]], _ARROW[kind])
        for name, kind in columns.items()
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
        kinds = dict(COLUMNS)
        if STUDY.keys() <= columns.keys():
            kinds = _with_study({name: _kind(columns[name]) for name in columns if name not in COLUMNS | STUDY})
        return {
            name: np.array([_read(value, kind) for value in columns[name]], dtype=_DTYPES[kind])
            for name, kind in kinds.items()
        }
    except OSError as error:
        raise InputError(str(path), "cannot be read", allowed) from error
    except (ValueError, KeyError, IndexError) as error:
        raise InputError(str(path), f"is not a table of runs ({error})", allowed) from error


def _kind(values: list[Any]) -> type:
    """Type of a column of a varied key, from what a file has in it."""
    try:
        for value in values:
            float(value or 0.0)
    except ValueError:
        return str
    return float


def _parquet() -> tuple[Any, Any]:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise InputError("pyarrow", "is not installed", "pip install fissura[ensemble]") from error
    return pyarrow, pyarrow.parquet


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
