"""Digest of what decides the machine code of a function, so that changes are noticed."""

import functools
import hashlib
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any

import numpy as np


def stamp(function: FunctionType, options: dict[str, Any]) -> bytes:
    """Digest of options and sources of a function and of those that it calls, and of constants."""
    parts = {f"{key}={sorted(value) if isinstance(value, set) else value}" for key, value in options.items()}
    _gather(function, parts)
    return hashlib.sha256("\n".join(sorted(parts)).encode()).digest()


def _gather(function: FunctionType, parts: set[str]) -> None:
    """Collect what decides the machine code of a function, and of functions that it calls."""
    own = f"{function.__module__}.{function.__qualname__} {_source(function.__code__.co_filename)}"
    if own in parts:
        return
    parts.add(own)
    for name, value in referred(function).items():
        inner = getattr(value, "py_func", getattr(value, "_defn", None))  # compiled functions, and intrinsics
        if isinstance(inner, FunctionType):
            _gather(inner, parts)
        elif isinstance(value, int | float | str | tuple):
            parts.add(f"{function.__module__}.{name} = {value!r}")
        elif isinstance(value, np.ndarray):
            parts.add(f"{function.__module__}.{name} = {value.dtype} {value.shape} {value.tobytes()!r}")


def referred(function: FunctionType) -> dict[str, Any]:
    """Globals that a function uses, by name."""
    found = function.__globals__
    return {name: found[name] for name in _names(function.__code__) if name in found}


def _names(code: CodeType) -> Iterator[str]:
    """Names that a code uses, those in functions within it included."""
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)


@functools.cache
def _source(path: str) -> str:
    """Digest of a source file; its path where it cannot be read."""
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()
    except OSError:
        return path
