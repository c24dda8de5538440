"""Elastic specimens with closed forms: a plate with a hole, a cylinder, an L-shaped frame.

`closed_forms.py` measures with them; tests use them, too.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fissura.adaptivity import region_from_case
from fissura.case import Case, Patch, case_from_dict
from fissura.case.macroscopic import macroscopic_elasticity
from fissura.contact import CusatisCedolin
from fissura.equilibrium import System, attach
from fissura.material import material_from_case
from fissura.specimen import Conditions, Functional, conditions_from_case, domain_from_case, place_from_part
from fissura.tessellation import discretize, nuclei_from_case

FloatArray = NDArray[np.float64]

L_F = 0.01
E, ALPHA = 60e9, 0.29
#: Side of the plate in radii of its hole; its thickness in spacings; radii that are fine.
PLATE, THICK, FINE = 8.0, 4.0, 2.0
#: Limits of rings around the hole in spacings; bodies within this angle of the equator count [rad].
RINGS, NEAR = (0.0, 1.0, 2.0, 4.0, 8.0), np.radians(25.0)
#: Depth of the square legs of frames in spacings.
DEPTH = 6.0


def case_of(**tables: Any) -> Case:
    """A case whose fracture does not matter."""
    return case_from_dict(
        {
            "material": {"E": E, "alpha": ALPHA, "f_t": 2.2e6, "G_t": 35.0},
            "discretization": {"l_f": L_F},
            "control": {"type": "displacement", "target": 1e-4},
            **tables,
        }
    )


def system_of(case: Case, *, full: bool, load: Functional | None = None) -> System:
    """Equations of a structure, under another load than the case has where that is given."""
    domain = domain_from_case(case)
    nuclei, conditions = nuclei_from_case(case, domain), conditions_from_case(case, domain)
    if load is not None:
        conditions = Conditions.single(conditions.supports, load)
    spacing = region_from_case(case, domain, full=full).spacing(nuclei.x)
    return System(discretize(nuclei, domain, spacing), material_from_case(case), CusatisCedolin, conditions)


def solved(system: System) -> FloatArray:
    """Undamaged displacements and rotations under the unit load, (6 n,)."""
    system.symmetric.factor_contacts(system.geometry, system.moduli)
    return system.symmetric.solve(system.load, 1e-9)


def kirsch(x: FloatArray, radius: float) -> FloatArray:
    """Stress around a hole at the origin of an infinite plate under unit tension along x; (k, 2) -> (k, 2, 2)."""
    r, angle = np.hypot(x[:, 0], x[:, 1]), np.arctan2(x[:, 1], x[:, 0])
    s = (radius / r) ** 2
    radial = 0.5 * (1 - s) + 0.5 * (1 - 4 * s + 3 * s**2) * np.cos(2 * angle)
    hoop = 0.5 * (1 + s) - 0.5 * (1 + 3 * s**2) * np.cos(2 * angle)
    shear = -0.5 * (1 + 2 * s - 3 * s**2) * np.sin(2 * angle)
    polar = np.stack([np.stack([radial, shear], -1), np.stack([shear, hoop], -1)], -2)
    c, d = np.cos(angle), np.sin(angle)
    turn = np.stack([np.stack([c, -d], -1), np.stack([d, c], -1)], -2)
    return np.asarray(turn @ polar @ turn.transpose(0, 2, 1), dtype=np.float64)


def plate(spacings: float, seed: int) -> tuple[Case, Functional]:
    """A plate with a hole in its middle, and the load of Kirsch's tractions on its sides (unit remote stress)."""
    radius, thick = spacings * L_F, THICK * L_F
    half = 0.5 * PLATE * radius
    lower, upper = [-half, -half], [half, half]
    case = case_of(
        seed=seed,
        specimen={"outline": [lower, [half, -half], upper, [-half, half]], "thickness": thick},
        minus={"cylinder": {"diameter": 2 * radius, "through": [0, 0, 0], "axis": "z"}},
        supports={"type": "clamp", "face": "left"},
        load={"face": "right", "direction": [1, 0, 0]},
        discretization={"l_f": L_F, "l_c": 4 * L_F},
        adaptivity={"r_f": 2 * L_F, "r_c": 10 * L_F,
                    "regions": [{"type": "ball", "center": [0, 0, 0.5 * thick], "radius": FINE * radius}]},
    )  # fmt: skip
    domain = domain_from_case(case)
    points, forces, cells = [], [], []
    for face in ("left", "right", "bottom", "top"):
        place = place_from_part(Patch.model_validate({"face": face}), domain, L_F, "load")
        traction = np.einsum("kij,kj->ki", kirsch(place.points[:, :2], radius), place.normals[:, :2])
        force = traction * (place.weights * 2 * half * thick)[:, None]
        points.append(place.points)
        forces.append(np.column_stack([force, np.zeros(len(force))]))
        cells.append(place.cells)
    return case, Functional(np.concatenate(points), np.concatenate(forces), np.concatenate(cells))


def hoop_stress(system: System, u: FloatArray, radius: float) -> dict[str, float]:
    """Hoop stress of bodies near the equator, ring by ring, and Kirsch's averaged over the same bodies."""
    x, volume = system.tessellation.x, system.tessellation.volume
    stress = system.stress(system.response(u, system.virgin()), 1.0)[:, :2, :2]
    exact = averaged(x, radius)
    r, angle = np.hypot(x[:, 0], x[:, 1]), np.arctan2(np.abs(x[:, 0]), np.abs(x[:, 1]))
    hoop = np.stack([-x[:, 1], x[:, 0]], axis=1) / r[:, None]
    found, wanted = (np.einsum("ni,nij,nj->n", hoop, s, hoop) for s in (stress, exact))
    out: dict[str, float] = {}
    for a, b in pairwise(RINGS):
        ring = (r >= radius + a * L_F) & (r < radius + b * L_F) & (angle < NEAR)
        out[f"stress {b:g}"] = float(np.average(found[ring], weights=volume[ring]))
        out[f"kirsch {b:g}"] = float(np.average(wanted[ring], weights=volume[ring]))
    return out


def averaged(x: FloatArray, radius: float) -> FloatArray:
    """Kirsch's stress averaged over bodies, by points of a grid that are nearest to their nuclei; (n, 2, 2)."""
    reach, step = radius + 2 * RINGS[-1] * L_F, L_F / 4
    flat = np.arange(-reach, reach, step) + 0.5 * step
    height = np.arange(0.0, THICK * L_F, step) + 0.5 * step
    a, b = (grid.ravel() for grid in np.meshgrid(flat, flat, indexing="ij"))
    outside = np.hypot(a, b) > radius
    plane = np.column_stack([a[outside], b[outside]])
    local = kirsch(plane, radius)
    total, count = np.zeros((len(x), 2, 2)), np.zeros(len(x))
    nuclei = cKDTree(x)
    for z in height:
        owner = nuclei.query(np.column_stack([plane, np.full(len(plane), z)]))[1]
        np.add.at(total, owner, local)
        np.add.at(count, owner, 1.0)
    return total / np.maximum(count, 1.0)[:, None, None]


def edge(case: Case, system: System, u: FloatArray, radius: float) -> dict[str, float]:
    """How the hole becomes an ellipse: both diameters over those of the closed form."""
    place = place_from_part(Patch.model_validate({"face": "hole"}), domain_from_case(case), L_F, "gauge")
    modulus, _ = macroscopic_elasticity().macroscopic(E, ALPHA)
    out = {}
    for name, axis, factor in (("opening", 0, 3.0), ("closing", 1, -1.0)):
        shape = place.weights * place.points[:, axis]
        coefficients = np.zeros_like(place.points)
        coefficients[:, axis] = shape / (shape @ place.points[:, axis])
        strain = float(attach(Functional(place.points, coefficients, place.cells), system.tessellation).ravel() @ u)
        out[name] = strain * modulus / factor
    return out


def cylinder(spacings: float, seed: int) -> Case:
    """A cylinder twice as long as wide, clamped and pulled; fine in its middle."""
    diameter = spacings * L_F
    length = 2.0 * diameter
    middle = {"lower": [-diameter, -diameter, 0.4 * length], "upper": [diameter, diameter, 0.6 * length]}
    return case_of(
        seed=seed,
        specimen={"cylinder": {"diameter": diameter, "length": length, "axis": "z"}},
        supports={"type": "clamp", "face": "bottom"},
        load={"face": "top", "direction": [0, 0, 1]},
        discretization={"l_f": L_F, "l_c": 4 * L_F},
        adaptivity={"r_f": L_F, "r_c": 9 * L_F, "regions": [{"type": "box", **middle}]},
    )


def axial_stiffness(system: System, u: FloatArray, spacings: float) -> dict[str, float]:
    """Stiffness of a cylinder over ``E A / L``, from the mean displacements of its ends and from bodies inside."""
    modulus, _ = macroscopic_elasticity().macroscopic(E, ALPHA)
    diameter = spacings * L_F
    length = 2.0 * diameter
    theory = modulus * 0.25 * np.pi * diameter**2
    x, moved = system.tessellation.x[:, 2], u.reshape(-1, 6)[:, 2]
    inside = np.abs(x - 0.5 * length) < 0.25 * length
    strain = float(np.polyfit(x[inside], moved[inside], 1)[0])
    return {"ends": length / float(system.load @ u) / theory, "inside": 1.0 / strain / theory}


def frame(slender: float, seed: int) -> Case:
    """An L of two legs, its foot clamped, its tip to be pushed up."""
    depth = DEPTH * L_F
    leg = slender * depth
    outline = [[0, 0], [depth, 0], [depth, leg - depth], [leg, leg - depth], [leg, leg], [0, leg]]
    return case_of(
        seed=seed,
        specimen={"outline": outline, "names": ["foot", "in", "under", "tip", "over", "out"], "thickness": depth},
        supports={"type": "clamp", "face": "foot"},
        load={"face": "tip", "direction": [0, 1, 0]},
    )


def beam_theory(slender: float) -> float:
    """Displacement of the tip of a frame under unit force: both legs bend, the arm shears, the leg is stretched."""
    modulus, poisson = macroscopic_elasticity().macroscopic(E, ALPHA)
    depth = DEPTH * L_F
    area, inertia = depth**2, depth**4 / 12.0
    length = slender * depth - 0.5 * depth
    shear = 10 * (1 + poisson) / (12 + 11 * poisson) * modulus / (2 * (1 + poisson)) * area
    bending = length**3 / 3.0 + length**3
    return float(bending / (modulus * inertia) + length / shear + length / (modulus * area))
