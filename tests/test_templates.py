"""Cases that ``fissura new`` prints: each runs past its peak."""

from importlib.resources import files
from pathlib import Path

import meshio
import numpy as np
import pytest

from fissura.case import load_case
from fissura.simulation.loop import Simulation

FOLDER = Path(str(files("fissura") / "templates"))


def block(path: Path) -> None:
    """A box of 80 x 30 x 30 mm as tetrahedra in mm, its ends named left and right, in gmsh's format 2.2."""
    corners = np.array([[x, y, z] for x in (0.0, 40.0, 80.0) for y in (0.0, 30.0) for z in (0.0, 30.0)])
    tetrahedra, ends = [], []
    for first in (0, 4):
        o, c, b, bc, a, ac, ab, abc = range(first, first + 8)  # the names tell along which axes a corner lies
        tetrahedra += [
            [o, a, ab, abc],
            [o, ab, b, abc],
            [o, b, bc, abc],
            [o, bc, c, abc],
            [o, c, ac, abc],
            [o, ac, a, abc],
        ]
    for o, c, b, bc in ((0, 1, 2, 3), (8, 9, 10, 11)):
        ends += [[o, b, bc], [o, bc, c]]
    mesh = meshio.Mesh(
        corners,
        [("triangle", np.array(ends)), ("tetra", np.array(tetrahedra))],
        cell_data={
            "gmsh:physical": [np.array([1, 1, 2, 2]), np.full(len(tetrahedra), 3)],
            "gmsh:geometrical": [np.array([1, 1, 2, 2]), np.ones(len(tetrahedra), int)],
        },
        field_data={"left": np.array([1, 2]), "right": np.array([2, 2]), "concrete": np.array([3, 3])},
    )
    meshio.write(path, mesh, file_format="gmsh22", binary=False)


def test_the_mesh_needs_only_its_file(tmp_path: Path) -> None:
    block(tmp_path / "block.msh")
    (tmp_path / "mesh.toml").write_text((FOLDER / "mesh.toml").read_text())
    simulation = Simulation(load_case(tmp_path / "mesh.toml"))
    assert simulation.domain.volume == pytest.approx(0.08 * 0.03 * 0.03, rel=1e-12)
    assert {"left", "right"} <= set(simulation.domain.surfaces)


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.toml")), ids=lambda path: path.stem)
def test_runs_past_its_peak(path: Path, tmp_path: Path) -> None:
    """And breaks where it should, not where it is held or loaded."""
    block(tmp_path / "block.msh")
    (tmp_path / path.name).write_text(path.read_text())
    peak, past = 0.0, False
    for step in Simulation(load_case(tmp_path / path.name)).steps():
        peak = max(peak, abs(step.load))
        past = abs(step.load) < 0.97 * peak
        if past:
            break
    assert past
    assert step.dissipated_at[-1] < 0.5 * step.dissipated
