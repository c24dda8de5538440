"""VTK's XML files of unstructured grids, compressed binary, written array by array."""

import sys
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from fissura.arrays import FloatArray, IntArray
from fissura.files.archive import level
from fissura.files.atomic import replacing

POLYGON, POLYHEDRON = 7, 42
"""VTK's numbers of the two types of cells."""

BLOCK = 1 << 20
"""Bytes that are compressed at once, so that no array is held a second time."""

WIDTH = 20
"""Room for an offset in the head, which is filled in after the arrays are written."""

Arrays = Mapping[str, NDArray[Any]]


@dataclass(frozen=True)
class Grid:
    """An unstructured grid of one type of cells, with data.

    Attributes
    ----------
    points : (p, 3) array
        Points [m].
    cell_type : int
        `POLYGON` or `POLYHEDRON`.
    corners : (c,) array
        Points of the cells, one cell after another.
    ends : (k,) array
        Corners of cell ``i`` end before ``corners[ends[i]]``.
    faces, face_ends : (f,), (k,) array, or None
        Of polyhedra, in VTK's form: for each cell the number of its faces, then for each face the number of its
        corners and these; the stream of cell ``i`` ends before ``faces[face_ends[i]]``.
    point_data, cell_data : mapping of str to (p,) or (p, j) and (k,) or (k, j) array
        Values by name.
    """

    points: FloatArray
    cell_type: int
    corners: IntArray
    ends: IntArray
    point_data: Arrays
    cell_data: Arrays
    faces: IntArray | None = None
    face_ends: IntArray | None = None


def write_vtu(path: Path, grid: Grid) -> None:
    """Write a grid; integers that fit are stored in 32 bits, real numbers as they are.

    Parameters
    ----------
    path : Path
        File to write, ``.vtu``.
    grid : Grid
        What to write.
    """
    cells: dict[str, NDArray[Any]] = {
        "connectivity": grid.corners,
        "offsets": grid.ends,
        "types": np.full(len(grid.ends), grid.cell_type, dtype=np.uint8),
    }
    if grid.faces is not None and grid.face_ends is not None:
        cells |= {"faces": grid.faces, "faceoffsets": grid.face_ends}
    parts: dict[str, Arrays] = {
        "Points": {"Points": grid.points},
        "Cells": cells,
        "PointData": grid.point_data,
        "CellData": grid.cell_data,
    }
    count = sum(len(arrays) for arrays in parts.values())
    with replacing(path) as part, part.open("wb") as file:
        file.write(_head(grid, parts, [0] * count))
        start, offsets = file.tell(), []
        for arrays in parts.values():
            for values in arrays.values():
                offsets.append(file.tell() - start)
                _write_compressed(file, values.astype(_stored(values), copy=False))
        file.write(b"\n  </AppendedData>\n</VTKFile>\n")
        file.seek(0)
        file.write(_head(grid, parts, offsets))


def _head(grid: Grid, parts: Mapping[str, Arrays], offsets: list[int]) -> bytes:
    """The file up to its first array; as long for any offsets."""
    places = iter(offsets)
    lines = [
        '<?xml version="1.0"?>',
        f'<VTKFile type="UnstructuredGrid" version="1.0" byte_order="{sys.byteorder.capitalize()}Endian"'
        ' header_type="UInt64" compressor="vtkZLibDataCompressor">',
        "  <UnstructuredGrid>",
        f'    <Piece NumberOfPoints="{len(grid.points)}" NumberOfCells="{len(grid.ends)}">',
    ]
    for part, arrays in parts.items():
        lines.append(f"      <{part}>")
        for name, values in arrays.items():
            offset = f'offset="{next(places)}"/>'
            components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
            lines.append(
                f'        <DataArray type="{_type_name(values)}" Name={quoteattr(name)}{components}'
                # Blanks follow the number, outside of it: meshio looks for the bare number.
                f' format="appended" {offset:<{WIDTH + 11}}'
            )
        lines.append(f"      </{part}>")
    lines += ["    </Piece>", "  </UnstructuredGrid>", '  <AppendedData encoding="raw">', "_"]
    return "\n".join(lines).encode()


def _type_name(values: NDArray[Any]) -> str:
    dtype = _stored(values)
    kind = {"f": "Float", "i": "Int", "u": "UInt"}[dtype.kind]
    return f"{kind}{8 * dtype.itemsize}"


def _stored(values: NDArray[Any]) -> np.dtype[Any]:
    """Type in the file: 32-bit integers where these are wide enough."""
    if values.dtype.kind == "i" and np.abs(values).max(initial=0) < 2**31:
        return np.dtype(np.int32)
    return values.dtype


def _write_compressed(file: BinaryIO, values: NDArray[Any]) -> None:
    """Blocks of an array, behind their number, their size, that of a last shorter one, and the compressed sizes."""
    data = np.ascontiguousarray(values).reshape(-1).view(np.uint8)
    blocks, rest = divmod(len(data), BLOCK)
    sizes = np.zeros(3 + blocks + (rest > 0), dtype=np.uint64)
    sizes[:3] = len(sizes) - 3, BLOCK, rest
    start, effort = file.tell(), level(values)
    file.write(sizes.tobytes())
    for k in range(len(sizes) - 3):
        sizes[3 + k] = file.write(zlib.compress(data[k * BLOCK : (k + 1) * BLOCK].data, effort))
    end = file.tell()
    file.seek(start)
    file.write(sizes.tobytes())
    file.seek(end)
