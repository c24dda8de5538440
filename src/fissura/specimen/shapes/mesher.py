"""Tetrahedra of surfaces and models of other programs, made by gmsh where the user has installed it."""

from pathlib import Path
from typing import Any

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.errors import InputError
from fissura.specimen.limits import MOST_TRIANGLES, SIDES_OF_MESHER

_BYTES = 50  # of a triangle in a binary STL file


def tetrahedra_of(path: Path, key: str, l_f: float) -> tuple[FloatArray, IntArray, dict[tuple[int, int, int], str]]:
    """Mesh a closed surface or a model, coarsely.

    gmsh is not a dependency: its licence is the GPL, and nothing but files of surfaces needs it.

    Parameters
    ----------
    path : Path
        STL, STEP, BREP or IGES.
    key : str
        Where the file is named in the case.
    l_f : float
        Spacing of fine nuclei, in the unit of the file: elements need not be smaller.

    Returns
    -------
    points : (v, 3) array
        Corners, in the unit of the file.
    tetrahedra : (K, 4) array
        Numbers of the corners.
    names : dict
        Names of triangles by their corners; none, since such files name nothing.

    Raises
    ------
    InputError
        The surface is not closed, has too many triangles, or gmsh cannot mesh it.
    """
    allowed = "a closed surface of few triangles, or a mesh of tetrahedra"
    try:
        import gmsh

        gmsh.initialize(interruptible=False)
    except (ImportError, OSError, AttributeError) as error:  # a library of the system is missing
        raise InputError(key, f"gmsh is installed but does not start: {error}", "a mesh of tetrahedra") from None
    if path.suffix.lower() == ".stl" and path.stat().st_size > _BYTES * 6 * MOST_TRIANGLES:
        raise InputError(key, f"{path.name} has more than {MOST_TRIANGLES} triangles", allowed)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MeshSizeMin", l_f)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", SIDES_OF_MESHER)
        gmsh.merge(str(path))
        if path.suffix.lower() in (".stl", ".obj", ".off", ".ply"):
            _fill_surfaces(gmsh.model, path.name, key)
        gmsh.model.mesh.generate(3)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        _, corners = gmsh.model.mesh.getElementsByType(4)
    except InputError:
        raise
    except Exception as error:  # gmsh raises plain exceptions
        raise InputError(key, f"gmsh cannot mesh {path.name}: {' '.join(str(error).split())[:100]}", allowed) from None
    finally:
        gmsh.finalize()
    if not len(corners):
        raise InputError(key, f"gmsh found no volume in {path.name}: its surface may have holes", allowed)
    number = np.zeros(int(tags.max()) + 1, np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    return coordinates.reshape(-1, 3), number[corners.astype(np.int64)].reshape(-1, 4), {}


def _fill_surfaces(model: Any, file: str, key: str) -> None:
    """Make a volume of the triangles of a file."""
    surfaces = [tag for _, tag in model.getEntities(2)]
    triangles = sum(len(model.mesh.getElements(2, tag)[1][0]) for tag in surfaces)
    if triangles > MOST_TRIANGLES:
        raise InputError(key, f"{file} has {triangles} triangles", f"at most {MOST_TRIANGLES}")
    model.geo.addVolume([model.geo.addSurfaceLoop(surfaces)])
    model.geo.synchronize()
