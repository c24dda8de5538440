"""Files for ParaView: bodies as polyhedra, contacts as polygons, and time series of both."""

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from fissura.arrays import FloatArray, IntArray
from fissura.files.atomic import write_atomically
from fissura.results.polyhedra import Polyhedra, polyhedra
from fissura.results.vtu import POLYGON, POLYHEDRON, Grid, write_vtu
from fissura.simulation.step import Snapshot

SERIES = ("bodies", "contacts")
"""Names of the series of files."""

SYMMETRIC = ((0, 1, 2, 0, 1, 0), (0, 1, 2, 1, 2, 2))
"""Rows and columns of a symmetric tensor in ParaView's order XX, YY, ZZ, XY, YZ, XZ."""


def bodies_grid(snapshot: Snapshot) -> Grid:
    """Bodies as polyhedra, one cell for each, those with fewer corners first, else in the order of the tessellation.

    meshio (5.3.5) gives bodies the data of others unless they are sorted so. Every body has points of its own, and the
    point data ``displacement`` is its rigid motion there, so that "Warp By Vector" opens the cracks. A body without
    faces is left out.

    Returns
    -------
    Grid
        Arrays as documented in ``docs/files.md``.
    """
    tessellation = snapshot.tessellation
    solid = polyhedra(tessellation)
    used = np.zeros(len(solid.points), dtype=bool)
    used[solid.corners] = True
    points = np.bincount(solid.point_body[used], minlength=len(tessellation))
    order = np.argsort(points, kind="stable")
    order = order[np.bincount(solid.face_body, minlength=len(tessellation))[order] > 0]
    corners, ends = _reordered(np.flatnonzero(used), np.cumsum(points), order)
    faces, face_ends = _reordered(*_face_streams(solid, len(tessellation)), order)
    data: dict[str, NDArray[Any]] = {
        "body": np.arange(len(tessellation)),
        "displacement": snapshot.displacement[:, :3],
        "rotation": snapshot.displacement[:, 3:],
        "stress": snapshot.stress[:, SYMMETRIC[0], SYMMETRIC[1]],
        "largest_principal_stress": np.linalg.eigvalsh(snapshot.stress)[:, -1],
        "criterion": snapshot.criterion,
        "fine": tessellation.fine.astype(np.uint8),
        "nucleus": tessellation.nucleus,
        "volume": tessellation.volume,
    }
    if snapshot.body_factor is not None:
        data["strength_factor"] = snapshot.body_factor
    return Grid(
        points=solid.points,
        cell_type=POLYHEDRON,
        corners=corners,
        ends=ends,
        point_data={"displacement": _motion(snapshot, solid.points, solid.point_body)},
        cell_data={name: values[order] for name, values in data.items()},
        faces=faces,
        face_ends=face_ends,
    )


def contacts_grid(snapshot: Snapshot) -> Grid:
    """Contacts as polygons, one cell for each polygon of a facet, in the order of the contacts.

    The point data ``displacement`` is the mean motion of the two bodies.

    Returns
    -------
    Grid
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
    if snapshot.contact_factor is not None:
        data["strength_factor"] = snapshot.contact_factor
    owners = contacts.bodies[np.repeat(polygons.facet, np.diff(polygons.offsets))]
    motion = _motion(snapshot, polygons.points, owners[:, 0])
    motion += _motion(snapshot, polygons.points, owners[:, 1])
    motion *= 0.5
    return Grid(
        points=polygons.points,
        cell_type=POLYGON,
        corners=np.arange(len(polygons.points)),
        ends=polygons.offsets[1:],
        point_data={"displacement": motion},
        cell_data={name: values[polygons.facet] for name, values in data.items()},
    )


def write_snapshot(folder: Path, number: int, snapshot: Snapshot) -> None:
    """Write ``bodies_NNNN.vtu`` and ``contacts_NNNN.vtu`` (compressed binary) of a step."""
    for kind, grid in zip(SERIES, (bodies_grid, contacts_grid), strict=True):
        write_vtu(folder / file_name(kind, number), grid(snapshot))


def write_series(folder: Path, values: Mapping[int, float]) -> None:
    """Write ``bodies.pvd`` and ``contacts.pvd``, which list the files of some steps.

    Parameters
    ----------
    folder : Path
        The result folder.
    values : mapping of int to float
        Controlled quantity [m] at every step that was written, shown by ParaView as the time; where it turns back from
        one of them to the next, the number of the step is shown instead.
    """
    numbers = sorted(values)
    grows = all(values[a] < values[b] for a, b in pairwise(numbers))
    times = values if grows else {number: float(number) for number in numbers}
    for kind in SERIES:
        entries = "".join(
            f'    <DataSet timestep="{times[number]:.9g}" part="0" file={quoteattr(file_name(kind, number))}/>\n'
            for number in numbers
        )
        text = (
            '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
            f"{entries}  </Collection>\n</VTKFile>\n"
        )
        write_atomically(folder / f"{kind}.pvd", text.encode())


def file_name(kind: str, number: int) -> str:
    """Name of the VTU file of a step."""
    return f"{kind}_{number:04d}.vtu"


def _face_streams(solid: Polyhedra, n: int) -> tuple[IntArray, IntArray]:
    """Faces of all bodies in VTK's form (see `Grid`), and where the stream of each of the n bodies ends."""
    faces = np.bincount(solid.face_body, minlength=n)
    sizes = np.diff(solid.face_offsets)
    opens = np.zeros(len(sizes), dtype=np.int64)  # 1 where a face is the first of its body
    present = faces > 0
    opens[(np.cumsum(faces) - faces)[present]] = 1
    # A body adds one number to the stream, a face one more, and a corner one more.
    at = np.cumsum(opens) + np.arange(len(sizes)) + solid.face_offsets[:-1]
    stream = np.empty(int(present.sum()) + len(sizes) + len(solid.corners), dtype=np.int64)
    stream[at[opens == 1] - 1] = faces[present]
    stream[at] = sizes
    face = np.repeat(np.arange(len(sizes)), sizes)
    stream[at[face] + 1 + np.arange(len(face)) - solid.face_offsets[face]] = solid.corners
    corners = np.bincount(solid.face_body, sizes, n).astype(np.int64)
    return stream, np.cumsum(present + faces + corners)


def _reordered(values: IntArray, ends: IntArray, order: IntArray) -> tuple[IntArray, IntArray]:
    """Pieces of an array, which end before ``ends``, in another order, and their ends there."""
    sizes = np.diff(ends, prepend=0)
    after = np.cumsum(sizes[order])
    shift = np.repeat(ends[order] - after, sizes[order])
    return values[shift + np.arange(len(shift))], after


def _motion(snapshot: Snapshot, points: FloatArray, body: IntArray) -> FloatArray:
    """Displacement of points that move with given bodies (theory section 1)."""
    q = snapshot.displacement[body]
    r = points - snapshot.tessellation.x[body]
    moved = np.empty_like(points)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):  # much faster than np.cross
        moved[:, i] = q[:, i] + q[:, 3 + j] * r[:, k] - q[:, 3 + k] * r[:, j]
    return moved
