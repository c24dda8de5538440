"""Files of tables, TOML or JSON: what is too large, too deep or no table is refused with its cause."""

import json
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fissura.errors import InputError
from fissura.files.text import MOST_BYTES, read_text

_DEPTH, _TOO_DEEP = 20, "is nested too deeply"

#: A key of more parts than tables may be deep. The parser's memory grows with the square of their number.
_PART = r"""(?>[\w-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_MANY_PARTS = re.compile(rf"(?<![\w-])(?>{_PART}[ \t]*+\.[ \t]*+){{{_DEPTH}}}")


def read_toml(path: Path, allowed: str) -> tuple[str, dict[str, Any]]:
    """Read a file of tables, with or without the byte order mark that some editors write.

    Parameters
    ----------
    path : Path
        TOML file, UTF-8.
    allowed : str
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
    return text, _parsed(path, text, tomllib.loads, "TOML", allowed)


def read_json(path: Path, allowed: str, *, tables: bool = True, most: int = MOST_BYTES) -> Any:
    """Read a file of tables in JSON, such as the ``case.json`` of a run.

    Parameters
    ----------
    path : Path
        JSON file, UTF-8.
    allowed : str
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
    found = _parsed(path, read_text(path, str(path), allowed, most), json.loads, "JSON", allowed)
    if tables and not isinstance(found, dict):
        raise InputError(str(path), "does not hold tables", allowed)
    return found


def _parsed(path: Path, text: str, parse: Callable[[str], Any], format_name: str, allowed: str) -> Any:
    """What a text says, or the message about it."""
    try:
        found = parse(text)
    except (tomllib.TOMLDecodeError, json.JSONDecodeError) as error:
        problem = f"is not {format_name}: {error}"
    except RecursionError:
        problem = _TOO_DEEP
    except ValueError as error:  # a number that Python refuses to read
        problem = _long_number(text) or f"cannot be read: {error}"
    else:
        if not _too_deep(found):
            return found
        problem = _TOO_DEEP
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
