"""Whether two folders of results are of the same run, to the last bit; times differ."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from fissura.results import read_curve

#: What depends on the clock or on the machine.
TIMES = ("cpu_s", "wall_s")
_MACHINE = (*TIMES, "cpu_repeated_s", "cpu_refining_s", "peak_memory_MB", "date")


def arrays(path: Path) -> dict[str, bytes]:
    with np.load(path) as archive:
        return {name: archive[name].tobytes() for name in archive.files}


def rows(folder: Path) -> dict[str, list[Any]]:
    """The curve as it is written, without times."""
    lines = [line.split(",") for line in (folder / "curve.csv").read_text().splitlines()]
    return {name: list(values) for name, *values in zip(*lines, strict=True) if name not in TIMES}


def summary(folder: Path) -> dict[str, Any]:
    found = json.loads((folder / "summary.json").read_text())
    return {key: value for key, value in found.items() if key not in _MACHINE}


def assert_same(one: Path, other: Path, *, states: bool = True) -> None:
    """All files but pictures are the same."""
    assert rows(one) == rows(other)
    assert summary(one) == summary(other)
    for name in ("section.npz", "state_last.npz"):
        assert arrays(one / name) == arrays(other / name), name
    assert len(read_curve(one)["step"]) == summary(one)["steps"]
    if states:
        names = {path.name for path in one.glob("*") if path.suffix in (".vtu", ".pvd")}
        assert names == {path.name for path in other.glob("*") if path.suffix in (".vtu", ".pvd")}
        for name in names:
            assert (one / name).read_bytes() == (other / name).read_bytes(), name
