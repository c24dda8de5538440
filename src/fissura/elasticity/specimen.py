"""Elastic constants of finite specimens, as Fissura's runs have them: prisms under uniaxial tension.

Nuclei, bodies, supports, load and equations are those of any run at full resolution. One end is held in the mean, the
load is spread evenly over the other, and all sides are free. So the layer of biased contacts along the surface, about
one body thick, is in the numbers.
"""

from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from fissura.arrays import FloatArray
from fissura.case import Case, Patch, case_from_dict
from fissura.contact import law_from_case
from fissura.elasticity import limits
from fissura.equilibrium import System, attach
from fissura.material import material_from_case
from fissura.specimen import Domain, Functional, conditions_from_case, domain_from_case, place_from_part
from fissura.tessellation import Tessellation, discretize, nuclei_from_case, owners

#: Constants that only have to be possible, since only the elastic equations are used: no contact is too long for them.
_NO_FRACTURE = {"f_t": 1.0, "G_t": 1e9}


def prism_case(width: float, aspect: float, spacing: float, seed: int, E: float, alpha: float) -> Case:
    """A prism along x, held at its left end and pulled at its right.

    Parameters
    ----------
    width, spacing : float
        Depth and thickness, and ``l_min`` [m].
    aspect : float
        Length over width; 1 is a cube.
    seed : int
        Decides where nuclei are.
    E, alpha : float
        Contact constants [Pa], [1].
    """
    data: dict[str, Any] = {
        "name": "prism",
        "seed": seed,
        "specimen": {"size": [aspect * width, width, width]},
        "supports": [{"type": "clamp", "face": "left"}],
        "load": {"face": "right", "direction": [1, 0, 0]},
        "material": {"E": E, "alpha": alpha, **_NO_FRACTURE},
        "discretization": {"l_f": spacing},
        "control": {"type": "displacement", "target": 1e-4 * aspect * width},
    }
    return case_from_dict(data)


@dataclass(frozen=True)
class PrismConstants:
    """What a prism answers.

    Attributes
    ----------
    E_whole : float
        Modulus of elasticity from the mean displacements of both ends [Pa].
    E_gauge : float
        The same from gauges on the four sides, between bands at a quarter of the length from both ends [Pa].
    nu : float
        Lateral over axial strain, the former over the middle half of the sides.
    """

    E_whole: float
    E_gauge: float
    nu: float


class Prism:
    """Elastic equations of one prism, for contact constants yet to be given.

    Parameters
    ----------
    width, aspect, spacing, seed
        See :func:`prism_case`.

    Attributes
    ----------
    size : (3,) array
        Its length, depth and thickness [m].
    system : System
        Its equations, for contacts of modulus 1 Pa and ``alpha = 1``.
    """

    def __init__(self, width: float, aspect: float, spacing: float, seed: int) -> None:
        case = prism_case(width, aspect, spacing, seed, 1e9, 1.0)
        domain = domain_from_case(case)
        nuclei = nuclei_from_case(case, domain).complete()
        tessellation = discretize(nuclei, domain, np.zeros(len(nuclei)))
        conditions = conditions_from_case(case, domain)
        self.size = domain.size
        material = replace(material_from_case(case), E=1.0)  # less than any case may have
        self.system = System(tessellation, material, law_from_case(case), conditions)
        sides = _Sides(domain, tessellation, spacing)  # sampled as the load is
        self._rows = np.stack([sides.elongation(), sides.gauge(), sides.swelling()])

    def __len__(self) -> int:
        return len(self.system.tessellation)

    def solution(self, alpha: float) -> FloatArray:
        """Displacements and rotations under a load of 1 N, with contacts of modulus 1 Pa; (6 n,)."""
        system = self.system
        system.symmetric.factor_contacts(system.geometry, np.tile([1.0, alpha, alpha], (len(system.geometry), 1)))
        return system.symmetric.solve(system.load)

    def constants(self, alpha: float, E: float = 1.0) -> PrismConstants:
        """Elastic constants of the prism for given contact constants."""
        u = self.solution(alpha)
        stress = 1.0 / (self.size[1] * self.size[2])
        whole, axial, lateral = (float(row @ u) for row in self._rows)
        return PrismConstants(E * stress / whole, E * stress / axial, -lateral / axial)


class _Sides:
    """Means of displacements over places on the surface of a prism.

    Points of bodies that touch fewer than three others are left out. Contacts act at one point, so such a body at a
    corner of the prism may spin about a line, and moves far under the load that is spread over its face.
    """

    def __init__(self, domain: Domain, tessellation: Tessellation, spacing: float) -> None:
        self._domain, self._tessellation, self._spacing = domain, tessellation, spacing
        touching = np.bincount(tessellation.contacts.bodies.ravel(), minlength=len(tessellation))
        self._held = touching >= 3

    def mean(self, part: dict[str, Any], direction: int, factor: float) -> FloatArray:
        """A factor times the mean displacement of a place along an axis, as a row over all unknowns; (6 n,)."""
        place = place_from_part(Patch.model_validate(part), self._domain, self._spacing, "gauge")
        held = self._held[owners(self._tessellation, place.points, place.cells)]
        weights = place.weights[held] / place.weights[held].sum()
        functional = Functional(place.points[held], factor * weights[:, None] * np.eye(3)[direction], place.cells[held])
        return attach(functional, self._tessellation).ravel()

    def elongation(self) -> FloatArray:
        """Mean axial strain from end to end."""
        length = self._domain.size[0]
        return self.mean({"face": "right"}, 0, 1.0 / length) - self.mean({"face": "left"}, 0, 1.0 / length)

    def gauge(self) -> FloatArray:
        """Mean axial strain over the middle, from bands around the prism."""
        length = self._domain.size[0]
        span, band = limits.GAUGE * length, {"width": limits.BAND * length, "along": "x"}
        ends = ((-1.0, 0.5 * (length - span)), (1.0, 0.5 * (length + span)))
        bands = product(("bottom", "top", "front", "back"), ends)
        rows = [self.mean({"face": face, "at": at, **band}, 0, sign / (4.0 * span)) for face, (sign, at) in bands]
        return np.asarray(np.sum(rows, axis=0), dtype=np.float64)

    def swelling(self) -> FloatArray:
        """Mean lateral strain over the middle, of both lateral directions."""
        size = self._domain.size
        strip = {"at": 0.5 * size[0], "width": limits.GAUGE * size[0], "along": "x"}
        faces = (("bottom", 1, -1.0), ("top", 1, 1.0), ("front", 2, -1.0), ("back", 2, 1.0))
        rows = [self.mean({"face": face, **strip}, axis, sign / (2.0 * size[axis])) for face, axis, sign in faces]
        return np.asarray(np.sum(rows, axis=0), dtype=np.float64)
