"""A flat part of the surface of a specimen."""

from dataclasses import dataclass

from fissura.arrays import FloatArray
from fissura.specimen.convex import area_vector


@dataclass(frozen=True, eq=False)
class SurfacePart:
    """A flat convex part of the surface.

    Attributes
    ----------
    polygon : (k, 3) array
        Corners, counterclockwise from outside [m].
    normal : (3,) array
        Outward unit normal.
    cell : int
        The convex cell behind it.
    """

    polygon: FloatArray
    normal: FloatArray
    cell: int

    @property
    def area(self) -> float:
        """Area [m^2]."""
        return float(area_vector(self.polygon) @ self.normal)
