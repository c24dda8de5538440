"""Compiled functions, kept on disk from run to run wherever that is possible, and never trusted blindly.

numba has a cache of its own. It gives up where neither the installation nor a home can be written to, and damaged files
end the process; it also takes a function for unchanged as long as its own file is, whatever becomes of those it calls;
and processes that need the same function compile it each.
"""

import functools
from pathlib import Path
from typing import Any

import numba
from numba.core import types as _types

from fissura.kernels.cache import Cache
from fissura.kernels.known import missing_seconds
from fissura.kernels.small import compiled_when_large
from fissura.kernels.state import process

__all__ = ["INNER", "compiled_when_large", "njit", "prepare_cache", "seconds_to_compile"]

types: Any = _types  # has no types

#: Options of functions that only compiled code calls: without a way in for others they are compiled in less time.
INNER: dict[str, Any] = {"no_cpython_wrapper": True}


def njit(**options: Any) -> Any:
    """Decorate a function as numba does, and keep what is compiled in the cache of this package.

    Parameters
    ----------
    **options
        Those of `numba.njit` but ``cache``, of which this is the replacement.
    """

    def decorated(function: Any) -> Any:
        how: dict[str, Any] = options | {"no_cfunc_wrapper": True}  # nothing calls kernels from C
        compiled: Any = numba.njit(**how)(function)
        if hasattr(compiled, "py_func"):  # else compiling is switched off
            compiled._cache = Cache(function, options)
            compiled.get_call_template = functools.partial(_call_template, compiled.get_call_template)
        return compiled

    return decorated


def _call_template(template: Any, args: Any, kws: Any) -> Any:
    """What numba calls a function by: one for all numbers of a type, and not one more for each that is written out."""
    return template(tuple(map(types.unliteral, args)), {name: types.unliteral(kind) for name, kind in kws.items()})


def prepare_cache(*, say: bool | None = None) -> Path | None:
    """Find the folder for compiled functions, before processes that will all need it are started, or in one of them.

    Where it is empty, helpers begin to fill it.

    Parameters
    ----------
    say : bool, optional
        Whether this process logs what users should know, as that there is nothing in the folder yet, and may start
        helpers; of many processes one is enough. None: as it was, and at first it does.

    Returns
    -------
    Path or None
        The folder, or None if nothing can be written anywhere.
    """
    here = process()
    if say is not None:
        here.say = say
    folder = here.folder
    if folder is None or next(folder.glob("*.kernel"), None) is None:
        here.announce()
    return folder


def seconds_to_compile() -> float:
    """About how long the first run would compile on this machine [s]; 0 where it need not."""
    return missing_seconds(process().folder)
