"""Specimens from tetrahedral meshes of other programs."""

import contextlib
import importlib.util
import io
from pathlib import Path
from typing import Any

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.case.ranges import LONGEST
from fissura.errors import InputError, Notice
from fissura.specimen.limits import FLAT, LEAST_COORDINATE, LOOKED_AT, MOST_BYTES, MOST_TETRAHEDRA, SLIVER
from fissura.specimen.shapes.mesher import tetrahedra_of
from fissura.specimen.solid import Solid
from fissura.specimen.tetrahedra import OPPOSITE, solid_of_tetrahedra, triangles_of

#: Files that hold a surface or a model, from which only a mesher makes tetrahedra.
SURFACES = (".stl", ".step", ".stp", ".obj", ".off", ".ply", ".brep", ".iges", ".igs")

_COARSE = "a mesh as coarse as the shape allows, its size has nothing to do with that of bodies"
_ALLOWED = "a mesh of tetrahedra that meshio reads, such as .msh, .vtu, .inp, .med, .xdmf"


def mesh(path: Path, scale: float, l_f: float, key: str = "specimen.mesh") -> tuple[Solid, tuple[Notice, ...]]:
    """A specimen of tetrahedra.

    Parameters
    ----------
    path : Path
        The file. Physical groups, or sets of cells, of triangles name surfaces; all else is called ``surface``.
    scale : float
        Length of its unit [m].
    l_f : float
        Spacing of fine nuclei, for surfaces that must be meshed first [m].
    key : str, optional
        Where the file is named in the case.

    Returns
    -------
    solid : Solid
        The specimen.
    notices : tuple of Notice
        What looks wrong in the mesh.

    Raises
    ------
    InputError
        The file cannot be read, has no tetrahedra, or they overlap, or have no volume.
    """
    if path.stat().st_size > MOST_BYTES:
        raise InputError(key, f"{path.name} has more than {MOST_BYTES / 1e6:g} MB", _COARSE)
    if path.suffix.lower() in SURFACES:
        if importlib.util.find_spec("gmsh") is None:
            raise InputError(
                key,
                f"{path.name} holds a surface, not tetrahedra, and gmsh, which would mesh it, is not installed",
                f"{_ALLOWED}; or install gmsh: pip install gmsh",
            )
        points, tets, names = tetrahedra_of(path, key, l_f / scale)
    else:
        points, tets, names = _read(path, key)
    if len(tets) > MOST_TETRAHEDRA:
        raise InputError(
            key,
            f"{path.name} has {len(tets)} tetrahedra",
            f"at most {MOST_TETRAHEDRA}: {_COARSE}",
        )
    points = points * scale
    if not np.isfinite(points[tets]).all():
        raise InputError(key, f"{path.name} has corners that are not finite", _ALLOWED)
    far = float(np.abs(points[tets]).max())
    if not LEAST_COORDINATE <= far <= LONGEST:
        problem = f"{path.name} has coordinates up to {far:.3g} m"
        raise InputError(
            key, problem, f"{LEAST_COORDINATE:g} to {LONGEST:g} m: see whether specimen.unit is missing or wrong"
        )
    tets = _sound(points, tets, path.name, key)
    solid = solid_of_tetrahedra(points, tets, names)
    return solid, _notices(points, tets, key)


def _read(path: Path, key: str) -> tuple[FloatArray, IntArray, dict[tuple[int, int, int], str]]:
    """Corners, tetrahedra, and names of triangles of a file."""
    import meshio  # few specimens need it

    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            found = meshio.read(path)
        points = np.asarray(found.points, float).reshape(-1, np.shape(found.points)[-1])
        blocks = [(block.type, np.asarray(block.data, np.int64)) for block in found.cells]
    except (Exception, SystemExit) as error:  # readers raise whatever they meet: the user needs one message
        reason = " ".join(str(error).split())[:100]
        problem = f"{path.name} cannot be read as a mesh" + (f": {reason}" if reason else "")
        raise InputError(key, problem, _ALLOWED) from None
    solid = [data[:, :4] for kind, data in blocks if kind.startswith("tetra")]  # of curved ones the corners
    if not solid or points.shape[1] != 3:
        kinds = ", ".join(sorted({kind for kind, _ in blocks})) or "nothing"
        raise InputError(key, f"{path.name} has no tetrahedra, but {kinds}", _ALLOWED)
    tets = np.concatenate(solid)
    if tets.min() < 0 or tets.max() >= len(points):
        raise InputError(key, f"{path.name} has tetrahedra whose corners are missing", _ALLOWED)
    return points, tets, _named_triangles(found, blocks)


def _named_triangles(found: Any, blocks: list[tuple[str, IntArray]]) -> dict[tuple[int, int, int], str]:
    """Names of triangles by their corners: physical groups, then sets of cells."""
    names: dict[tuple[int, int, int], str] = {}
    groups = {int(value[0]): str(name) for name, value in found.field_data.items() if len(value) > 1 and value[1] == 2}
    tags = found.cell_data.get("gmsh:physical", [None] * len(blocks))
    for (kind, data), tag in zip(blocks, tags, strict=True):
        if kind.startswith("triangle") and tag is not None:
            for corners, number in zip(np.sort(data[:, :3], axis=1).tolist(), np.asarray(tag).tolist(), strict=True):
                names[tuple(corners)] = groups.get(int(number), f"surface {int(number)}")
    for name, members in found.cell_sets.items():
        if name.startswith("gmsh:"):
            continue
        for (kind, data), chosen in zip(blocks, members, strict=False):
            if kind.startswith("triangle") and chosen is not None and len(chosen):
                for corners in np.sort(data[np.asarray(chosen, np.int64), :3], axis=1).tolist():
                    names[tuple(corners)] = str(name)
    return names


def _sound(points: FloatArray, tets: IntArray, file: str, key: str) -> IntArray:
    """Tetrahedra that have a volume, share whole triangles and do not overlap."""
    used = points[tets]
    arms = used[:, 1:] - used[:, :1]
    size = np.abs(arms).max(axis=(1, 2))
    volume = np.linalg.det(arms) / 6.0
    flat = np.abs(volume) <= FLAT * size**3
    if flat.any():
        raise InputError(
            key,
            f"{int(flat.sum())} of the {len(tets)} tetrahedra of {file} have no volume, that at"
            f" ({', '.join(f'{v:.4g}' for v in used[flat][0].mean(axis=0))}) m among them",
            "tetrahedra with a volume",
        )
    _, number, count = triangles_of(tets)
    if (count > 2).any():
        raise InputError(
            key, f"{file} has triangles that more than two tetrahedra share", "tetrahedra that do not overlap"
        )
    _check_sides(used, volume, number, file, key)
    _check_apart(used, file, key)
    return tets


def _check_sides(used: FloatArray, volume: FloatArray, number: IntArray, file: str, key: str) -> None:
    """Two tetrahedra that share a triangle lie on either side of it, else one of them is inverted."""
    turned = used.copy()
    turned[volume < 0.0] = turned[volume < 0.0][:, [1, 0, 2, 3]]
    order = number.copy()
    order[volume < 0.0] = order[volume < 0.0][:, [1, 0, 2, 3]]
    corners = turned[:, OPPOSITE]
    normal = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0]).reshape(-1, 3)
    flat = order.ravel()
    sums = np.zeros((flat.max() + 1, 3))
    np.add.at(sums, flat, normal)
    shared = np.bincount(flat) == 2
    size = np.zeros(len(sums))
    np.maximum.at(size, flat, np.linalg.norm(normal, axis=1))
    wrong = shared & (np.linalg.norm(sums, axis=1) > 1e-6 * size)
    if wrong.any():
        raise InputError(
            key,
            f"{int(wrong.sum())} pairs of tetrahedra of {file} lie on the same side of the triangle that they share:"
            " elements are inverted or overlap",
            "tetrahedra that do not overlap",
        )


def _check_apart(used: FloatArray, file: str, key: str) -> None:
    """The middle of a tetrahedron lies in no other one; of many only some are looked at."""
    low, high = used.min(axis=1), used.max(axis=1)
    edges = np.linalg.inv(np.moveaxis(used[:, 1:] - used[:, :1], 1, 2))
    for k in np.unique(np.linspace(0, len(used) - 1, min(len(used), LOOKED_AT)).astype(int)):
        middle = used[k].mean(axis=0)
        near = np.flatnonzero(((low < middle) & (middle < high)).all(axis=1))
        share = np.einsum("kab,kb->ka", edges[near], middle - used[near, 0])
        inside = near[(share > 1e-9).all(axis=1) & (share.sum(axis=1) < 1.0 - 1e-9)]
        if len(inside) > 1:
            where = ", ".join(f"{v:.4g}" for v in middle)
            raise InputError(key, f"tetrahedra of {file} overlap at ({where}) m", "tetrahedra that do not overlap")


def _notices(points: FloatArray, tets: IntArray, key: str) -> tuple[Notice, ...]:
    used = points[tets]
    size = np.linalg.norm(used[:, [0, 0, 0, 1, 1, 2]] - used[:, [1, 2, 3, 2, 3, 3]], axis=2).max(axis=1)
    volume = np.abs(np.linalg.det(used[:, 1:] - used[:, :1])) / 6.0
    slivers = int((volume < SLIVER * size**3).sum())
    out = []
    if slivers:
        out.append(
            Notice(
                key,
                f"{slivers} of {len(tets)} tetrahedra are almost flat: volumes of bodies are exact to 1e-6 only",
                "a mesh of better quality; it may be as coarse as the shape allows",
            )
        )
    largest = float(np.ptp(used.reshape(-1, 3), axis=0).max())
    advice = 'see whether unit is missing or wrong: without it the mesh is in m; write such as unit = "mm"'
    if largest > 100.0:
        out.append(Notice(key, f"the specimen is {largest:.4g} m large, above 100 m", advice))
    elif largest < 1e-3:
        out.append(Notice(key, f"the specimen is {largest:.4g} m large, below 1 mm", advice))
    return tuple(out)
