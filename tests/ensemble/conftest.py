"""Tiny random cases: a tenth of a second for a run."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from changes import ABSENT, replaced
from fissura.case import Case, case_from_dict

TINY = """
name = "tiny"
specimen.size = ["80 mm", "20 mm", "10 mm"]
notch = { position = "40 mm", depth = "8 mm" }
supports = [
    { type = "pin", face = "bottom", at = "10 mm" },
    { type = "roller", face = "bottom", at = "70 mm" },
]
load = { face = "top", at = "40 mm" }
gauge.a = { face = "bottom", at = "38 mm" }
gauge.b = { face = "bottom", at = "42 mm" }
material = { E = "60 GPa", alpha = 0.29, f_t = "2.2 MPa", G_t = "35 J/m^2" }
discretization = { l_f = "5 mm", l_c = "10 mm" }
field = { length = "20 mm" }
control = { target = "100 um", max_step = "2 um", stop_load = 0.5 }
output.vtk = 0
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
