"""Reading text files that a user names: cases, studies, measured loads, nuclei."""

import codecs
import stat
from pathlib import Path

from fissura.errors import InputError

#: Largest file of tables that is read; those that people write have thousands of bytes.
MOST_BYTES = 2_000_000

_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def read_text(path: Path, key: str, allowed: str, most: int = MOST_BYTES) -> str:
    """Read a text file, with or without the byte order mark that some editors write.

    Parameters
    ----------
    path : Path
        A regular file, UTF-8; what never ends, such as a device, or may never begin, such as a pipe, is not read.
    key : str
        Where the file is named, for messages.
    allowed : str
        What it should be, for messages.
    most : int, optional
        Most bytes that it may have.

    Raises
    ------
    InputError
        It cannot be read, is too large, or is not text.
    """
    content = read_bytes(path, key, allowed, most)
    if content.startswith(_UTF_16):
        raise InputError(key, f"{_named(path, key)}is UTF-16 text", f"{allowed}: save it as UTF-8")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(key, f"{_named(path, key)}is not UTF-8 text (byte {error.start})", allowed) from None


def read_bytes(path: Path, key: str, allowed: str, most: int) -> bytes:
    """Read a regular file of at most so many bytes; the other arguments and errors are those of `read_text`."""
    check_file(path, key, allowed, most)
    try:
        with path.open("rb") as file:
            content = file.read(most + 1)
    except OSError as error:
        raise InputError(key, f"{_named(path, key)}cannot be read: {error.strerror or error}", allowed) from None
    if len(content) > most:  # files of the system have no size
        raise InputError(key, f"{_named(path, key)}has more than {most / 1e6:.4g} MB", allowed)
    return content


def check_file(path: Path, key: str, allowed: str, most: int) -> None:
    """Refuse what is no regular file of at most so many bytes; arguments and errors are those of `read_bytes`."""
    try:
        status = path.stat()
    except FileNotFoundError:
        problem = "cannot be read: no such file"
    except OSError as error:
        problem = f"cannot be read: {error.strerror or error}"
    except ValueError as error:  # a null character in the path
        problem = f"cannot be read: {error}"
    else:
        if stat.S_ISREG(status.st_mode) and status.st_size <= most:
            return
        if stat.S_ISDIR(status.st_mode):
            problem = "is a folder"
        elif stat.S_ISREG(status.st_mode):
            problem = f"has {status.st_size / 1e6:.4g} MB, more than {most / 1e6:.4g} MB"
        else:
            problem = "is not a regular file"
    raise InputError(key, f"{_named(path, key)}{problem}", allowed)


def _named(path: Path, key: str) -> str:
    """The path, to begin a message whose key does not say it."""
    return "" if key == str(path) else f"{path} "
