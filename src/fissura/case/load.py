"""Reading case files."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fissura.case.model import Case
from fissura.case.report import input_error
from fissura.errors import InputError

__all__ = ["case_from_dict", "load_case"]

ALLOWED = "a case file (TOML, UTF-8)"


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
        TOML file, UTF-8.

    Returns
    -------
    Case
        Validated case; its name is the stem of the file unless the file gives one.

    Raises
    ------
    InputError
        If the file cannot be read, is not TOML, or anything in it is wrong.
    """
    path = Path(path)
    text = _read_text(path)
    data = _parse_toml(text, path)
    data.setdefault("name", re.sub(r'[\x00-\x1f<>:"/\\|?*]', "_", path.stem)[:100])
    case = case_from_dict(data, path.parent)
    case.__dict__["source"] = text
    return case


def _read_text(path: Path) -> str:
    """Content of a text file, without the byte order mark that some editors write."""
    where = str(path)
    try:
        raw = path.read_bytes()
    except FileNotFoundError:
        raise InputError(where, "no such file", ALLOWED) from None
    except IsADirectoryError:
        raise InputError(where, "is a folder", ALLOWED) from None
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        reason = getattr(error, "strerror", None) or error
        raise InputError(where, f"cannot be read: {reason}", ALLOWED) from None
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(where, f"is not UTF-8 text (byte {error.start})", ALLOWED) from None


def _parse_toml(text: str, path: Path) -> dict[str, Any]:
    """Tables of a TOML text."""
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise InputError(str(path), "is nested too deeply", ALLOWED) from None
    except ValueError as error:
        raise InputError(str(path), f"is not TOML: {error}", ALLOWED) from None
