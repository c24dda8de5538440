"""What may go wrong while a run computes, and what is said of it then."""

import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from fissura.errors import InputError, RunStopped
from fissura.linear import SingularMatrixError

#: What calculations of a discretization may end in without a fault of the program: a structure that does not hold
#: together, lengths that the law does not allow, numbers out of range, no memory.
FAILURES: tuple[type[Exception], ...] = (
    InputError,
    SingularMatrixError,
    ArithmeticError,
    np.linalg.LinAlgError,
    MemoryError,
)


def reason(error: Exception) -> str:
    """Say in a sentence why a run cannot go on after an error."""
    if isinstance(error, MemoryError):
        return "out of memory"
    if isinstance(error, SingularMatrixError):
        return f"the structure has become a mechanism: {error}"
    if isinstance(error, InputError):
        return str(error)
    frames = traceback.extract_tb(error.__traceback__)
    place = f" in {Path(frames[-1].filename).name}, line {frames[-1].lineno}" if frames else ""
    what = f"{type(error).__name__}: {error}{place}"
    if isinstance(error, FAILURES):
        return f"a calculation failed ({what})"
    return f"a fault of the program, please report it ({what})"


@contextmanager
def stopping(position: Callable[[], tuple[int, float, str]], *, refusing: bool = False) -> Iterator[None]:
    """Turn whatever goes wrong inside into `RunStopped`, so that what was computed before is kept.

    Interruptions by the user are none of this, and go through.

    Parameters
    ----------
    position : callable
        Gives the number of the step that cannot be completed, the value of the controlled quantity, and
        its unit.
    refusing : bool
        Nothing has been computed yet: `InputError` refuses the case, and goes through.

    Raises
    ------
    RunStopped
        From the error.
    """
    try:
        yield
    except RunStopped:
        raise
    except Exception as error:
        if refusing and isinstance(error, InputError):
            raise
        raise RunStopped(reason(error), *position()) from error
