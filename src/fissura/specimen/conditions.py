"""Supports, load and gauge as weighted sums of point displacements (theory section 6).

They belong to the specimen, never to bodies: a :class:`Functional` knows points and coefficients only, and is
attached to whichever bodies own its points in a discretization.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.specimen.place import Place, place_from_part
from fissura.specimen.surface import ON_SURFACE

if TYPE_CHECKING:
    from collections.abc import Callable

    from fissura.case import Case, Gauge, Load
    from fissura.specimen.domain import Domain

__all__ = ["SUPPORTS", "Conditions", "Functional", "Held", "conditions_from_case", "load_direction"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Functional:
    """A weighted sum of point displacements, ``sum_k coefficients[k] . u(points[k])``.

    As a load it is the work-conjugate set of point forces.

    Attributes
    ----------
    points : (k, 3) array
        Points on the surface [m].
    coefficients : (k, 3) array
        Weights of the displacement components.
    cells : (k,) array
        The convex cell of the specimen behind each point.
    """

    points: FloatArray
    coefficients: FloatArray
    cells: IntArray

    @property
    def middle(self) -> FloatArray:
        """Mean of the points, weighted by the sizes of their coefficients, shape (3,) [m]."""
        return np.average(self.points, axis=0, weights=np.linalg.norm(self.coefficients, axis=1))

    def __sub__(self, other: Functional) -> Functional:
        return Functional(
            np.concatenate([self.points, other.points]),
            np.concatenate([self.coefficients, -other.coefficients]),
            np.concatenate([self.cells, other.cells]),
        )


@dataclass(frozen=True)
class Held:
    """A support as a whole.

    Attributes
    ----------
    middle : (3,) array
        Centroid of its place [m].
    functionals : int
        How many functionals it has.
    """

    middle: FloatArray
    functionals: int


@dataclass(frozen=True)
class Conditions:
    """Boundary conditions and measurements of a test.

    Attributes
    ----------
    supports : tuple of Functional
        Each is held at zero; those of the first support come first.
    load : Functional
        Distribution of the unit load; as a functional, the mean displacement along the load.
    control : Functional
        The controlled quantity: the gauge, or the displacement of the load.
    gauge : Functional or None
        The gauge, whatever is controlled; None where there is none.
    held : tuple of Held
        The supports, to whom `supports` belong in this order.
    pulls : bool
        Whether the load points out of the specimen.
    """

    supports: tuple[Functional, ...]
    load: Functional
    control: Functional
    gauge: Functional | None = None
    held: tuple[Held, ...] = ()
    pulls: bool = False


def _mean(place: Place, direction: FloatArray) -> Functional:
    """Mean displacement of a place along a direction."""
    return Functional(place.points, place.weights[:, None] * direction, place.cells)


def _rotation(place: Place, unit: FloatArray) -> Functional | None:
    """Mean rotation of a place about a line through its centroid, times its radius of gyration [m].

    None when the place has no extent beside that line.
    """
    arm = place.points - place.centroid
    lever = np.cross(unit, arm)
    inertia = float(place.weights @ np.einsum("ka,ka->k", lever, lever))
    if inertia <= 1e-18:
        return None
    return Functional(place.points, place.weights[:, None] * lever / np.sqrt(inertia), place.cells)


def _normal(place: Place, key: str) -> FloatArray:
    """Unit vector normal to a place, its largest component positive: supports hold both ways."""
    outward = place.outward
    if outward is None:
        problem = "the place faces all ways: its surface has no direction that could be held"
        raise InputError(key, problem, "a part of the surface, or a clamp")
    return outward if outward[np.argmax(np.abs(outward))] > 0.0 else -outward + 0.0


def _pin(place: Place, key: str) -> list[Functional | None]:
    """Hinge: no translation, no rotation but the one about the line across which the place is given.

    The shape of the place has no say in it: platens of any width, on specimens of any thickness, turn alike.
    """
    normal, hinge = _normal(place, key), place.hinge
    if hinge is None:
        problem = "the place has no line about which it could turn: it faces where it is given along"
        raise InputError(key, problem, "along another axis, or a clamp")
    along = np.cross(hinge, normal)
    along = along if along @ place.along > 0.0 else -along
    return [_mean(place, unit) for unit in np.eye(3)] + [_rotation(place, unit) for unit in (along, normal)]


def _roller(place: Place, key: str) -> list[Functional | None]:
    """No translation along the mean normal."""
    return [_mean(place, _normal(place, key))]


def _clamp(place: Place, key: str) -> list[Functional | None]:
    """Neither translation nor rotation."""
    return [_mean(place, unit) for unit in np.eye(3)] + [_rotation(place, unit) for unit in np.eye(3)]


#: Kinds of support by name.
SUPPORTS: dict[str, Callable[[Place, str], list[Functional | None]]] = {
    "pin": _pin,
    "roller": _roller,
    "clamp": _clamp,
}


def _check_stability(supports: list[Functional], centre: FloatArray, size: float) -> None:
    """The supports must stop all six rigid motions."""
    rows = np.array(
        [
            np.concatenate(
                [f.coefficients.sum(axis=0), np.cross((f.points - centre) / size, f.coefficients).sum(axis=0)]
            )
            for f in supports
        ]
    ).reshape(-1, 6)
    rows = rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-300)
    singular = np.linalg.svd(rows, compute_uv=False)
    if len(singular) < 6 or singular[-1] < 1e-6:
        held = int(np.sum(singular > 1e-6))
        raise InputError(
            "supports",
            f"they hold {held} of the 6 rigid motions of the specimen",
            "a pin and a roller apart from it, or a clamp",
        )


def conditions_from_case(case: Case, domain: Domain) -> Conditions:
    """Place supports, load and gauge of a case on its specimen.

    Raises
    ------
    InputError
        A place off the surface, an unknown kind of support, supports that leave the specimen movable.
    """
    l_f = case.discretization.l_f
    supports: list[Functional] = []
    held: list[Held] = []
    for k, part in enumerate(case.supports):
        kind = SUPPORTS.get(part.type)
        if kind is None:
            raise InputError(f"supports[{k}].type", f"{part.type!r} is not known", ", ".join(SUPPORTS))
        place = place_from_part(part, domain, l_f, f"supports[{k}]")
        rows = [row for row in kind(place, f"supports[{k}].{part.naming}") if row is not None]
        supports += rows
        held.append(Held(place.centroid, len(rows)))
    _check_stability(supports, domain.bounds.mean(axis=0), float(domain.size.max()))

    place = place_from_part(case.load, domain, l_f, "load")
    outward, direction = place.outward, load_direction(case.load, place)
    load = _mean(place, direction)
    pulls = outward is not None and float(direction @ outward) > 0.0

    gauge = None if case.gauge is None else _gauge(case.gauge, domain, l_f)
    if case.quantity == "displacement":
        return Conditions(tuple(supports), load, load, gauge, tuple(held), pulls)
    if gauge is None:
        raise InputError("gauge", "is missing, but control.type is 'gauge'", "a table [gauge] with a and b")
    return Conditions(tuple(supports), load, gauge, gauge, tuple(held), pulls)


def load_direction(part: Load, place: Place) -> FloatArray:
    """Unit vector (3,) along the load: as the case says, or into the specimen.

    Raises
    ------
    InputError
        The case does not say, and the place faces all ways.
    """
    if part.direction is not None:
        given: FloatArray = np.asarray(part.direction, float)
        return np.asarray(given / np.linalg.norm(given))
    if place.outward is not None:
        return -place.outward
    problem = "missing, and the place of the load faces all ways"
    raise InputError("load.direction", problem, "three numbers, the direction in which it pushes")


def _gauge(part: Gauge, domain: Domain, l_f: float) -> Functional:
    """Mean displacement of the place b minus that of a, along the gauge's direction."""
    a = place_from_part(part.a, domain, l_f, "gauge.a")
    b = place_from_part(part.b, domain, l_f, "gauge.b")
    near = 1e-3 * ON_SURFACE * domain.complex.extent
    if a.points.shape == b.points.shape and np.allclose(a.points, b.points, rtol=0.0, atol=near):
        raise InputError("gauge.b", "is the same place as gauge.a", "another place")
    if part.direction is None:
        along = b.centroid - a.centroid
        if np.linalg.norm(along) <= near:
            raise InputError("gauge.b", "lies at the same place as gauge.a", "another place, or a gauge.direction")
    else:
        along = np.asarray(part.direction, float)
    along = along / np.linalg.norm(along)
    return _mean(b, along) - _mean(a, along)
