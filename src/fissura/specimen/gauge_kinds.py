"""Gauges: what each kind of them measures on the surface of a specimen."""

import numpy as np

from fissura.case import Gauge, Patch
from fissura.case.registry import GAUGES
from fissura.errors import InputError
from fissura.specimen.domain import Domain
from fissura.specimen.functional import Functional, mean_displacement
from fissura.specimen.place import Place, place_from_part


class Places:
    """Finds the places that the table of a gauge names.

    Parameters
    ----------
    domain : Domain
        The specimen.
    l_f : float
        Spacing of fine nuclei [m].
    key : str
        Where the table stands in the case.

    Attributes
    ----------
    found : list of Place
        Those that were asked for, in their order: pictures show them.
    """

    def __init__(self, domain: Domain, l_f: float, key: str) -> None:
        self.domain, self.l_f, self.key = domain, l_f, key
        self.found: list[Place] = []

    def __call__(self, part: Patch, key: str) -> Place:
        """Points, weights and normals of a place.

        Parameters
        ----------
        part : Patch
            The place as the case has it.
        key : str
            Its key in the table, for messages.

        Raises
        ------
        InputError
            The place is not on the surface.
        """
        self.found.append(place_from_part(part, self.domain, self.l_f, f"{self.key}.{key}"))
        return self.found[-1]


def gauge_from_part(part: Gauge, domain: Domain, l_f: float, key: str) -> tuple[Functional, tuple[Place, ...]]:
    """What a gauge of a case measures, and the places at which it does.

    Parameters
    ----------
    part : Gauge part of the case
        Its table.
    domain : Domain
        The specimen.
    l_f : float
        Spacing of fine nuclei [m].
    key : str
        Where the part stands in the case.

    Raises
    ------
    InputError
        A kind that is not known, or a place that is not on the surface.
    """
    places = Places(domain, l_f, key if part.parameters is None else f"{key}.{part.kind}")
    found = GAUGES.named(part.kind, key)(part.parameters or part, places)
    if not isinstance(found, Functional):
        raise InputError(places.key, f"the gauge {part.kind!r} gives {type(found).__name__}", "a Functional")
    return found, tuple(places.found)


def opening(part: Gauge, place: Places) -> Functional:
    """Mean displacement of the place b minus that of a, along the gauge's direction."""
    assert part.a is not None
    assert part.b is not None
    a, b = place(part.a, "a"), place(part.b, "b")
    near = 1e-3 * place.domain.on_surface
    if a.points.shape == b.points.shape and np.allclose(a.points, b.points, rtol=0.0, atol=near):
        raise InputError(f"{place.key}.b", f"is the same place as {place.key}.a", "another place")
    if part.direction is None:
        along = b.centroid - a.centroid
        if np.linalg.norm(along) <= near:
            problem = f"lies at the same place as {place.key}.a"
            raise InputError(f"{place.key}.b", problem, f"another place, or a {place.key}.direction")
    else:
        along = np.asarray(part.direction, float)
    along = along / np.linalg.norm(along)
    return mean_displacement(b, along) - mean_displacement(a, along)
