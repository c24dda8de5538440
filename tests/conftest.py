"""What all tests share: a quick and repeatable search for counterexamples, and a small case."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from changes import ABSENT, replaced
from fissura.case import Case, case_from_dict

settings.register_profile("fissura", deadline=None, max_examples=20, derandomize=True)
settings.load_profile("fissura")

#: A notched beam of about 500 fine bodies.
SMALL_BEAM: dict[str, Any] = tomllib.loads(
    """
specimen.size = [0.12, 0.06, 0.04]
notch = { face = "bottom", position = 0.06, depth = 0.03 }
supports = [{ type = "pin", face = "bottom", at = 0.01 }, { type = "roller", face = "bottom", at = 0.11 }]
load = { face = "top", at = 0.06 }
gauge = { a = { face = "bottom", at = 0.055 }, b = { face = "bottom", at = 0.065 } }
material = { E = 60e9, alpha = 0.29, f_t = 2.2e6, G_t = 35.0 }
discretization = { l_f = 0.008, l_c = 0.032 }
adaptivity = { r_f = 0.016 }
control.target = 1e-4
"""
)


def small_beam(folder: Path | None = None, **changes: Any) -> Case:
    """The small notched beam, with tables or values replaced: ``small_beam(load__at=0.05, notch=[])``.

    A value of None removes the key.
    """
    data = replaced(SMALL_BEAM, {path: ABSENT if value is None else value for path, value in changes.items()})
    return case_from_dict(data, folder or Path())


@pytest.fixture(scope="session")
def small_case() -> Callable[..., Case]:
    """`small_beam`, as a fixture."""
    return small_beam
