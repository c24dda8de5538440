"""Compiled functions that Python runs as long as their work is small: compiling, or loading, would take longer."""

import functools
from collections.abc import Callable
from types import FunctionType
from typing import Any

from fissura.kernels.stamp import referred


def compiled_when_large(work: Callable[..., int], most: int) -> Callable[[Any], Any]:
    """Decorate a kernel that only Python calls, so that Python runs it until its work has added up.

    Results are the same, bit for bit, so it does not matter when this is.

    Parameters
    ----------
    work : callable
        From the arguments of a call, how often its innermost loop passes, or some measure of that.
    most : int
        Work in a process from which on the kernel is compiled.
    """

    def decorated(kernel: Any) -> Any:
        done = 0

        @functools.wraps(getattr(kernel, "py_func", kernel))
        def run(*given: Any) -> Any:
            nonlocal done
            done += work(*given)
            return kernel(*given) if done > most else interpreted(kernel)(*given)

        return run

    return decorated


@functools.cache
def interpreted(kernel: Any) -> Any:
    """The same function, run by Python, with those that it calls.

    Parameters
    ----------
    kernel : compiled function
        Without options that change its results.

    Returns
    -------
    function
        It returns the same, bit for bit.
    """
    function = getattr(kernel, "py_func", None)
    if function is None:
        return kernel
    used = referred(function)
    own = {name: interpreted(value) if hasattr(value, "py_func") else value for name, value in used.items()}
    own["__builtins__"] = function.__globals__["__builtins__"]
    return FunctionType(function.__code__, own, function.__name__, function.__defaults__)
