"""Locks of the system on open files, which vanish with their process."""

from __future__ import annotations

import errno
import os

if os.name == "nt":
    import msvcrt

    def try_lock(number: int) -> None:
        """Lock an open file, or raise an OSError."""
        os.lseek(number, _BYTE, os.SEEK_SET)
        msvcrt.locking(number, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]

else:
    import fcntl

    def try_lock(number: int) -> None:
        """Lock an open file, or raise an OSError."""
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)


__all__ = ["taken_by_others", "try_lock"]

#: Where Windows locks, whose locks keep others from reading: far beyond the end of the file.
_BYTE = 1 << 30

#: What systems say of a lock that another one has.
_TAKEN = {errno.EAGAIN, errno.EACCES, errno.EDEADLK, errno.EWOULDBLOCK}


def taken_by_others(error: OSError) -> bool:
    """Whether a lock failed because another one has it, and not because there are no locks."""
    return error.errno in _TAKEN
