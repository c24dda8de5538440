"""One run at a time in a folder: a lock that vanishes with its process, however that ends."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from fissura.errors import InputError
from fissura.files.folder import MARK

if os.name == "nt":
    import msvcrt
else:
    import fcntl

#: Where Windows locks, whose locks keep others from reading: far beyond the end of the file.
_BYTE = 1 << 30

#: What systems say of a lock that another one has.
_TAKEN = {errno.EAGAIN, errno.EACCES, errno.EDEADLK, errno.EWOULDBLOCK}


@contextmanager
def locked(folder: Path | None) -> Iterator[None]:
    """Keep other runs out of a folder of results, by a lock on its mark.

    File systems that know no locks, as some network ones, go without.

    Parameters
    ----------
    folder : Path or None
        The folder; it exists. None locks nothing.

    Raises
    ------
    InputError
        Another run has the lock, in this process or another one.
    OSError
        The mark cannot be opened.
    """
    if folder is None:
        yield
        return
    path = folder / MARK
    number = _opened(path)
    while not _is_there(path, number):  # another one has just removed it
        os.close(number)
        number = _opened(path)
    try:
        yield
    finally:
        if os.fstat(number).st_size == 0:  # nothing has been written there
            with suppress(OSError):
                path.unlink()
        os.close(number)


def _opened(path: Path) -> int:
    """Open a mark, made if need be, and lock it."""
    number = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    try:
        try_lock(number)
    except OSError as error:
        if taken_by_others(error):
            os.close(number)
            raise InputError(
                "output",
                f"another run is writing in {path.parent}",
                "another folder, or this one when that run has ended",
            ) from None
    return number


def _is_there(path: Path, number: int) -> bool:
    """Whether an open file is the one of this name."""
    try:
        return os.path.samestat(os.fstat(number), path.stat())
    except FileNotFoundError:
        return False


def try_lock(number: int) -> None:
    """Lock an open file, or raise an OSError; the lock vanishes with its process."""
    if os.name == "nt":
        os.lseek(number, _BYTE, os.SEEK_SET)
        msvcrt.locking(number, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
    else:
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)


def taken_by_others(error: OSError) -> bool:
    """Whether a lock failed because another one has it, and not because there are no locks."""
    return error.errno in _TAKEN
