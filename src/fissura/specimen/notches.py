"""Notches as they were cut, and as they are to be cut."""

from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray

#: Surface of all notches.
SURFACE = "notch"


@dataclass(frozen=True, eq=False)
class Notch:
    """A notch as it was cut.

    Attributes
    ----------
    normal : (3,) array
        Unit normal of its mid-plane.
    point : (3,) array
        A point on the front, in the mid-plane [m].
    direction : (3,) array
        Unit vector in the mid-plane, from the mouth towards the front and perpendicular to it.
    front : (2, 3) array
        Ends of the front [m].
    depth : float
        Depth below the mouth [m].
    width : float
        Width; zero for an ideal cut [m].
    key : str
        Where it stands in the case file.
    place : str
        Key of its place there.
    """

    normal: FloatArray
    point: FloatArray
    direction: FloatArray
    front: FloatArray
    depth: float
    width: float
    key: str = "notch"
    place: str = "at"

    def across(self, x: FloatArray) -> FloatArray:
        """Distance of points (n, 3) from the mid-plane, shape (n,) [m]."""
        out: FloatArray = (x - self.point) @ self.normal
        return out

    def ahead(self, x: FloatArray) -> FloatArray:
        """Distance of points (n, 3) ahead of the level of the tip, negative behind it, shape (n,) [m]."""
        out: FloatArray = (x - self.point) @ self.direction
        return out

    def tip_lines(self) -> FloatArray:
        """Ends of the lines along the tip, shape (k, 2, 3): one for a cut, both edges of the root of a saw cut."""
        offsets = (0.0,) if self.width == 0.0 else (-0.5 * self.width, 0.5 * self.width)
        return np.array([self.front + offset * self.normal for offset in offsets])


@dataclass(frozen=True, eq=False)
class Slot:
    """A notch to be cut.

    Attributes
    ----------
    at : (3,) array
        A point of the mouth, in the mid-plane [m].
    direction : (3,) array
        Where the notch goes from there.
    along : (3,) array
        Direction of the front, not parallel to `direction`.
    depth, width : float
        Depth along `direction` and width [m].
    slack : float
        How far the mouth may lie outside of the specimen, whose curved surfaces are flat between corners [m].
    key : str
        Where it stands in the case file.
    place : str
        Key of its place there.
    """

    at: FloatArray
    direction: FloatArray
    along: FloatArray
    depth: float
    width: float = 0.0
    slack: float = 0.0
    key: str = "notch"
    place: str = "at"
