"""Folder of compiled functions: the best one of those that can be written to."""

import contextlib
import hashlib
import os
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from numba.core import config as _config
from numba.misc.appdirs import AppDirs as _AppDirs

AppDirs: Any = _AppDirs  # these have no types
config: Any = _config

PACKAGE = Path(__file__).parents[1]


def lasting() -> Path | None:
    """A folder that lasts, the best one first: one that the user named, in the installation, in the home folder."""
    return next(filter(_usable, _candidates()), None)


def _candidates() -> Iterator[Path]:
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


def temporary() -> Path | None:
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
