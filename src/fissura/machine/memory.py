"""Memory that this machine has, and what to say where it does not suffice."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil

from fissura.errors import InputError


def physical_memory() -> float:
    """Memory [bytes] that a process may use: of the machine, or of the container it runs in if less."""
    total = float(psutil.virtual_memory().total)
    for name in ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"):
        try:
            total = min(total, float(Path(name).read_text()))
        except (OSError, ValueError):  # not Linux, or no limit
            continue
    return total


@contextmanager
def within_memory(key: str, what: str, allowed: str) -> Iterator[None]:
    """Turn a lack of memory into the message about the key that asks for so much.

    Parameters
    ----------
    key : str
        Key of the case.
    what : str
        What memory is lacking for.
    allowed : str
        What would need less.

    Raises
    ------
    InputError
        In place of a MemoryError.
    """
    try:
        yield
    except MemoryError:
        machine = gigabytes(physical_memory())
        raise InputError(key, f"there is not enough memory for {what}; this machine has {machine}", allowed) from None


def gigabytes(number: float) -> str:
    """Write a number of bytes as ``2.9 GB``."""
    return f"{number / 1e9:.2g} GB" if number < 1e11 else f"{number / 1e9:.0f} GB"
