"""Whether a folder of many runs may be gone on with: it must have been begun with what is asked for now."""

import json
from collections.abc import Set
from pathlib import Path
from typing import Any

from fissura.case.continued import changes
from fissura.errors import InputError
from fissura.files.folder import FolderKind, prepare_folder
from fissura.results.summary import read_summary

_NAMES: dict[FolderKind, str] = {"ensemble": "an ensemble", "calibration": "a calibration"}


def head_of(folder: Path, kind: FolderKind) -> dict[str, Any]:
    """What a folder says it was begun with: its ``ensemble.json`` or ``calibration.json``.

    Raises
    ------
    InputError
        There is none, or it is broken.
    """
    path = folder / f"{kind}.json"
    if not path.is_file():
        raise InputError("--resume", f"{folder} has no {path.name}", f"the folder of {_NAMES[kind]}")
    return read_summary(path)


def folder_for(output: str | Path, kind: FolderKind, *, resume: bool, overwrite: bool) -> Path:
    """The folder of many runs, ready to be written to.

    Parameters
    ----------
    output : path
        The folder.
    kind : {"ensemble", "calibration"}
        What the runs are of.
    resume, overwrite : bool
        Whether to go on with what is there, or to replace it.

    Raises
    ------
    InputError
        It holds something else, or nothing to go on with.
    """
    if resume and overwrite:
        raise InputError("--resume", "is given together with --overwrite", "one of them")
    if resume:
        head_of(Path(output), kind)
    return prepare_folder(output, kind, overwrite=overwrite, go_on=resume)


def check_same(folder: Path, before: Any, now: Any, free: Set[str] = frozenset()) -> None:
    """Make sure that what is asked for is what a folder was begun with.

    Parameters
    ----------
    folder : Path
        For the message.
    before, now : dict
        Plain data: what decides the numbers.
    free : set of str
        Names at the top that may differ.

    Raises
    ------
    InputError
        Something differs; the message names the first key.
    """
    change = next(changes(before, json.loads(json.dumps(now)), free), None)
    if change is not None:
        raise InputError("--resume", change.removeprefix("case."), f"what {folder} was begun with, or --overwrite")
