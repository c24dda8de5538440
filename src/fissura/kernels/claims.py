"""Which process compiles a function, so that others wait for it instead of compiling the same one.

A claim is a lock of the system on a file beside that of the function, so that it vanishes with its process.
"""

import contextlib
import os
import time
from pathlib import Path

from fissura.files.lock import taken_by_others, try_lock
from fissura.kernels import limits


class Claims:
    """Claims of this process."""

    def __init__(self) -> None:
        self._open: dict[Path, int] = {}

    def take(self, kernel: Path) -> bool:
        """Claim the file of a function, once another process has given up its claim; tells whether one had.

        Where there can be no locks, or no files, nothing is claimed, and nobody waits.
        """
        waited = False
        while kernel not in self._open:
            try:
                number = os.open(_lock(kernel), os.O_RDWR | os.O_CREAT, 0o600)
            except OSError:
                break
            try:
                try_lock(number)
            except OSError as error:
                os.close(number)
                if not taken_by_others(error):
                    break
                waited = True
                time.sleep(limits.LOOK)
            else:
                self._open[kernel] = number
        return waited

    def is_taken(self, kernel: Path) -> bool:
        """Whether another process has claimed a file."""
        try:
            number = os.open(_lock(kernel), os.O_RDWR)
        except OSError:
            return False
        try:
            try_lock(number)
        except OSError as error:
            return taken_by_others(error)
        finally:
            os.close(number)
        return False

    def give_up(self, kernel: Path) -> None:
        """Let others have a file."""
        number = self._open.pop(kernel, None)
        if number is not None:
            with contextlib.suppress(OSError):  # Windows removes no file that others have open
                _lock(kernel).unlink()
            os.close(number)


def _lock(kernel: Path) -> Path:
    return kernel.with_suffix(".lock")
