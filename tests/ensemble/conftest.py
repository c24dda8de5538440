"""Tiny random cases: a tenth of a second for a run."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import fissura.batch.computing as computing
import fissura.ensemble.report as report
from changes import ABSENT, TINY_BEAM, replaced
from fissura.case import Case, case_from_dict

TINY = f"""
name = "tiny"
{TINY_BEAM}
field = {{ length = "20 mm" }}
control = {{ target = "100 um", max_step = "2 um", stop_load = 0.5 }}
"""


@pytest.fixture(scope="session")
def tiny() -> Callable[..., Case]:
    """Build the tiny beam, with values replaced as in ``small_case``."""

    def build(**changes: Any) -> Case:
        data = replaced(
            tomllib.loads(TINY), {path: ABSENT if value is None else value for path, value in changes.items()}
        )
        return case_from_dict(data, Path())

    return build


@pytest.fixture
def tiny_file(tmp_path: Path) -> Path:
    """The tiny beam as a case file."""
    path = tmp_path / "tiny.toml"
    path.write_text(TINY)
    return path


@pytest.fixture
def few_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw one picture only, to save time."""
    monkeypatch.setattr(report, "ENSEMBLE_PICTURES", {"convergence": report.ENSEMBLE_PICTURES["convergence"]})


@pytest.fixture
def inline(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compute in this process, one after another."""
    monkeypatch.setattr(computing, "results", lambda run, tasks, *rest: ((task, run(task)) for task in tasks))
