"""Functions that every run needs, with the types they are compiled for, and how long each takes.

The list, ``known.json``, is written by ``benchmarks/kernels.py``. Helpers compile what is on it; a function that is
not on it, or with other types, is compiled when it is called.
"""

import functools
import gc
import importlib
import json
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

from numba.core import types as _types

types: Any = _types  # has no types

_FILE = Path(__file__).with_name("known.json")


class Known(NamedTuple):
    """A function that every run needs.

    Attributes
    ----------
    name : str
        Module and name.
    seconds : float
        Time to compile it, with those that it calls, on the machine on which the list was made [s].
    types : list
        Its arguments' types, as `types_in_words` writes them.
    """

    name: str
    seconds: float
    types: list[Any]


@functools.cache
def _read() -> tuple[float, tuple[Known, ...]]:
    found = json.loads(_FILE.read_text(encoding="utf-8"))
    return found["pace"], tuple(Known(*row) for row in found["kernels"])


def known() -> tuple[Known, ...]:
    """The list, longest first."""
    return _read()[1]


def missing_seconds(folder: Path | None) -> float:
    """Time to compile what every run needs and is not in the folder, one after another on this machine [s]."""
    there = set() if folder is None else {path.name.rpartition("-")[0] for path in folder.glob("*.kernel")}
    missing = sum(one.seconds for one in known() if not _is_there(one, there))
    return missing * pace() / _read()[0] if missing else 0.0


def _is_there(one: Known, there: set[str]) -> bool:
    """Whether a function has been compiled: of modules that are not loaded, names of files alone are looked at."""
    module, _, name = one.name.rpartition(".")
    if f"{module.rpartition('.')[2]}.{name}" not in there:
        return False
    if module not in sys.modules:
        return True
    found: Any = getattr(sys.modules[module], name, None)  # None of an old list
    return not hasattr(found, "_cache") or found._cache.is_there(signature(one), found.targetctx)


def dispatcher(one: Known) -> Any:
    """The function itself; its module is imported."""
    module, _, name = one.name.rpartition(".")
    return getattr(importlib.import_module(module), name)


def pace() -> float:
    """Time [s] of some work like that of a compiler: how fast this machine is, now."""
    best, collecting = float("inf"), gc.isenabled()
    gc.disable()  # what it costs depends on all else there is
    for _ in range(3):
        begin, found = time.perf_counter(), {}
        for k in range(10_000):
            found[str(k)] = [k, (k, k)]
        best = min(best, time.perf_counter() - begin)
    if collecting:
        gc.enable()
    return best


def signature(one: Known) -> tuple[Any, ...]:
    """Types of the arguments, as numba has them."""
    return tuple(map(_type, one.types))


def _type(words: Any) -> Any:
    if isinstance(words, str):
        return types.NumPyRandomGeneratorType(words) if words.startswith("NumPy") else getattr(types, words)
    kind, *rest = words
    if kind == "array":
        dtype, axes, layout, mutable = rest
        return types.Array(_type(dtype), axes, layout, readonly=not mutable)
    items = tuple(map(_type, rest[1:]))
    if kind == "tuple":
        return types.BaseTuple.from_types(items)
    module, _, name = rest[0].rpartition(".")
    return types.BaseTuple.from_types(items, getattr(importlib.import_module(module), name))


def types_in_words(kinds: tuple[Any, ...]) -> list[Any]:
    """Types as text and lists of text, for the list.

    Raises
    ------
    TypeError
        One of them has no place in the list.
    """
    return [_words(kind) for kind in kinds]


def _words(kind: Any) -> Any:
    if isinstance(kind, types.Array) and kind.aligned:
        return ["array", _words(kind.dtype), kind.ndim, kind.layout, kind.mutable]
    if isinstance(kind, types.BaseNamedTuple):
        made = kind.instance_class
        return ["named", f"{made.__module__}.{made.__qualname__}", *map(_words, kind)]
    if isinstance(kind, types.BaseTuple):
        return ["tuple", "", *map(_words, kind)]
    if isinstance(kind, types.Number | types.Boolean | types.NumPyRandomGeneratorType):
        return kind.name
    raise TypeError(f"{kind} has no place in the list")
