"""Reading case files."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fissura.case.files import MOST_BYTES, read_text
from fissura.case.model import Case, folder_name
from fissura.case.report import input_error
from fissura.errors import InputError

__all__ = ["case_from_dict", "case_of", "load_case", "read_case_file", "read_json", "read_toml"]

ALLOWED = "a case file (TOML, UTF-8), or the case.json of a run"

_DEPTH, _TOO_DEEP = 20, "is nested too deeply"

#: A key of more parts than tables may be deep. The parser's memory grows with the square of their number.
_PART = r"""(?>[\w-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_MANY_PARTS = re.compile(rf"(?<![\w-])(?>{_PART}[ \t]*+\.[ \t]*+){{{_DEPTH}}}")


def case_from_dict(data: Mapping[str, Any], folder: str | Path = ".", *, files_exist: bool = True) -> Case:
    """Validate a case given as nested dictionaries.

    Parameters
    ----------
    data : mapping
        Tables and keys as in a case file; it is not changed.
    folder : path, optional
        Folder to which files named in the case are relative.
    files_exist : bool, optional
        Whether a file named in the case must exist; False to look at the case of an old run.

    Returns
    -------
    Case
        Validated case, SI numbers.

    Raises
    ------
    InputError
        If anything is wrong; the error names the first key, what is allowed, and counts further problems.

    Examples
    --------
    >>> tables["control"] = {"target": "50 um"}
    >>> fissura.case_from_dict(tables).control.target
    5e-05
    """
    try:
        return Case.model_validate(dict(data), context={"folder": Path(folder), "files_exist": files_exist})
    except ValidationError as error:
        raise input_error(error, Case, data) from None


def load_case(path: str | Path) -> Case:
    """Read and validate a case file.

    Parameters
    ----------
    path : path
        TOML file, UTF-8; or JSON, if its name ends so, such as the ``case.json`` in the folder of a run.

    Returns
    -------
    Case
        Validated case; its name is the stem of the file unless the file gives one.

    Raises
    ------
    InputError
        If the file cannot be read, is not TOML or JSON, or anything in it is wrong.

    Examples
    --------
    >>> fissura.load_case("examples/beam_d100.toml").name
    'beam_d100'
    """
    path = Path(path)
    text, data = read_case_file(path)
    data.setdefault("name", folder_name(path.stem))
    case = case_from_dict(data, path.parent)
    if text is not None:
        case.__dict__["source"] = text
    return case


def case_of(given: Case | Mapping[str, Any] | str | Path) -> Case:
    """The case that is meant: itself, tables as of `case_from_dict`, or the file that `load_case` reads.

    Raises
    ------
    InputError
        As these do.
    """
    if isinstance(given, Case):
        return given
    return case_from_dict(given) if isinstance(given, Mapping) else load_case(given)


def read_case_file(path: Path) -> tuple[str | None, dict[str, Any]]:
    """Read the tables of a case file; its text comes along when it is TOML.

    Raises
    ------
    InputError
        If the file cannot be read, or is not TOML or JSON.
    """
    if path.suffix.lower() == ".json":
        tables: dict[str, Any] = read_json(path)
        return None, tables
    return read_toml(path)


def read_toml(path: Path, allowed: str = ALLOWED) -> tuple[str, dict[str, Any]]:
    """Read a file of tables, with or without the byte order mark that some editors write.

    Parameters
    ----------
    path : Path
        TOML file, UTF-8.
    allowed : str, optional
        What it should be, for the message.

    Returns
    -------
    text : str
        What the file says.
    tables : dict
        Its tables.

    Raises
    ------
    InputError
        If the file cannot be read or is not TOML.
    """
    text = read_text(path, str(path), allowed)
    if found := _MANY_PARTS.search(text):
        line = text.count("\n", 0, found.start()) + 1
        raise InputError(str(path), f"has a key of more than {_DEPTH} parts in line {line}", allowed)
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        problem = f"is not TOML: {error}"
    except RecursionError:
        problem = _TOO_DEEP
    except ValueError as error:  # a number that Python refuses to read
        problem = _long_number(text) or f"cannot be read: {error}"
    else:
        if not _too_deep(tables):
            return text, tables
        problem = _TOO_DEEP
    raise InputError(str(path), problem, allowed)


def read_json(path: Path, allowed: str = ALLOWED, *, tables: bool = True, most: int = MOST_BYTES) -> Any:
    """Read a file of tables in JSON, such as the ``case.json`` of a run.

    Parameters
    ----------
    path : Path
        JSON file, UTF-8.
    allowed : str, optional
        What it should be, for the message.
    tables : bool, optional
        Whether anything but tables by name is refused.
    most : int, optional
        Most bytes that the file may have.

    Raises
    ------
    InputError
        If the file cannot be read or is not JSON.
    """
    text = read_text(path, str(path), allowed, most)
    try:
        found = json.loads(text)
    except json.JSONDecodeError as error:
        problem = f"is not JSON: {error}"
    except RecursionError:
        problem = _TOO_DEEP
    except ValueError as error:
        problem = _long_number(text) or f"cannot be read: {error}"
    else:
        problem = "" if isinstance(found, dict) or not tables else "does not hold tables"
        problem = _TOO_DEEP if _too_deep(found) else problem
        if not problem:
            return found
    raise InputError(str(path), problem, allowed)


def _too_deep(value: Any) -> bool:
    """Whether tables and lists are nested deeper than any case needs; what walks through them may recurse then."""
    level = [value] if isinstance(value, (dict, list)) else []
    for _ in range(_DEPTH):
        level = [
            item
            for outer in level
            for item in (outer.values() if isinstance(outer, dict) else outer)
            if isinstance(item, (dict, list))
        ]
        if not level:
            return False
    return True


def _long_number(text: str) -> str:
    """Where a number stands that is longer than any float; empty where none does."""
    for number, line in enumerate(text.splitlines(), 1):
        if found := re.search(r"[0-9_]{1000,}", line):
            return f"has a number of {len(found[0])} digits in line {number}"
    return ""
