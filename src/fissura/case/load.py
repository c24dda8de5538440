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

__all__ = ["case_from_dict", "load_case", "read_toml"]

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
    text, data = read_toml(path)
    data.setdefault("name", re.sub(r'[\x00-\x1f<>:"/\\|?*]', "_", path.stem)[:100])
    case = case_from_dict(data, path.parent)
    case.__dict__["source"] = text
    return case


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
    where = str(path)
    try:
        text = path.read_bytes().decode("utf-8-sig")
        return text, tomllib.loads(text)
    except FileNotFoundError:
        problem = "no such file"
    except IsADirectoryError:
        problem = "is a folder"
    except OSError as error:
        problem = f"cannot be read: {error.strerror or error}"
    except UnicodeDecodeError as error:
        problem = f"is not UTF-8 text (byte {error.start})"
    except tomllib.TOMLDecodeError as error:
        problem = f"is not TOML: {error}"
    except RecursionError:
        problem = "is nested too deeply"
    except ValueError as error:  # a null character in the path, a number of thousands of digits
        problem = f"cannot be read: {error}"
    raise InputError(where, problem, allowed)
