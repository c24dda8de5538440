"""Folders of results: a mark says what a folder is and which files in it are ours, and nothing else is ever removed."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import Literal

from fissura.errors import InputError
from fissura.files.atomic import part_of

FolderKind = Literal["run", "ensemble", "study", "elastic", "calibration"]
"""What a folder of results is of."""

MARK = ".fissura"
"""Name of the mark: a text file whose first line says what the folder is of; each other one names a file in it, or,
with a stroke at its end, a folder with a mark of its own."""

_NAMES: dict[str, str] = {
    "run": "a run",
    "ensemble": "an ensemble",
    "study": "a study",
    "elastic": "fissura elastic",
    "calibration": "a calibration",
}

#: What names of folders cannot hold: signs of paths and shells, control characters, bytes that are not UTF-8.
_NOT_IN_NAMES = re.compile(r'[\x00-\x1f\x7f-\x9f<>:"/\\|?*\u2028\u2029\ud800-\udfff]')

#: Longest name of a folder, in characters and, since file systems count these, in bytes.
_LONGEST_NAME, _LONGEST_BYTES = 100, 240


def folder_name(text: str) -> str:
    """The nearest text that can name a folder on any machine; the same if it can."""
    clean = _NOT_IN_NAMES.sub("_", text)[:_LONGEST_NAME]
    clean = clean.encode()[:_LONGEST_BYTES].decode(errors="ignore")
    return clean if clean.strip(". ") else "case"


class Folder:
    """A folder with a mark.

    Parameters
    ----------
    path : Path
        The folder; it exists.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._known: set[str] | None = None

    @classmethod
    def begun(cls, path: Path, kind: FolderKind) -> Folder:
        """Mark a folder anew; what its mark listed before is removed, and nothing else.

        Raises
        ------
        OSError
            A file cannot be removed or written.
        """
        folder = cls(path)
        folder.clear()
        (path / MARK).write_text(f"fissura {kind} 1\n", encoding="utf-8")
        return folder

    @classmethod
    def kept(cls, path: Path, kind: FolderKind) -> Folder:
        """Go on with a folder, and mark it if it is not yet."""
        folder = cls(path)
        if not (path / MARK).exists() or _is_nothing(path / MARK):
            (path / MARK).write_text(f"fissura {kind} 1\n", encoding="utf-8")
        return folder

    def add(self, *names: str) -> None:
        """List files that are about to be written, by their paths in the folder with ``/`` between."""
        if self._known is None:
            self._known = set(self.names())
        new = [name for name in dict.fromkeys(names) if name not in self._known]
        if new:
            self._known.update(new)
            with (self.path / MARK).open("a", encoding="utf-8") as mark:
                mark.write("".join(f"{name}\n" for name in new))

    def own(self, *names: str) -> Path:
        """List files that are about to be written, and return the path of the first one."""
        self.add(*names)
        return self.path / names[0]

    def names(self) -> Iterator[str]:
        """What the mark lists; nothing without one."""
        yield from _lines(self.path / MARK)[1:]

    def clear(self) -> None:
        """Remove what the mark lists, and folders that are empty then."""
        parents: set[Path] = set()
        for name in list(self.names()):
            path = self._inside(name)
            if path is None:
                continue
            for one in (path, part_of(path)):
                if name.endswith("/"):
                    Folder(one).remove()
                elif one.is_symlink() or one.is_file():
                    one.unlink()
            parents.update(parent for parent in path.parents if self.path in parent.parents)
        for parent in sorted(parents, key=lambda parent: -len(parent.parts)):
            with contextlib.suppress(OSError):
                parent.rmdir()

    def remove(self) -> None:
        """Remove what the mark lists, the mark, and the folder if nothing is left in it."""
        if not self.path.is_dir():
            return
        self.clear()
        (self.path / MARK).unlink(missing_ok=True)
        with contextlib.suppress(OSError):
            self.path.rmdir()

    def _inside(self, name: str) -> Path | None:
        """Path of a name, unless it or a link leads out of the folder."""
        parts = PurePosixPath(name).parts
        if not parts or ".." in parts or PurePosixPath(name).is_absolute():
            return None
        path = self.path.joinpath(*parts)
        led_out = any(parent.is_symlink() for parent in path.parents if self.path in parent.parents)
        return None if led_out or (name.endswith("/") and path.is_symlink()) else path


def kind_of(path: Path) -> str | None:
    """What a folder is of, by its mark; None for any other folder."""
    lines = _lines(path / MARK)
    return lines[0].split()[1] if lines else None


def prepare_folder(
    folder: str | Path, kind: FolderKind = "run", *, overwrite: bool = False, go_on: bool = False
) -> Path:
    """Make sure that results can be written into a folder, before anything is computed.

    Parameters
    ----------
    folder : path
        Made if it does not exist.
    kind : {"run", "ensemble", "study", "elastic", "calibration"}, optional
        What the results are of.
    overwrite : bool, optional
        Whether it may hold results of this kind already. They are left alone here.
    go_on : bool, optional
        Whether results of this kind in it are to be continued.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    InputError
        If the folder cannot be made or written to, or holds what must not be overwritten: anything without permission,
        and whatever is not of this kind with it.
    """
    folder = Path(folder)
    try:
        if folder.is_dir() and any(not _is_nothing(path) for path in folder.iterdir()):
            _check(folder, kind, overwrite=overwrite, go_on=go_on)
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except FileExistsError:
        raise InputError("output", f"{folder} is a file", "a folder") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError("output", f"cannot write in {folder}: {reason}", "a writable folder") from None
    return folder


def copied(source: Path, target: str | Path, kind: FolderKind, *, overwrite: bool = False) -> Path:
    """Copy results, and nothing else that lies beside them, to another folder.

    Parameters
    ----------
    source : Path
        Folder of results.
    target : path
        New or empty, or with earlier results of this kind to be replaced.
    kind : {"run", "ensemble", "study", "elastic", "calibration"}
        What the results are of.
    overwrite : bool, optional
        Whether the target may hold earlier results.

    Returns
    -------
    Path
        The target.

    Raises
    ------
    InputError
        The target holds something else, or results without permission to replace them, is the source itself, or cannot
        be written.
    OSError
        A file cannot be written.
    """
    folder = prepare_folder(target, kind, overwrite=overwrite)
    if folder.resolve() == source.resolve():
        raise InputError("save", f"{folder} is the folder of the {kind} itself", "another folder")
    copy_files(Folder(source), Folder.begun(folder, kind))
    return folder


def copy_files(source: Folder, target: Folder, last: str = "") -> None:
    """Copy what a folder lists into another one, folders with all that is in them, and the file with this name last."""
    for name in sorted(dict.fromkeys(source.names()), key=lambda name: name == last):
        old = source.path / name
        if not old.exists():
            continue
        new = target.own(name)
        new.parent.mkdir(parents=True, exist_ok=True)
        if old.is_dir():
            shutil.copytree(old, new, dirs_exist_ok=True)
        else:
            shutil.copy2(old, new)


def _is_nothing(path: Path) -> bool:
    """Whether this is a mark without content: of a run that was killed before it wrote anything."""
    return path.name == MARK and path.is_file() and path.stat().st_size == 0


def _check(folder: Path, kind: FolderKind, *, overwrite: bool, go_on: bool) -> None:
    found = kind_of(folder)
    if found == kind and (overwrite or go_on):
        return
    if found == kind:
        raise InputError("output", f"{folder} is not empty", "a new or empty folder, or --overwrite")
    holds = f"results of {_NAMES[found]}" if found in _NAMES else "files that Fissura did not write"
    allowed = f"a new or empty folder, or one with results of {_NAMES[kind]}"
    if not overwrite and not go_on:
        raise InputError("output", f"{folder} is not empty; it holds {holds}", "a new or empty folder")
    raise InputError("output", f"{folder} holds {holds}, which are not replaced", allowed)


def claimed(path: Path, option: str) -> Path:
    """List a picture in the mark of the result folder that it is put into without being asked for there.

    Parameters
    ----------
    path : Path
        The picture.
    option : str
        The option that would put it somewhere else.

    Raises
    ------
    InputError
        There is such a file, and Fissura did not write it.
    """
    if kind_of(path.parent) is None:
        return path
    folder = Folder(path.parent)
    if os.path.lexists(path) and path.name not in folder.names():
        raise InputError(option, f"{path} is there, and Fissura did not write it", "another name")
    folder.add(path.name)
    return path


def _lines(mark: Path) -> list[str]:
    """Lines of a mark; none if there is none, or it is not ours. A last line that was cut off is left out."""
    try:
        text = mark.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return []
    lines = text.split("\n")[:-1]
    head = lines[0].split() if lines else []
    return lines if len(head) == 3 and head[0] == "fissura" and head[1] in _NAMES else []
