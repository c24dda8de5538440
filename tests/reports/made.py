"""Results of a few bodies, for pages."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from fissura.results import Result
from fissura.running.recorder import Recorder
from results.synthetic import random_points, simulation, snapshot, step, voronoi_structure

SIZE = np.array([0.02, 0.01, 0.01])
NASTY = "<script>alert(1)</script> </script> & \"double\" 'single' $\\alpha$ {{ 7 * 7 }} <b>β"


def made(folder: Path | None, count: int = 6, *, status: str = "finished", vtk: int = 3, **changes: Any) -> Result:
    """Result of a run with a crack that opens and bodies that fall apart, in a folder or in memory."""
    started = simulation(vtk=vtk)
    if changes:
        started.case = BaseModel.model_copy(started.case, update=changes)  # nothing is validated
    structure = voronoi_structure(random_points(60, SIZE), SIZE)
    middle = structure.contacts.centroid[:, 0] - 0.01
    recorder = Recorder(started, folder)
    recorder._draw = lambda result: None  # pictures are no part of what is tested
    for number in range(1, count + 1):
        opening = np.where(np.abs(middle) < 0.002, 2e-6 * number, 0.0)
        moved = np.zeros((len(structure), 6))
        moved[:, 0] = np.where(structure.x[:, 0] > 0.01, 1e-6, -1e-6) * number
        shot = snapshot(structure, moved, opening)
        load = 1000.0 * np.sin(np.pi * number / (count + 1))
        recorder.add(step(number, 1e-4 * number / count, load, shot, dissipated=1e-3 * number))
    return recorder.finish(status, "" if status == "finished" else "said <i>stop</i>")
