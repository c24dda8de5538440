"""A specimen: convex cells, named surfaces, notches."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.errors import Notice
from fissura.specimen.complex import Complex
from fissura.specimen.convex import area_vector, clipped_by, loops_of
from fissura.specimen.cross_sections import outline_of, smallest_section_of
from fissura.specimen.limits import ON_SURFACE, SAME
from fissura.specimen.locate import Locator
from fissura.specimen.notches import Notch
from fissura.specimen.planes import unit
from fissura.specimen.surface_part import SurfacePart


@dataclass(frozen=True, eq=False)
class Domain:
    """The body of material that is broken.

    Attributes
    ----------
    complex : Complex
        Its convex cells.
    surfaces : tuple of str
        Names of its surfaces, in the order of their numbers in the complex.
    notches : tuple of Notch
        Notches cut into it.
    notices : tuple of Notice
        What looks wrong in it, although it is allowed.
    """

    complex: Complex
    surfaces: tuple[str, ...]
    notches: tuple[Notch, ...] = ()
    notices: tuple[Notice, ...] = ()

    @cached_property
    def bounds(self) -> FloatArray:
        """Lowest and highest coordinates, shape (2, 3) [m]."""
        return np.array([self.complex.low.min(axis=0), self.complex.high.max(axis=0)])

    @property
    def size(self) -> FloatArray:
        """Dimensions along the axes, shape (3,) [m]."""
        out: FloatArray = self.bounds[1] - self.bounds[0]
        return out

    @property
    def on_surface(self) -> float:
        """How near to a flat surface points are on it [m]."""
        return ON_SURFACE * self.complex.extent

    @cached_property
    def volume(self) -> float:
        """Volume [m^3]."""
        return float(self.cell_volumes.sum())

    @cached_property
    def cell_volumes(self) -> FloatArray:
        """Volume of each convex cell, shape (K,) [m^3]."""
        out = np.zeros(len(self.complex.low))
        for k, polygons in enumerate(self._polygons):
            inner = 0.5 * (self.complex.low[k] + self.complex.high[k])
            out[k] = sum(float(area_vector(p) @ (p[0] - inner)) for p in polygons) / 3.0
        return out

    def contains(self, x: FloatArray) -> BoolArray:
        """Whether points lie in the material or on its surface; shape (n, 3) -> (n,)."""
        out: BoolArray = self.cell_of(x) >= 0
        return out

    def cell_of(self, x: FloatArray) -> IntArray:
        """The convex cell that holds each point, -1 for points outside; shape (n, 3) -> (n,).

        A point where cells meet belongs to one of them.
        """
        return self._locator(x)

    @cached_property
    def smallest_section(self) -> float:
        """Area of the smallest section perpendicular to an axis, the notches in its plane taken off [m^2]."""
        return smallest_section_of(self.faces(), SAME * self.complex.extent)

    def outline(self, normal: FloatArray, offset: float) -> tuple[FloatArray, ...]:
        """Outline of the section in the plane ``normal @ x = offset``, closed loops (k, 3) around the material [m]."""
        return outline_of(self.faces(), unit(normal), offset / float(np.linalg.norm(normal)), self.complex.extent)

    def faces(self, *names: str) -> tuple[SurfacePart, ...]:
        """Parts of surfaces; of all of them where no name is given.

        Raises
        ------
        KeyError
            A name that is not among `surfaces`.
        """
        for name in names:
            if name not in self.surfaces:
                raise KeyError(name)
        chosen = {self.surfaces.index(name) for name in names or self.surfaces}
        return tuple(part for surface, part in self._parts if surface in chosen)

    @cached_property
    def surface_numbers(self) -> tuple[int, ...]:
        """Number of the surface of each part of `faces`, all of them."""
        return tuple(number for number, _ in self._parts)

    @cached_property
    def _locator(self) -> Locator:
        return Locator(self.complex)

    @cached_property
    def _polygons(self) -> list[tuple[FloatArray, ...]]:
        """Faces of each cell as polygons."""
        c = self.complex
        out = []
        for k in range(len(c.low)):
            a, b = c.corner_start[k], c.corner_start[k + 1]
            start, corner, _ = loops_of(
                int(c.plane_start[k + 1] - c.plane_start[k]), c.twin[4 * a : 4 * b], c.face[4 * a : 4 * b]
            )
            points = c.corner[:, a:b].T[corner]
            out.append(tuple(points[start[f] : start[f + 1]] for f in range(len(start) - 1)))
        return out

    @cached_property
    def _parts(self) -> list[tuple[int, SurfacePart]]:
        """Number of the surface, and the part, for each part of a face that is not open."""
        c = self.complex
        tolerance = SAME * c.extent
        out = []
        for k, polygons in enumerate(self._polygons):
            for f, polygon in enumerate(polygons, start=int(c.plane_start[k])):
                for part in range(c.part_start[f], c.part_start[f + 1]):
                    edges = slice(c.edge_start[part], c.edge_start[part + 1])
                    left = clipped_by(polygon, c.edge_normal[edges], c.edge_offset[edges], tolerance)
                    if c.part_to[part] < 0 and left is not None:
                        out.append((-1 - int(c.part_to[part]), SurfacePart(left, c.normal[f], k)))
        return out
