"""What the folder of an ensemble holds, whatever has happened to it since: nothing in it makes the rest unreadable."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from fissura.ensemble.task import Key, Kind
from fissura.errors import InputError
from fissura.files.tables import read_json
from fissura.files.text import read_bytes
from fissura.results.summary import read_summary

FOLDERS: dict[Kind, str] = {"companion": "companions", "run": "runs"}
"""Folder of the realisations of each kind."""

#: Names that are told of one kind; more would hide the other messages.
_TOLD = 5

#: Largest curve that is read.
_MOST_BYTES = 500_000_000


@dataclass(frozen=True)
class Kept:
    """What is in the folder of an ensemble.

    Attributes
    ----------
    summaries : dict of (kind, number) to dict
        Summaries of the realisations that are whole; companions first, in order of number.
    broken : dict of Path to str
        Folders of realisations with a file that cannot be read, and what is wrong.
    strangers : tuple of Path
        What lies between the realisations and is none.
    """

    summaries: dict[Key, dict[str, Any]]
    broken: dict[Path, str]
    strangers: tuple[Path, ...]

    @property
    def again(self) -> set[Key]:
        """Realisations that failed for a reason that may have gone."""
        return {key for key, summary in self.summaries.items() if summary["realisation"].get("again")}

    @property
    def done(self) -> set[Key]:
        """Realisations that need not be computed."""
        return set(self.summaries) - self.again

    def notes(self) -> Iterator[str]:
        """What to tell a user who goes on with this folder."""
        for path, reason in list(self.broken.items())[:_TOLD]:
            yield f"{path}: {reason}; this realisation counts as missing and is computed again"
        if len(self.broken) > _TOLD:
            yield f"{len(self.broken) - _TOLD} more realisations cannot be read and are computed again"
        if self.strangers:
            names = ", ".join(map(str, self.strangers[:_TOLD])) + (", ..." if len(self.strangers) > _TOLD else "")
            yield f"no realisation of this ensemble, and left alone: {names}"


def kept(folder: Path) -> Kept:
    """Look through the folder of an ensemble.

    Parameters
    ----------
    folder : Path
        The folder; it may lack what it should hold.
    """
    summaries: dict[Key, dict[str, Any]] = {}
    broken, strangers = {}, []
    for kind in get_args(Kind):
        places = sorted((folder / FOLDERS[kind]).glob("[!.]*"))  # those with a dot are not finished
        for place in places:
            number = int(place.name) if re.fullmatch(r"[0-9]{4,9}", place.name) else -1
            if place.name != f"{number:04d}" or not place.is_dir():
                strangers.append(place)
                continue
            try:
                summaries[kind, number] = _whole(place, kind, number)
            except InputError as error:
                broken[place] = f"{Path(error.key).name} {error.problem}"
    order = sorted(summaries, key=lambda key: (key[0] == "run", key[1]))
    return Kept({key: summaries[key] for key in order}, broken, tuple(strangers))


def _whole(place: Path, kind: Kind, number: int) -> dict[str, Any]:
    """Summary of a realisation all of whose files can be read.

    Raises
    ------
    InputError
        One of them cannot; the key is its path.
    """
    path = place / "summary.json"
    summary = read_summary(path)
    about = summary.get("realisation")
    if not isinstance(about, dict) or not isinstance(summary.get("status"), str):
        raise InputError(str(path), "is not of a realisation")
    if (about.get("kind"), about.get("number")) != (kind, number):
        raise InputError(str(path), f"is of {about.get('kind')} {about.get('number')}")
    read_json(place / "case.json", "the case.json of a Fissura run")
    path = place / "curve.csv"
    curve = read_bytes(path, str(path), "the curve.csv of a Fissura run", _MOST_BYTES)
    # A line for each step and one of names: a curve that lost its end has fewer.
    if curve.count(b"\n") != 1 + (summary.get("steps") or 0) or b"\0" in curve:
        raise InputError(str(path), "is damaged")
    return summary
