"""Work shared by threads in fixed pieces, so that results do not depend on how many threads there are."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fissura.case.units import show
from fissura.errors import InputError
from fissura.machine.threads import VARIABLE, usable_processors

#: Large structures fall into so many domains, and more threads would wait for memory.
_MOST = 4

#: Most threads that may be asked for, in the environment as in a case.
_MOST_ASKED = 10_000


def _usual() -> int:
    """Threads where nothing is asked for."""
    asked = os.environ.get(VARIABLE)
    if asked is None:
        return min(usable_processors(), _MOST)
    if not asked.isascii() or not asked.isdigit() or len(asked) > 5 or not 1 <= int(asked) <= _MOST_ASKED:
        raise InputError(VARIABLE, f"{show(asked)} is not a number of threads", f"a whole number, 1 to {_MOST_ASKED}")
    return int(asked)


class KernelThreads:
    """Threads that run compiled kernels which release Python's global lock.

    Threads of Python cost nothing to compile, and some 20 µs to start a piece, which is little for large structures;
    small ones have one piece only and never start a thread.

    Parameters
    ----------
    threads : int
        Most threads to work at a time; 0 means what the environment variable FISSURA_THREADS says, else one for each
        processor that this process may use, four at most.

    Raises
    ------
    InputError
        The environment variable is not a number of threads.
    """

    def __init__(self, threads: int = 0) -> None:
        self.count = threads if threads > 0 else _usual()
        self._pool: ThreadPoolExecutor | None = None

    def run(self, kernel: Callable[..., Any], bounds: Sequence[int] | NDArray[np.int64], *rest: Any) -> list[Any]:
        """Call ``kernel(begin, end, *rest)`` for each piece between two bounds; results in the order of the pieces.

        Pieces may run at the same time: none may write what another one reads or writes.
        """
        if len(bounds) == 2:
            return [kernel(bounds[0], bounds[1], *rest)]
        pieces = list(pairwise(bounds))
        if self.count == 1:
            return [kernel(begin, end, *rest) for begin, end in pieces]
        if self._pool is None:
            # The calling thread does its share.
            self._pool = ThreadPoolExecutor(self.count - 1, thread_name_prefix="fissura")
        waiting = [self._pool.submit(kernel, begin, end, *rest) for begin, end in pieces[1:]]
        out = [kernel(*pieces[0], *rest)]
        for (begin, end), task in zip(reversed(pieces[1:]), reversed(waiting), strict=True):
            out.insert(1, kernel(begin, end, *rest) if task.cancel() else task.result())
        return out


#: No further threads.
SINGLE_THREAD = KernelThreads(1)
