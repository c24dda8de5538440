"""NumPy archives with a format name and version, and without pickled objects."""

import io
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.files.atomic import replacing
from fissura.files.text import check_file

#: Largest archive that is read.
_MOST_BYTES = 20_000_000_000

SAMPLE = 1 << 16
"""Bytes at its start by which an array is judged."""

SHRUNK = 0.85
"""Compressed part of this sample above which an array is stored as it is."""


def write_archive(path: Path, name: str, version: int, arrays: Mapping[str, Any], *, compress: bool = True) -> None:
    """Write arrays as ``.npz``, never leaving half a file; arrays that hardly shrink are stored as they are.

    Parameters
    ----------
    path : Path
        File to write.
    name, version : str, int
        Name and version of the format, kept as ``format`` and ``format_version``.
    arrays : mapping of str to array or number
        Content.
    compress : bool
        Whether to compress those that shrink.
    """
    with replacing(path) as part, zipfile.ZipFile(part, "w") as archive:
        for key, value in {"format": name, "format_version": version, **arrays}.items():
            values, buffer = np.asanyarray(value), io.BytesIO()
            np.lib.format.write_array(buffer, values, allow_pickle=False)
            kind = zipfile.ZIP_DEFLATED if compress and level(values) else zipfile.ZIP_STORED
            archive.writestr(key + ".npy", buffer.getbuffer(), kind, compresslevel=1)


def read_archive(path: str | Path, name: str, version: int) -> dict[str, NDArray[Any]]:
    """Read all arrays of a file that `write_archive` wrote.

    Raises
    ------
    InputError
        The file is missing, is something else, or is newer than the given version of the format.
    """
    key, allowed = str(path), f"a {name} file of version 1 to {version}"
    check_file(Path(path), key, allowed, _MOST_BYTES)
    try:
        with np.load(io.BytesIO(Path(path).read_bytes()), allow_pickle=False) as archive:
            arrays = {member: archive[member] for member in archive.files}
    except (OSError, ValueError, EOFError) as error:
        raise InputError(key, "cannot be read", allowed) from error
    except Exception as error:  # zipfile and zlib raise many kinds for damaged archives
        raise InputError(key, f"is damaged ({error})", allowed) from error
    if str(arrays.get("format")) != name or int(arrays.get("format_version", 0)) > version:
        raise InputError(key, f"is of version {arrays.get('format_version', 'unknown')}", allowed)
    return arrays


def level(values: NDArray[Any]) -> int:
    """Level of zlib for an array: 1, or 0 (stored) when its start hardly shrinks.

    Higher levels take several times longer for a few per cent.
    """
    start = np.ascontiguousarray(values.reshape(-1)[: SAMPLE // values.itemsize]).data
    return 1 if len(zlib.compress(start, 1)) < SHRUNK * start.nbytes else 0
