"""Tests that draw in three dimensions."""

from __future__ import annotations

from importlib.util import find_spec

import pytest

from fissura.pictures.pyvista_tools import can_render

needs_rendering = pytest.mark.skipif(
    find_spec("pyvista") is None or not can_render(), reason="PyVista is missing, or nothing can be drawn here"
)
