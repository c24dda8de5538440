"""Compiled functions, kept on disk from run to run wherever that is possible, and never trusted blindly.

numba has a cache of its own. It gives up where neither the installation nor a home can be written to, and damaged files
end the process; it also takes a function for unchanged as long as its own file is, whatever becomes of those it calls.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import logging
import os
import pickle
import platform
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any

import llvmlite
import numba
import numpy as np
from numba.core import compiler as _compiler
from numba.core import config as _config
from numba.core import serialize as _serialize
from numba.core import types as _types
from numba.misc.appdirs import AppDirs as _AppDirs

__all__ = ["INNER", "njit", "prepare_cache"]

AppDirs: Any = _AppDirs  # these have no types
compiler: Any = _compiler
config: Any = _config
serialize: Any = _serialize
types: Any = _types

_log = logging.getLogger(__name__)

PACKAGE = Path(__file__).parent

#: Options of functions that only compiled code calls: without a way in for others they are compiled in less time.
INNER: dict[str, Any] = {"no_cpython_wrapper": True}

_SAID_AT = 2
"""Function that is not in the cache, counted from the start, at which compiling is announced: one alone is quick."""

_HEAD = b"fissura kernel 1\n"
"""First bytes of a file; a digest of what was compiled and one of the rest follow, then the machine code."""

_STAMP, _DIGEST, _CODE = len(_HEAD), len(_HEAD) + 32, len(_HEAD) + 64
"""Where these begin."""


def njit(**options: Any) -> Any:
    """Decorate a function as numba does, and keep what is compiled in the cache of this package.

    Parameters
    ----------
    **options
        Those of `numba.njit` but ``cache``, of which this is the replacement.
    """

    def decorated(function: Any) -> Any:
        compiled: Any = numba.njit(**options, no_cfunc_wrapper=True)(function)  # nothing calls kernels from C
        if hasattr(compiled, "py_func"):  # else compiling is switched off
            compiled._cache = _Cache(function, options)
            compiled.get_call_template = functools.partial(_call_template, compiled.get_call_template)
        return compiled

    return decorated


def _call_template(template: Any, args: Any, kws: Any) -> Any:
    """What numba calls a function by: one for all numbers of a type, and not one more for each that is written out."""
    return template(tuple(map(types.unliteral, args)), {name: types.unliteral(kind) for name, kind in kws.items()})


def prepare_cache(*, say: bool = True) -> Path | None:
    """Find the folder for compiled functions, before processes that will all need it are started, or in one of them.

    Parameters
    ----------
    say : bool, optional
        Whether this process logs what users should know, as that there is nothing in the folder yet; of many processes
        one is enough.

    Returns
    -------
    Path or None
        The folder, or None if nothing can be written anywhere.
    """
    _state.say = say
    folder = _state.folder
    if folder is None or next(folder.glob("*.kernel"), None) is None:
        _state.announce()
    return folder


class _State:
    """What the process knows of its cache."""

    say = True
    missed = 0
    told_slow = told_damage = told_full = False

    @functools.cached_property
    def folder(self) -> Path | None:
        """Where compiled functions are; looked for once."""
        lasting = next(filter(_usable, _lasting()), None)
        if lasting is not None:
            return lasting
        folder = _temporary()
        if self.say:
            _log.warning(
                "neither the installation nor the home folder can be written to: compiled kernels are %s"
                " (NUMBA_CACHE_DIR may name a folder that lasts)",
                f"kept in a temporary folder, {folder}" if folder else "not kept, and every start makes them anew",
            )
        return folder

    def miss(self) -> None:
        """Count a function that has to be compiled."""
        self.missed += 1
        if self.missed == _SAID_AT:
            self.announce()

    def announce(self) -> None:
        """Say once that much is compiled."""
        if not self.told_slow and self.say:
            _log.info("compiling kernels, for this run and all later ones: a minute or more")
        self.told_slow = True

    def damage(self) -> None:
        """Say once that a file is damaged."""
        if not self.told_damage and self.say:
            _log.warning(
                "files of compiled kernels are damaged and are made anew; if this is said again, delete the folder %s",
                self.folder,
            )
        self.told_damage = True

    def full(self, error: OSError) -> None:
        """Say once that files cannot be written."""
        if not self.told_full and self.say:
            _log.warning("compiled kernels cannot be kept in %s: %s", self.folder, error.strerror or error)
        self.told_full = True


_state = _State()


def _lasting() -> Iterator[Path]:
    """Folders that last, the best one first."""
    mine = hashlib.sha256(os.fsencode(PACKAGE)).hexdigest()[:12]
    if config.CACHE_DIR:
        yield Path(config.CACHE_DIR) / f"fissura_{mine}"
    yield PACKAGE / "__pycache__" / "kernels"
    yield Path(AppDirs(appname="fissura", appauthor=False).user_cache_dir) / f"kernels_{mine}"


def _usable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _temporary() -> Path | None:
    """A folder that lasts until somebody tidies up, and that nobody else can write to: it holds code."""
    user = os.getuid() if hasattr(os, "getuid") else os.environ.get("USERNAME", "user")
    try:
        folder = Path(tempfile.gettempdir()) / f"fissura_kernels_{user}"
        with contextlib.suppress(FileExistsError):
            folder.mkdir(mode=0o700)
        if _is_mine(folder) and _usable(folder):
            return folder
        return Path(tempfile.mkdtemp(prefix="fissura_kernels_"))
    except OSError:
        return None


def _is_mine(folder: Path) -> bool:
    found = folder.lstat()
    mine = not hasattr(os, "getuid") or (found.st_uid == os.getuid() and not found.st_mode & 0o022)
    return mine and stat.S_ISDIR(found.st_mode)


class _Cache:
    """What numba's dispatchers ask of a cache: one file for each function and signature.

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
        return None if _state.folder is None else str(_state.folder)

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Machine code for a signature; None if there is none that can be used."""
        context.refresh()
        path = self._path(signature, context.codegen())
        found = None if path is None else self._read(path)
        if found is not None:
            with contextlib.suppress(Exception):
                return compiler.CompileResult._rebuild(context, *pickle.loads(found))
            _state.damage()
        _state.miss()
        return None

    def _read(self, path: Path) -> bytes | None:
        """What `save_overload` wrote, if it is whole, and of this function as it is now."""
        try:
            data = path.read_bytes()
        except OSError:
            return None
        head, stamp, digest, code = data[:_STAMP], data[_STAMP:_DIGEST], data[_DIGEST:_CODE], data[_CODE:]
        if head != _HEAD or hashlib.sha256(stamp + code).digest() != digest:
            _state.damage()
            return None
        return code if stamp == self._stamp else None

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep machine code."""
        path = self._path(signature, result.codegen)
        if path is None or result.lifted or result.library.has_dynamic_globals:
            return
        code = serialize.dumps(result._reduce())
        part = path.with_suffix(f".{os.getpid()}.part")
        try:
            part.write_bytes(_HEAD + self._stamp + hashlib.sha256(self._stamp + code).digest() + code)
            os.replace(part, path)
        except OSError as error:
            with contextlib.suppress(OSError):
                part.unlink(missing_ok=True)
            _state.full(error)

    def enable(self) -> None:
        """Numba asks for it."""

    def disable(self) -> None:
        """Numba asks for it."""

    def flush(self) -> None:
        """Forget what is kept; it is written over anyway."""

    def _path(self, signature: Any, codegen: Any) -> Path | None:
        if _state.folder is None:
            return None
        versions = numba.__version__, llvmlite.__version__, platform.python_version(), codegen.magic_tuple()
        key = hashlib.sha256(repr((str(signature), versions)).encode()).hexdigest()[:16]
        module = self._function.__module__.rpartition(".")[2]
        return _state.folder / f"{module}.{self._function.__name__}-{key}.kernel"

    @functools.cached_property
    def _stamp(self) -> bytes:
        """Digest of all that decides the machine code: sources of the function and of what it calls, and constants."""
        parts = {f"{key}={sorted(value) if isinstance(value, set) else value}" for key, value in self._options.items()}
        _gather(self._function, parts)
        return hashlib.sha256("\n".join(sorted(parts)).encode()).digest()


def _gather(function: FunctionType, parts: set[str]) -> None:
    """Collect what decides the machine code of a function, and of functions that it calls."""
    own = f"{function.__module__}.{function.__qualname__} {_source(function.__code__.co_filename)}"
    if own in parts:
        return
    parts.add(own)
    for name in _names(function.__code__):
        value = function.__globals__.get(name)
        inner = getattr(value, "py_func", getattr(value, "_defn", None))  # compiled functions, and intrinsics
        if isinstance(inner, FunctionType):
            _gather(inner, parts)
        elif isinstance(value, int | float | str | tuple):
            parts.add(f"{function.__module__}.{name} = {value!r}")
        elif isinstance(value, np.ndarray):
            parts.add(f"{function.__module__}.{name} = {value.dtype} {value.shape} {value.tobytes()!r}")


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
