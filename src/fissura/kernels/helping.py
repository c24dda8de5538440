"""What the processes do that `Helpers` starts: they compile what every run needs."""

import contextlib
import os
import sys
import threading

from fissura.kernels.known import dispatcher, known, signature
from fissura.kernels.state import process


def help_out() -> None:
    """Compile what every run needs and no other process has begun, longest first."""
    process().say = False
    threading.Thread(target=_wait_for_the_end, daemon=True).start()
    for one in known():
        with contextlib.suppress(Exception):  # an old list, say: then it is compiled when it is called
            function, kinds = dispatcher(one), signature(one)
            if not function._cache.is_there(kinds, function.targetctx):
                function.compile(kinds)


def _wait_for_the_end() -> None:
    with contextlib.suppress(OSError):
        sys.stdin.buffer.read()
    os._exit(0)
