"""Tiny notched beams, measured by themselves."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

import fissura.batch.computing as computing
from changes import TINY_BEAM
from fissura import run
from fissura.case import Case, case_from_dict

TEXT = f"""# A tiny beam.
{TINY_BEAM.replace('f_t = "2.2 MPa"', 'f_t = "2.5 MPa"')}
control = {{ target = "60 um", max_step = "1.2 um" }}  # no farther
"""


@pytest.fixture(scope="session")
def beam() -> Case:
    """The beam as it is."""
    return case_from_dict(tomllib.loads(TEXT), Path())


@pytest.fixture(scope="session")
def beam_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The beam as a case file."""
    path = tmp_path_factory.mktemp("beam") / "beam.toml"
    path.write_text(TEXT)
    return path


@pytest.fixture(scope="session")
def measured(beam: Case, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its curve with f_t = 2 MPa and G_t = 45 J/m² and a seed of its own, as a spreadsheet writes it."""
    curve = run(beam.with_({"material.f_t": 2e6, "material.G_t": 45.0, "seed": 77})).curve
    rows = zip(curve["gauge_m"], curve["load_N"], strict=True)
    text = "".join(f"{1e3 * x:.9f};{1e-3 * y:.9f}\n".replace(".", ",") for x, y in rows)
    path = tmp_path_factory.mktemp("measured") / "curve.csv"
    path.write_text("\ufeffCMOD [mm];load [kN]\n" + text, encoding="utf-8")
    return path


@pytest.fixture
def inline(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compute in this process, one after another."""
    monkeypatch.setattr(computing, "results", lambda run, tasks, *rest: ((task, run(task)) for task in tasks))
