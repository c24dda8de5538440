"""Processes that compile what every run needs, while the first run goes on and compiles what it needs first."""

import atexit
import contextlib
import os
import subprocess
import sys

from fissura.kernels import limits
from fissura.kernels.place import PACKAGE
from fissura.machine.threads import usable_processors

_CODE = "import sys; sys.path.insert(0, sys.argv[1]); from fissura.kernels.helping import help_out; help_out()"


class Helpers:
    """Helpers of this process; they end with it."""

    def __init__(self) -> None:
        self._running: list[subprocess.Popen[bytes]] = []

    def start(self) -> int:
        """Start one for every further processor, some at most; tells how many processes compile now, this one too."""
        count = min(usable_processors() - 1, limits.MOST_HELPERS) if sys.executable else 0
        for _ in range(count):
            with contextlib.suppress(OSError):
                self._running.append(_started())
        if self._running:
            atexit.register(self.stop)
        return 1 + len(self._running)

    def stop(self) -> None:
        """End them."""
        for one in self._running:
            one.kill()
            one.wait()
        self._running.clear()


def _started() -> subprocess.Popen[bytes]:
    command = [sys.executable, "-c", _CODE, str(PACKAGE.parent)]
    hidden = getattr(subprocess, "CREATE_NO_WINDOW", 0)  # a flag of Windows
    silent = subprocess.DEVNULL
    # Its input ends when this process does, however that happens.
    return subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=silent,
        stderr=silent,
        start_new_session=os.name == "posix",
        creationflags=hidden,
    )
