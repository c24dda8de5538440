"""Whether views can be rendered without a screen: a machine without OpenGL may end the process that tries."""

from __future__ import annotations

import subprocess
import sys
from functools import cache

TRIAL = "import pyvista as pv; p = pv.Plotter(off_screen=True); p.add_mesh(pv.Sphere()); p.screenshot(return_img=True)"


@cache
def can_render() -> bool:
    """Try it in a process of its own."""
    done = subprocess.run([sys.executable, "-c", TRIAL], capture_output=True, timeout=120, check=False)
    return done.returncode == 0
