"""Files of compiled functions: what numba's dispatchers ask of a cache."""

import contextlib
import functools
import hashlib
import os
import pickle
import platform
from pathlib import Path
from types import FunctionType
from typing import Any

import llvmlite
import numba
from numba.core import compiler as _compiler
from numba.core import serialize as _serialize

from fissura.kernels.claims import Claims
from fissura.kernels.stamp import stamp
from fissura.kernels.state import process

compiler: Any = _compiler  # these have no types
serialize: Any = _serialize

_HEAD = b"fissura kernel 1\n"
"""First bytes of a file; a digest of what was compiled and one of the rest follow, then the machine code."""

_STAMP, _DIGEST, _CODE = len(_HEAD), len(_HEAD) + 32, len(_HEAD) + 64
"""Where these begin."""

_claims = Claims()


class Cache:
    """One file for each function and signature.

    Parameters
    ----------
    function : function
        Whose machine code it keeps.
    options : dict
        How it is compiled.
    """

    def __init__(self, function: FunctionType, options: dict[str, Any]) -> None:
        self._function, self._options = function, options

    @property
    def cache_path(self) -> str | None:
        """Folder of the files."""
        folder = process().folder
        return None if folder is None else str(folder)

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Machine code for a signature; None if there is none that can be used, and this process is to compile it."""
        context.refresh()
        path = self._path(signature, context.codegen())
        found = self._rebuilt(path, context)
        if found is None and path is not None and _claims.take(path):
            found = self._rebuilt(path, context)  # by the process that had claimed it
            if found is not None:
                _claims.give_up(path)
        if found is None:
            process().miss()
        return found

    def _rebuilt(self, path: Path | None, context: Any) -> Any:
        found = None if path is None else self._read(path)
        if found is not None:
            with contextlib.suppress(Exception):
                return compiler.CompileResult._rebuild(context, *pickle.loads(found))
            process().damage()
        return None

    def _read(self, path: Path) -> bytes | None:
        """What `save_overload` wrote, if it is whole, and of this function as it is now."""
        try:
            data = path.read_bytes()
        except OSError:
            return None
        head, written, digest, code = data[:_STAMP], data[_STAMP:_DIGEST], data[_DIGEST:_CODE], data[_CODE:]
        if head != _HEAD or hashlib.sha256(written + code).digest() != digest:
            process().damage()
            return None
        return code if written == self._stamp else None

    def is_there(self, signature: Any, context: Any) -> bool:
        """Whether a file of this function as it is now exists, whole or not, or another process is making it."""
        path = self._path(signature, context.codegen())
        if path is None:
            return False
        with contextlib.suppress(OSError), path.open("rb") as file:
            if file.read(_DIGEST) == _HEAD + self._stamp:
                return True
        return _claims.is_taken(path)

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep machine code."""
        path = self._path(signature, result.codegen)
        if path is None:
            return
        if not result.lifted and not result.library.has_dynamic_globals:
            self._write(path, serialize.dumps(result._reduce()))
        _claims.give_up(path)

    def _write(self, path: Path, code: bytes) -> None:
        part = path.with_suffix(f".{os.getpid()}.part")
        try:
            part.write_bytes(_HEAD + self._stamp + hashlib.sha256(self._stamp + code).digest() + code)
            os.replace(part, path)
        except OSError as error:
            with contextlib.suppress(OSError):
                part.unlink(missing_ok=True)
            process().full(error)

    def enable(self) -> None:
        """Numba asks for it."""

    def disable(self) -> None:
        """Numba asks for it."""

    def flush(self) -> None:
        """Forget what is kept; it is written over anyway."""

    def _path(self, signature: Any, codegen: Any) -> Path | None:
        folder = process().folder
        if folder is None:
            return None
        versions = numba.__version__, llvmlite.__version__, platform.python_version(), codegen.magic_tuple()
        key = hashlib.sha256(repr((str(signature), versions)).encode()).hexdigest()[:16]
        return folder / f"{file_name(self._function)}-{key}.kernel"

    @functools.cached_property
    def _stamp(self) -> bytes:
        return stamp(self._function, self._options)


def file_name(function: FunctionType) -> str:
    """Beginning of the names of a function's files."""
    return f"{function.__module__.rpartition('.')[2]}.{function.__name__}"
