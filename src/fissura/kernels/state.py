"""What the process knows of compiled functions: their folder, and what it has told the user."""

import functools
import logging
from pathlib import Path

from fissura.kernels import limits
from fissura.kernels.helpers import Helpers
from fissura.kernels.known import missing_seconds
from fissura.kernels.place import lasting, temporary

_log = logging.getLogger("fissura.kernels")


class State:
    """What the process knows of its cache."""

    say = True
    missed = 0
    told_slow = told_damage = told_full = False

    def __init__(self) -> None:
        self.helpers = Helpers()

    @functools.cached_property
    def folder(self) -> Path | None:
        """Where compiled functions are; looked for once."""
        found = lasting()
        if found is not None:
            return found
        folder = temporary()
        if self.say:
            _log.warning(
                "neither the installation nor the home folder can be written to: compiled kernels are %s"
                " (NUMBA_CACHE_DIR may name a folder that lasts)",
                f"kept in a temporary folder, {folder}" if folder else "not kept, and every start makes them anew",
            )
        return folder

    def miss(self) -> None:
        """Count a function that has to be compiled."""
        self.missed += 1
        if self.missed == limits.TOLD_AT:
            self.announce()

    def announce(self) -> None:
        """Say once that much is compiled, and let other processes help, if it is much."""
        if self.told_slow or not self.say:
            return
        self.told_slow = True
        seconds = missing_seconds(self.folder)
        if seconds < limits.SHORT:
            return
        processes = 1 if self.folder is None else self.helpers.start()
        about = 5 * max(round(seconds / processes / 5), 1)
        often = "at every start" if self.folder is None else "once"
        # A warning only in that it is shown where nobody has asked for messages, as in notebooks.
        _log.warning("compiling kernels (%s, about %d s)", often, about, extra={"note": True})

    def damage(self) -> None:
        """Say once that a file is damaged."""
        if not self.told_damage and self.say:
            _log.warning(
                "files of compiled kernels are damaged and are made anew; if this is said again, delete the folder %s",
                self.folder,
            )
        self.told_damage = True

    def full(self, error: OSError) -> None:
        """Say once that files cannot be written."""
        if not self.told_full and self.say:
            _log.warning("compiled kernels cannot be kept in %s: %s", self.folder, error.strerror or error)
        self.told_full = True


@functools.cache
def process() -> State:
    """What this process knows."""
    return State()
