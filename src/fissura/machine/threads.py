"""How many threads a process uses: environment variables that limit them, for processes that run side by side."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

from fissura.case.types import whole
from fissura.case.units import show
from fissura.errors import InputError
from fissura.text.quantities import counted

#: Environment variable that says how many threads to use where a case does not, for programs that start many runs.
VARIABLE = "FISSURA_THREADS"

#: It, and those of libraries that start threads of their own.
LIMITS = (
    VARIABLE,
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "NUMBA_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)


def usable_processors() -> int:
    """Processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def side_by_side(option: str, value: int) -> int:
    """A number of processes or threads that this machine can run at a time, as a whole number of Python.

    Parameters
    ----------
    option : str
        What asks for them, for the message.
    value : int
        How many.

    Raises
    ------
    InputError
        It is no whole number, or so large that they only stand in each other's way.
    """
    number, most = whole(value), max(8, 4 * usable_processors())
    if number is None or not 1 <= number <= most:
        processors = counted(usable_processors(), "processor")
        raise InputError(option, f"{show(value)} is not possible with {processors}", f"a whole number, 1 to {most}")
    return number


@contextmanager
def threads_each(count: int = 1) -> Iterator[None]:
    """Let processes that start inside use so many threads each, unless the user's environment says otherwise.

    Parameters
    ----------
    count : int, optional
        Threads of a process.
    """
    added = [name for name in LIMITS if name not in os.environ]
    os.environ.update(dict.fromkeys(added, str(count)))
    try:
        yield
    finally:
        for name in added:
            os.environ.pop(name, None)
