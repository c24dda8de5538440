"""Cases that tests of studies share."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

from fissura.case import case_from_dict

from .models import CASE, write_study


@pytest.fixture(scope="session")
def beam() -> dict[str, Any]:
    """The tiny beam with all defaults, as records keep it."""
    return case_from_dict(tomllib.loads(CASE)).model_dump(mode="json")


@pytest.fixture
def study(tmp_path: Path) -> Path:
    """A study file."""
    return write_study(tmp_path)
