"""Where numbers come from: which program, on which machine, when."""

import json
import platform
import subprocess
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

import psutil


@cache
def versions() -> dict[str, str]:
    """Versions of Fissura, Python and the libraries that decide the numbers."""
    found = {"python": platform.python_version()}
    for package in ("fissura", "numpy", "scipy", "numba"):
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            found[package] = "unknown"
    return found


@cache
def commit() -> str | None:
    """Commit of the program, with ``-dirty`` behind it where files differ from it; None where it is not known.

    It is known of a program that runs from a Git repository, and of one that pip installed from there.
    """
    root = Path(__file__).resolve().parents[3]
    if (root / ".git").exists() and (root / "src" / "fissura").is_dir():
        # Only hashes: a tag would hide which commit it is of.
        command = ["git", "-C", str(root), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=10, check=False)
        except (OSError, subprocess.SubprocessError):
            return None
        return done.stdout.strip() or None if done.returncode == 0 else None
    return _installed_commit()


def _installed_commit() -> str | None:
    """What pip noted when it installed from a repository (PEP 610)."""
    try:
        noted: Any = json.loads(metadata.distribution("fissura").read_text("direct_url.json") or "{}")
    except (metadata.PackageNotFoundError, ValueError):
        return None
    found = noted.get("vcs_info", {}).get("commit_id") if isinstance(noted, dict) else None
    return str(found) if found else None


@cache
def machine() -> dict[str, Any]:
    """System, processor, processors that this process may use, and memory [bytes]; names nobody."""
    return {
        "system": f"{platform.system()} {platform.release()}",
        "processor": _processor() or platform.machine(),
        "processors": _usable(),
        "memory_bytes": int(psutil.virtual_memory().total),
    }


def now() -> str:
    """Date and time in UTC, as ISO 8601 has them, to the second."""
    return datetime.now(UTC).isoformat(timespec="seconds").replace("+00:00", "Z")


def _usable() -> int:
    process = psutil.Process()
    affinity = getattr(process, "cpu_affinity", None)  # not on macOS
    return len(affinity()) if affinity is not None else psutil.cpu_count() or 1


def _processor() -> str:
    """What the processor calls itself, where the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")
