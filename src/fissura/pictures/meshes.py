"""Bodies and cracks of a step as PyVista meshes; needs the extra ``view``."""

from pathlib import Path
from typing import Any

import numpy as np

from fissura.errors import InputError
from fissura.pictures.pyvista_tools import pyvista
from fissura.results.run_data import RunData
from fissura.results.vtk import SERIES, bodies_grid, contacts_grid, file_name
from fissura.results.vtu import Grid


def steps_with_states(result: RunData) -> list[int]:
    """Numbers of the steps whose states there are, in memory or as files for ParaView; ascending."""
    return sorted({*result.snapshots, *_written(result.folder)})


def step_of(result: RunData, step: int | None) -> int:
    """Number of a step whose state there is; the last one for None.

    Raises
    ------
    InputError
        There is no state of this step, or of any.
    """
    known = steps_with_states(result)
    if not known:
        raise InputError(str(result.folder or result.case.name), "has no states of steps")
    if step is None:
        return known[-1]
    if step not in known:
        raise InputError("step", f"there is no state of step {step}", f"one of {', '.join(map(str, known))}")
    return step


def meshes_of(result: RunData, step: int | None = None) -> Any:
    """Bodies and cracks of a step; see `Result.to_pyvista`."""
    pv, number = pyvista(), step_of(result, step)
    snapshot = result.snapshots.get(number)
    if snapshot is not None:
        bodies, contacts = (_mesh(grid(snapshot)) for grid in (bodies_grid, contacts_grid))
    else:
        assert result.folder is not None
        bodies, contacts = (pv.read(result.folder / file_name(kind, number)) for kind in SERIES)
    cracked = np.flatnonzero(contacts.cell_data["damage"] > 0.0)
    return pv.MultiBlock({"bodies": bodies, "cracks": contacts.extract_cells(cracked)})


def _written(folder: Path | None) -> list[int]:
    """Steps of which a folder has the files for ParaView."""
    if folder is None:
        return []
    bodies, contacts = SERIES
    found = [path.stem.removeprefix(f"{bodies}_") for path in folder.glob(f"{bodies}_*.vtu")]
    numbers = [int(text) for text in found if text.isdecimal()]
    return [number for number in numbers if (folder / file_name(contacts, number)).is_file()]


def _mesh(grid: Grid) -> Any:
    """A grid in PyVista's form."""
    stream, ends = (grid.corners, grid.ends) if grid.faces is None else (grid.faces, grid.face_ends)
    assert ends is not None
    starts = np.concatenate([[0], ends[:-1]]).astype(np.int64)
    cells = np.insert(stream, starts, ends - starts)
    types = np.full(len(ends), grid.cell_type, np.uint8)
    mesh = pyvista().UnstructuredGrid(cells, types, grid.points)
    for name, values in grid.point_data.items():
        mesh.point_data[name] = values
    for name, values in grid.cell_data.items():
        mesh.cell_data[name] = values
    return mesh
