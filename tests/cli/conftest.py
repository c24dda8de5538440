"""What tests of the command line share."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

import pytest

from .fakes import TINY, FakeRecorder, FakeSimulation


@pytest.fixture
def tiny(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A case file in an otherwise empty current directory."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "tiny.toml"
    path.write_text(TINY)
    return path


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> type[FakeSimulation]:
    """Nothing is computed."""
    simulation = type("Simulation", (FakeSimulation,), {"built": []})
    module = ModuleType("fissura.simulation.loop")
    module.Simulation = simulation  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "fissura.simulation.loop", module)
    for place in ("fissura.running.run", "fissura.api.check"):
        monkeypatch.setattr(f"{place}.Simulation", simulation)
    monkeypatch.setattr("fissura.running.run.Recorder", type("Recorder", (FakeRecorder,), {}))
    return simulation
