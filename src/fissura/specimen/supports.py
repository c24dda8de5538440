"""Kinds of support: what of a place they hold at zero."""

import numpy as np

from fissura.arrays import FloatArray
from fissura.errors import InputError
from fissura.specimen.functional import Functional, mean_displacement, mean_rotation
from fissura.specimen.place import Place


def _normal(place: Place, key: str) -> FloatArray:
    """Unit vector normal to a place, its largest component positive: supports hold both ways."""
    outward = place.outward
    if outward is None:
        problem = "the place faces all ways: its surface has no direction that could be held"
        raise InputError(key, problem, "a part of the surface, or a clamp")
    return outward if outward[np.argmax(np.abs(outward))] > 0.0 else -outward + 0.0


def pin(place: Place, key: str) -> list[Functional | None]:
    """Hinge: no translation, no rotation but the one about the line across which the place is given.

    The shape of the place has no say in it: platens of any width, on specimens of any thickness, turn alike.
    """
    normal, hinge = _normal(place, key), place.hinge
    if hinge is None:
        problem = "the place has no line about which it could turn: it faces where it is given along"
        raise InputError(key, problem, "along another axis, or a clamp")
    along = np.cross(hinge, normal)
    along = along if along @ place.along > 0.0 else -along
    return [mean_displacement(place, unit) for unit in np.eye(3)] + [
        mean_rotation(place, unit) for unit in (along, normal)
    ]


def roller(place: Place, key: str) -> list[Functional | None]:
    """No translation along the mean normal."""
    return [mean_displacement(place, _normal(place, key))]


def clamp(place: Place, key: str) -> list[Functional | None]:
    """Neither translation nor rotation."""
    return [mean_displacement(place, unit) for unit in np.eye(3)] + [mean_rotation(place, unit) for unit in np.eye(3)]


def guide(place: Place, key: str) -> list[Functional | None]:
    """No rotation, as in a frame that slides but does not turn."""
    return [mean_rotation(place, unit) for unit in np.eye(3)]
