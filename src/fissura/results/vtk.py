"""Files for ParaView: bodies as polyhedra, contacts as polygons, and time series of both."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

import meshio
import numpy as np
from numpy.typing import NDArray

from fissura.results.polyhedra import polyhedra
from fissura.results.summary import write_atomically

if TYPE_CHECKING:
    from fissura.step import Snapshot

__all__ = ["bodies_mesh", "contacts_mesh", "write_series", "write_snapshot"]

FloatArray = NDArray[np.float64]

SYMMETRIC = ((0, 1, 2, 0, 1, 0), (0, 1, 2, 1, 2, 2))
"""Rows and columns of a symmetric tensor in ParaView's order XX, YY, ZZ, XY, YZ, XZ."""


def bodies_mesh(snapshot: Snapshot) -> meshio.Mesh:
    """Bodies as polyhedra, one cell for each, in the order of the tessellation.

    Every body has points of its own, and the point data ``displacement`` is its rigid motion there, so
    that "Warp By Vector" opens the cracks. A body without faces is left out.

    Returns
    -------
    meshio.Mesh
        Arrays as documented in ``docs/files.md``.
    """
    tessellation = snapshot.tessellation
    solid = polyhedra(tessellation)
    faces = np.split(solid.corners, solid.face_offsets[1:-1])
    present, first = np.unique(solid.face_body, return_index=True)
    bounds = [*first.tolist(), len(faces)]
    cells = [faces[a:b] for a, b in pairwise(bounds)]
    data: dict[str, NDArray[Any]] = {
        "displacement": snapshot.displacement[:, :3],
        "rotation": snapshot.displacement[:, 3:],
        "stress": snapshot.stress[:, SYMMETRIC[0], SYMMETRIC[1]],
        "largest_principal_stress": np.linalg.eigvalsh(snapshot.stress)[:, -1],
        "criterion": snapshot.criterion,
        "fine": tessellation.fine.astype(np.uint8),
        "nucleus": tessellation.nucleus,
        "volume": tessellation.volume,
    }
    return meshio.Mesh(
        solid.points,
        [("polyhedron", cells)],
        point_data={"displacement": _motion(snapshot, solid.points, solid.point_body)},
        cell_data={name: [np.ascontiguousarray(values[present])] for name, values in data.items()},
    )


def contacts_mesh(snapshot: Snapshot) -> meshio.Mesh:
    """Contacts as polygons, one cell for each polygon of a facet, ordered by the number of corners.

    The point data ``displacement`` is the mean motion of the two bodies.

    Returns
    -------
    meshio.Mesh
        Arrays as documented in ``docs/files.md``.
    """
    contacts = snapshot.tessellation.contacts
    polygons = contacts.polygons
    local = snapshot.traction
    traction = local[:, :1] * contacts.normal + np.einsum("mk,mkc->mc", local[:, 1:], snapshot.tangents)
    data: dict[str, NDArray[Any]] = {
        "contact": np.arange(len(contacts)),
        "opening": snapshot.opening,
        "damage": snapshot.damage,
        "traction": traction,
        "traction_NML": local,
        "strain_NML": snapshot.strain,
        "fine": contacts.fine.astype(np.uint8),
        "length": contacts.length,
        "area": contacts.area,
    }
    sizes = np.diff(polygons.offsets)
    groups = [np.flatnonzero(sizes == size) for size in np.unique(sizes)]
    blocks = [("polygon", polygons.offsets[group, None] + np.arange(sizes[group[0]])) for group in groups]
    owners = contacts.bodies[np.repeat(polygons.facet, sizes)]
    motion = sum(_motion(snapshot, polygons.points, owners[:, side]) for side in (0, 1)) / 2
    return meshio.Mesh(
        polygons.points,
        blocks,
        point_data={"displacement": motion},
        cell_data={name: [values[polygons.facet[g]] for g in groups] for name, values in data.items()},
    )


def write_snapshot(folder: Path, number: int, snapshot: Snapshot) -> None:
    """Write ``bodies_NNNN.vtu`` and ``contacts_NNNN.vtu`` (compressed binary) of a step."""
    for kind, mesh in (("bodies", bodies_mesh(snapshot)), ("contacts", contacts_mesh(snapshot))):
        meshio.write(folder / file_name(kind, number), mesh, file_format="vtu", binary=True, compression="zlib")


def write_series(folder: Path, gauges: Mapping[int, float]) -> None:
    """Write ``bodies.pvd`` and ``contacts.pvd``, which list the files of some steps.

    Parameters
    ----------
    folder : Path
        The result folder.
    gauges : mapping of int to float
        Gauge [m] of every step that was written, shown by ParaView as the time.
    """
    for kind in ("bodies", "contacts"):
        entries = "".join(
            f'    <DataSet timestep="{gauge:.9g}" part="0" file={quoteattr(file_name(kind, number))}/>\n'
            for number, gauge in sorted(gauges.items())
        )
        text = (
            '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
            f"{entries}  </Collection>\n</VTKFile>\n"
        )
        write_atomically(folder / f"{kind}.pvd", text.encode())


def file_name(kind: str, number: int) -> str:
    """Name of the VTU file of a step."""
    return f"{kind}_{number:04d}.vtu"


def _motion(snapshot: Snapshot, points: FloatArray, body: NDArray[np.int64]) -> FloatArray:
    """Displacement of points that move with given bodies (theory section 1)."""
    q = snapshot.displacement[body]
    moved: FloatArray = q[:, :3] + np.cross(q[:, 3:], points - snapshot.tessellation.x[body])
    return moved
