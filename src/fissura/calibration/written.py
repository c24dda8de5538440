"""The calibrated case as a file that runs: the user's own file, with the values that were found in their places."""

import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError

from fissura.calibration.problem import Problem
from fissura.case import Case, case_from_dict
from fissura.case.changed import parts_of_key, value_at
from fissura.errors import InputError

#: Keys that hold paths of files.
_FILES = ("output.measured", "discretization.nuclei", "specimen.mesh")

#: How far a value may be from that of the file, which has four digits.
_NEAR = 1e-3


def files_of(problem: Problem) -> dict[str, str]:
    """Names of the files of calibrated cases, by test."""
    if len(problem.tests) == 1:
        return {problem.tests[0].name: "calibrated.toml"}
    return {test.name: f"calibrated_{test.name}.toml" for test in problem.tests}


def case_text(case: Case, changes: Mapping[str, Any], folder: Path) -> str:
    """A case with some values changed, as TOML.

    Where the case was read from a TOML file, it is that file, comments and all, with other values; else all values of
    the case, defaults resolved.

    Parameters
    ----------
    case : Case
        Before the changes.
    changes : mapping of str to value
        By dotted key, as a case file gives them.
    folder : Path
        Where the file will lie: files that it names are told from there.
    """
    wanted = case.with_(changes)
    paths = {key: _relative(path, folder) for key in _FILES if (path := value_at(wanted, key)) is not None}
    if case.source is not None:
        try:
            text = _edited(case.source, {**changes, **paths})
            if _same(text, wanted, folder, list(changes)):
                return text
        except (TOMLKitError, InputError, KeyError, TypeError, ValueError):
            pass  # the values of the case tell it, too
    data = wanted.model_dump(mode="json", exclude={"source", "ensemble"})
    for key, path in paths.items():
        table, name = key.split(".")
        data[table][name] = path
    return tomlkit.dumps(_without_none(data))


def _relative(path: Path, folder: Path) -> str:
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:  # another drive
        return str(path)


def _edited(source: str, changes: Mapping[str, Any]) -> str:
    document = tomlkit.parse(source)
    for key, value in changes.items():
        *outer, last = parts_of_key(key)
        table: Any = document
        for part in outer:
            if isinstance(part, str) and isinstance(table, list):
                (table,) = table
            if isinstance(part, str) and part not in table:
                table[part] = tomlkit.table()
            table = table[part]
        if isinstance(last, str) and isinstance(table, list):
            (table,) = table
        table[last] = value
        if key.startswith("material.macro.") and "E" in document["material"]:
            raise ValueError("constants of the contacts stand beside those of the whole")
    if "ensemble" in document:
        del document["ensemble"]
    return tomlkit.dumps(document)


def _same(text: str, wanted: Case, folder: Path, keys: list[str]) -> bool:
    """Whether a text is the wanted case, as far as the digits of its values go."""
    found = case_from_dict({**tomllib.loads(text), "name": wanted.name}, folder)
    for key in keys:
        here, there = value_at(found, key), value_at(wanted, key)
        if isinstance(there, int | float) and not abs(here - there) <= _NEAR * abs(there):
            return False
    return True


def _without_none(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_none(item) for key, item in value.items() if item is not None}
    return [_without_none(item) for item in value] if isinstance(value, list) else value
