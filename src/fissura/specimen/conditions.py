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
from fissura.specimen.patch import Patch, patch_from_part

if TYPE_CHECKING:
    from collections.abc import Callable

    from fissura.case import Case, Gauge
    from fissura.specimen.box import Box

__all__ = ["SUPPORTS", "Conditions", "Functional", "Held", "conditions_from_case"]

FloatArray = NDArray[np.float64]


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
    """

    points: FloatArray
    coefficients: FloatArray

    @property
    def middle(self) -> FloatArray:
        """Mean of the points, weighted by the sizes of their coefficients, shape (3,) [m]."""
        return np.average(self.points, axis=0, weights=np.linalg.norm(self.coefficients, axis=1))

    def __sub__(self, other: Functional) -> Functional:
        return Functional(
            np.concatenate([self.points, other.points]),
            np.concatenate([self.coefficients, -other.coefficients]),
        )


@dataclass(frozen=True)
class Held:
    """A support as a whole.

    Attributes
    ----------
    key : str
        Where it stands in the case file, ``"supports[0]"``.
    middle : (3,) array
        Centroid of its place [m].
    functionals : int
        How many functionals it has.
    """

    key: str
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


def _mean(patch: Patch, direction: FloatArray) -> Functional:
    """Mean displacement of a patch along a direction."""
    return Functional(patch.points, patch.weights[:, None] * direction)


def _rotation(patch: Patch, unit: FloatArray) -> Functional | None:
    """Mean rotation of a patch about a line through its centroid, times its radius of gyration [m].

    None when the patch has no extent beside that line.
    """
    arm = patch.points - patch.centroid
    lever = np.cross(unit, arm)
    inertia = float(patch.weights @ np.einsum("ka,ka->k", lever, lever))
    if inertia <= 1e-18:
        return None
    return Functional(patch.points, patch.weights[:, None] * lever / np.sqrt(inertia))


def _pin(patch: Patch) -> list[Functional | None]:
    """Hinge: no translation, no rotation but the one about the line across which the place is given.

    The shape of the place has no say in it: platens of any width, on specimens of any thickness, turn alike.
    """
    along, normal, _ = patch.frame
    return [_mean(patch, unit) for unit in np.eye(3)] + [_rotation(patch, unit) for unit in (along, normal)]


def _roller(patch: Patch) -> list[Functional | None]:
    """No translation normal to the face."""
    return [_mean(patch, patch.frame[1])]


def _clamp(patch: Patch) -> list[Functional | None]:
    """Neither translation nor rotation."""
    return [_mean(patch, unit) for unit in np.eye(3)] + [_rotation(patch, unit) for unit in np.eye(3)]


#: Kinds of support by name.
SUPPORTS: dict[str, Callable[[Patch], list[Functional | None]]] = {
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


def conditions_from_case(case: Case, box: Box) -> Conditions:
    """Place supports, load and gauge of a case on its specimen.

    Patches are sampled at a fifth of the fine spacing, so that even fine bodies take their proper share.

    Raises
    ------
    InputError
        A patch off the surface, an unknown kind of support, supports that leave the specimen movable.
    """
    spacing = case.discretization.l_f / 5.0
    supports: list[Functional] = []
    held: list[Held] = []
    for k, part in enumerate(case.supports):
        kind = SUPPORTS.get(part.type)
        if kind is None:
            raise InputError(f"supports[{k}].type", f"{part.type!r} is not known", ", ".join(SUPPORTS))
        patch = patch_from_part(part, box, spacing, f"supports[{k}]")
        rows = [row for row in kind(patch) if row is not None]
        supports += rows
        held.append(Held(f"supports[{k}]", patch.centroid, len(rows)))
    _check_stability(supports, 0.5 * np.asarray(box.size), max(box.size))

    patch = patch_from_part(case.load, box, spacing, "load")
    if case.load.direction is None:
        direction = -patch.outward * patch.frame[1]
    else:
        direction = np.asarray(case.load.direction, float)
        direction = direction / np.linalg.norm(direction)
    load = _mean(patch, direction)
    pulls = patch.outward * float(direction @ patch.frame[1]) > 0.0

    gauge = None if case.gauge is None else _gauge(case.gauge, box, spacing)
    if case.quantity == "displacement":
        return Conditions(tuple(supports), load, load, gauge, tuple(held), pulls)
    if gauge is None:
        raise InputError("gauge", "is missing, but control.type is 'gauge'", "a table [gauge] with a and b")
    return Conditions(tuple(supports), load, gauge, gauge, tuple(held), pulls)


def _gauge(part: Gauge, box: Box, spacing: float) -> Functional:
    """Mean displacement of the place b minus that of a, along the gauge's direction."""
    a = patch_from_part(part.a, box, spacing, "gauge.a")
    b = patch_from_part(part.b, box, spacing, "gauge.b")
    if a.points.shape == b.points.shape and np.allclose(a.points, b.points, rtol=0.0, atol=1e-9 * max(box.size)):
        raise InputError("gauge.b", "is the same place as gauge.a", "another place")
    if part.direction is None:
        along = b.centroid - a.centroid
        if np.linalg.norm(along) <= 1e-9 * max(box.size):
            raise InputError("gauge.b", "lies at the same place as gauge.a", "another place, or a gauge.direction")
    else:
        along = np.asarray(part.direction, float)
    along = along / np.linalg.norm(along)
    return _mean(b, along) - _mean(a, along)
