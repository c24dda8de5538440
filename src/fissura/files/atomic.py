"""Files that are there as a whole or not at all, whatever ends the program or the machine."""

import csv
import errno
import io
import json
import math
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

#: What file systems say that cannot force anything to their disk, as some network ones.
_CANNOT_SYNC = {errno.EINVAL, errno.ENOTSUP, errno.ENOSYS}


def part_of(path: Path) -> Path:
    """Name under which a file is written before it takes its place; it has the same ending."""
    return path.with_name(f".{path.stem}.part{path.suffix}")


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Write a file under another name, force it to the disk, and only then move it into its place.

    What was in its place stays there until then, and for good where writing fails. A link is kept; the file that it
    points at is replaced.

    Parameters
    ----------
    path : Path
        The file. Its folder must exist.

    Yields
    ------
    Path
        Where to write.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    path = Path(os.path.realpath(path))
    if path.exists() and not path.is_file() and not path.is_dir():
        yield path  # a device or a pipe, which is not to be replaced by a file
        return
    part = part_of(path)
    try:
        yield part
        with part.open("rb+") as file:
            force(file.fileno())
        os.replace(part, path)
    except BaseException as error:
        part.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.filename == str(part):
            error.filename = str(path)  # the user knows no other name
        raise
    sync_folder(path.parent)


def sync_folder(folder: Path) -> None:
    """Force the names of the files in a folder to the disk, where the system lets one do that."""
    if os.name == "nt":
        return
    number = os.open(folder, os.O_RDONLY)
    try:
        force(number)
    finally:
        os.close(number)


def force(number: int) -> None:
    """Force an open file to the disk, where its file system can do that."""
    try:
        os.fsync(number)
    except OSError as error:
        if error.errno not in _CANNOT_SYNC:
            raise


def write_atomically(path: Path, data: bytes) -> None:
    """Write a whole file, or leave what was there; see `replacing`."""
    with replacing(path) as part:
        part.write_bytes(data)


def plain(value: Any) -> Any:
    """What strict JSON can hold: scalars and arrays of NumPy as Python has them, None for what is no finite number."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, Mapping):
        return {name: plain(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def csv_bytes(rows: Iterable[Iterable[Any]]) -> bytes:
    """Rows of cells as CSV in UTF-8, each ended by a line feed."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()


def write_json(path: Path, data: Any) -> None:
    """Write strict JSON (no NaN) in UTF-8; see `replacing`."""
    try:
        text = json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False).encode()
    except UnicodeEncodeError:
        # A file name that is not UTF-8 has halves of characters, which only escapes can tell.
        text = json.dumps(data, indent=2, allow_nan=False).encode()
    write_atomically(path, text + b"\n")
