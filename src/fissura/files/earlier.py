"""Result folders that versions of Fissura left which put no mark into them: what they are of, and what is ours there.

Only files that every such folder got count as ours; pictures that a user asked for later may be anything.
"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from fissura.errors import InputError
from fissura.files.tables import read_json

__all__ = ["kind_before_marks", "names_before_marks"]


def kind_before_marks(folder: Path) -> str | None:
    """What a folder is of: ``"run"``, ``"ensemble"``, ``"study"``, ``"elastic"``, or None for any other folder."""
    return next((kind for kind, is_of in _KINDS.items() if is_of(folder)), None)


def names_before_marks(folder: Path) -> Iterator[str]:
    """Files of ours in a folder without a mark, as a mark would list them; none in a folder that is not ours."""
    kind = kind_before_marks(folder)
    if kind == "run":
        yield from _of_run(folder)
    elif kind == "ensemble":
        yield from _of_ensemble(folder)
    elif kind == "study":
        for path in folder.glob("runs/*/seed*/*.npz"):
            if _is_record(path):
                yield path.relative_to(folder).as_posix()
        yield from ("runs.csv", "study.md", "tradeoff.png", "errors.png", "indicators.png", "places.png")
    elif kind == "elastic":
        yield from ("elastic.csv", "elastic_alpha.png", "elastic_size.png")


def _of_run(folder: Path) -> Iterator[str]:
    for series in ("bodies.pvd", "contacts.pvd"):
        with contextlib.suppress(OSError, UnicodeDecodeError):
            text = (folder / series).read_text(encoding="utf-8")
            yield from re.findall(r'file="((?:bodies|contacts)_\d+\.vtu)"', text)
        yield series
    yield from ("case.toml", "case.json", "curve.csv", "state_last.npz", "section.npz", "checkpoint.npz")
    yield from ("curve.png", "crack.png", "field.png", "error.txt", "summary.json")


def _of_ensemble(folder: Path) -> Iterator[str]:
    for place in (*folder.glob("runs/*"), *folder.glob("companions/*")):
        if re.fullmatch(r"\d{4,9}", place.name) and _is_run(place):
            yield f"{place.parent.name}/{place.name}/"
    yield from (f"pictures/{name}.png" for name in ("curves", "peaks", "papers", "crack_starts", "convergence"))
    yield from ("case.toml", "case.json", "runs.csv", "runs.parquet", "mean_curve.csv", "statistics.json")
    yield from ("report.html", "ensemble.json")


def _is_run(folder: Path) -> bool:
    found = _read(folder / "summary.json")
    return "status" in found and ("fissura" in found.get("versions", {}) or "realisation" in found)


def _is_ensemble(folder: Path) -> bool:
    found = _read(folder / "ensemble.json")
    return "plan" in found and "fissura" in found.get("versions", {})


def _is_study(folder: Path) -> bool:
    return any(_is_record(path) for path in folder.glob("runs/*/seed*/*.npz"))


def _is_elastic(folder: Path) -> bool:
    try:
        with (folder / "elastic.csv").open("rb") as file:
            return file.readline().startswith(b"structure,alpha,l_min_over_size,")
    except OSError:
        return False


def _is_record(path: Path) -> bool:
    from fissura.files.archive import read_archive  # brings NumPy, and cases are read without

    try:
        read_archive(path, "fissura-study-run", 1)
    except InputError:
        return False
    return True


def _read(path: Path) -> dict[str, Any]:
    """Content of a JSON file of ours; nothing of any other file."""
    try:
        content = read_json(path, "a file of ours", tables=False, most=50_000_000)
    except InputError:
        return {}
    return content if isinstance(content, dict) and isinstance(content.get("format_version"), int) else {}


_KINDS: dict[str, Callable[[Path], bool]] = {
    "ensemble": _is_ensemble,
    "run": _is_run,
    "study": _is_study,
    "elastic": _is_elastic,
}
