"""Reading case files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fissura.case.model import Case
from fissura.case.report import input_error
from fissura.files.folder import folder_name
from fissura.files.tables import read_json, read_toml

ALLOWED = "a case file (TOML, UTF-8), or the case.json of a run"


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
        tables: dict[str, Any] = read_json(path, ALLOWED)
        return None, tables
    return read_toml(path, ALLOWED)
