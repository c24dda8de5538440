"""Building specimens: convex cells added, cut and taken away, their planes known by identity."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from fissura.arrays import FloatArray
from fissura.specimen.convex import Convex, Degenerate
from fissura.specimen.planes import Face, Planes, opposite


@dataclass(frozen=True, eq=False)
class Cell:
    """A convex cell while a specimen is being built.

    Attributes
    ----------
    shape : Convex
        The polyhedron.
    names : mapping
        Surface to which each face belongs where it is not open.
    closed : frozenset of Face
        Faces through which nothing is connected.
    rules : tuple of Face
        A nucleus owns material here only if it lies in front of each of these faces.
    origin : int
        Number of the cell from which this one was cut; see `Solid.number`.
    """

    shape: Convex
    names: Mapping[Face, str] = field(default_factory=dict)
    closed: frozenset[Face] = frozenset()
    rules: tuple[Face, ...] = ()
    origin: int = -1

    def named(self, face: Face, name: str) -> Cell:
        """The same with one of its faces on a surface; a cell without that face stays as it is."""
        return replace(self, names={**self.names, face: name}) if face in self.shape.faces else self


class Solid:
    """Builder of a `Complex` by binary space partition.

    Planes that coincide are one (`Planes`), and every cell knows which of its faces are on which surface. Whatever is
    not named is on the surface ``"surface"``.

    Parameters
    ----------
    low, high : (3,) array
        Corners of a box that holds the whole specimen [m].
    """

    def __init__(self, low: ArrayLike, high: ArrayLike) -> None:
        low, high = np.asarray(low, float), np.asarray(high, float)
        self.extent = float((high - low).max())
        self.planes = Planes(0.5 * (low + high), self.extent)
        self.cells: list[Cell] = []
        #: Parts of faces that belong to a surface, whatever the rest of the plane belongs to.
        self.regions: dict[Face, list[tuple[FloatArray, str]]] = {}
        #: Surfaces of faces that no cell names.
        self.walls: dict[Face, str] = {}
        #: Surfaces in the order in which they are numbered; further ones follow.
        self.surfaces: list[str] = []
        self._low, self._high = low - 0.5 * self.extent, high + 0.5 * self.extent

    @property
    def tolerance(self) -> float:
        """Length that is round-off [m]."""
        return self.planes.tolerance

    def shape(self, faces: Iterable[Face]) -> Convex | None:
        """The polyhedron that faces bound, or None where they enclose nothing."""
        return Convex.bounded(tuple(faces), self.planes, self._low, self._high)

    def add(self, half_spaces: Iterable[tuple[ArrayLike, float]], names: Sequence[str | None]) -> None:
        """Add a convex cell, which may touch others but not overlap them.

        Parameters
        ----------
        half_spaces : iterable of (normal, offset)
            The cell is where ``normal @ x <= offset`` for all of them.
        names : sequence of str or None
            The surface of each; None where none of it will be on the surface.

        Raises
        ------
        Degenerate
            The half-spaces enclose no bounded volume.
        """
        named: dict[Face, str] = {}
        faces = []
        for (normal, offset), name in zip(half_spaces, names, strict=True):
            face = self.planes.find(normal, offset)
            faces.append(face)
            if name is not None:
                named[face] = name
                self._declare(name)
        shape = self.shape(faces)
        if shape is None:
            raise Degenerate("the half-spaces enclose no volume")
        self.cells.append(Cell(shape, named))

    def add_cell(self, cell: Cell) -> None:
        """Add a cell whose faces are known to `planes`."""
        for name in cell.names.values():
            self._declare(name)
        self.cells.append(cell)

    def divided(self, cell: Cell, face: Face) -> tuple[Cell | None, Cell | None]:
        """What of a cell lies behind a face, and what in front of it."""
        h = cell.shape.heights(self.planes.normal(face), self.planes.offset(face))
        if h.max() <= self.tolerance:
            return cell, None
        if h.min() >= -self.tolerance:
            return None, cell
        behind, ahead = self.shape((*cell.shape.faces, face)), self.shape((*cell.shape.faces, opposite(face)))
        if behind is None or ahead is None:  # one of them is thinner than round-off
            return (None, cell) if behind is None else (cell, None)
        return replace(cell, shape=behind), replace(cell, shape=ahead)

    def split(self, face: Face, chosen: Callable[[Cell], bool] | None = None) -> None:
        """Divide cells by a plane, which stays open.

        Parameters
        ----------
        face : Face
            The plane.
        chosen : callable, optional
            Tells which cells are divided; by default all.
        """
        out: list[Cell] = []
        for cell in self.cells:
            if chosen is None or chosen(cell):
                out += [part for part in self.divided(cell, face) if part is not None]
            else:
                out.append(cell)
        self.cells = out

    def minus(self, half_spaces: Iterable[tuple[ArrayLike, float]], names: Sequence[str | None]) -> bool:
        """Take a convex void away.

        Parameters
        ----------
        half_spaces : iterable of (normal, offset)
            The void is where ``normal @ x <= offset`` for all of them; it need not be bounded.
        names : sequence of str or None
            The surface that each leaves.

        Returns
        -------
        bool
            Whether it touched anything.
        """
        faces = []
        for (normal, offset), name in zip(half_spaces, names, strict=True):
            face = self.planes.find(normal, offset)
            faces.append((face, name))
            if name is not None:
                self._declare(name)
                self.walls.setdefault(opposite(face), name)
        out: list[Cell] = []
        touched = False
        for cell in self.cells:
            kept, gone = self.without(cell, faces)
            touched |= gone
            out += kept
        self.cells = out
        return touched

    def without(self, cell: Cell, void: Sequence[tuple[Face, str | None]]) -> tuple[list[Cell], bool]:
        """What is left of a cell when a void is taken from it, and whether anything was taken.

        Parameters
        ----------
        cell : Cell
            The cell.
        void : sequence of (Face, str or None)
            The half-spaces of the void and the surfaces that they leave.
        """
        kept: list[Cell] = []
        rest: Cell | None = cell
        for face, name in void:
            if rest is None:
                break
            rest, ahead = self.divided(rest, face)
            if ahead is not None:
                kept.append(ahead if name is None else ahead.named(opposite(face), name))
        return ([cell], False) if rest is None else (kept, True)

    def number(self) -> None:
        """Number the cells, so that later parts know which of today's they come from."""
        self.cells = [replace(cell, origin=k) for k, cell in enumerate(self.cells)]

    def _declare(self, name: str) -> None:
        if name not in self.surfaces:
            self.surfaces.append(name)
