"""Small structures and cases for the tests of mechanics."""

from pathlib import Path

import numpy as np

from fissura.adaptivity import RefinedRegion
from fissura.case import case_from_dict
from fissura.contact import CusatisCedolin
from fissura.equilibrium import Leg, System
from fissura.linear.assembly import assemble, assemble_secant
from fissura.material import Material
from fissura.specimen import Domain, conditions_from_case, domain_from_case
from fissura.specimen.assemble import complex_of
from fissura.specimen.cutting import cut_notches
from fissura.specimen.shapes.prism import box
from fissura.tessellation import Nuclei, discretize, nuclei_from_case

CONCRETE = Material.standard(60e9, 0.29, 2.2e6, 35.0)

#: A beam small enough to be broken in a blink: 97 bodies at full resolution, 610 with l_f = 5 mm.
BEAM = {
    "specimen": {"size": [0.1, 0.04, 0.02]},
    "notch": {"face": "bottom", "position": 0.05, "depth": 0.012},
    "supports": [
        {"type": "pin", "face": "bottom", "at": 0.01},
        {"type": "roller", "face": "bottom", "at": 0.09},
    ],
    "load": {"face": "top", "at": 0.05},
    "gauge": {"a": {"face": "bottom", "at": 0.046}, "b": {"face": "bottom", "at": 0.054}},
    "material": {"E": 60e9, "alpha": 0.29, "f_t": 2.2e6, "G_t": 35.0},
    "discretization": {"l_f": 0.01, "l_c": 0.02},
    "control": {"target": 1e-4},
}


def changed(data, changes):
    """Data of a case with other values; tables are merged, None takes a key out."""
    out = {**data}
    for key, value in changes.items():
        if value is None:
            out.pop(key, None)
        elif isinstance(value, dict) and isinstance(out.get(key), dict):
            out[key] = {**out[key], **value}
        else:
            out[key] = value
    return out


def beam(**changes):
    """The small beam with changes."""
    return case_from_dict(changed(BEAM, changes), Path())


def box_domain(size, *slots):
    """A box with notches."""
    solid = box(size)
    notches = cut_notches(solid, slots)
    return Domain(*complex_of(solid), notches=notches)


def block(size, l_f, seed, *, fine_ball=None, l_c=None, notches=()):
    """Tessellation of a box; with a fine ball (center, radius) it is coarse elsewhere."""
    domain = box_domain(size, *notches)
    l_c = 3.0 * l_f if l_c is None else l_c
    nuclei = Nuclei.placed(domain.complex, l_f, np.random.default_rng(seed))
    region = RefinedRegion(l_f, l_c, l_f, l_c, everywhere=fine_ball is None)
    if fine_ball is not None:
        center, radius = fine_ball
        region = RefinedRegion(l_f, l_c, l_f, l_c, balls=np.array([center]), radii=np.array([radius]))
    return discretize(nuclei, domain, region.spacing(nuclei.x))


def beam_system(case=None, *, region=None, linear="auto"):
    """Equations of a case at full resolution, or with another region."""
    case = beam() if case is None else case
    domain = domain_from_case(case)
    nuclei = nuclei_from_case(case, domain)
    spacing = np.zeros(len(nuclei)) if region is None else region.spacing(nuclei.x)
    m = case.material
    material = Material(m.E, m.alpha, m.f_t, m.G_t, m.f_s, m.f_c, m.G_s, m.K_c, m.mu, m.beta, m.n_c)
    conditions = conditions_from_case(case, domain)
    return System(discretize(nuclei, domain, spacing), material, CusatisCedolin, conditions, linear)


def secant_entries(system, history):
    """Entries of the secant stiffness for given damage."""
    return assemble_secant(system.geometry, system.pattern, system.secant_moduli(history))


def tangent_entries(system, response, history):
    """Entries of the consistent tangent stiffness at a response."""
    stiffness = np.zeros((len(system.geometry), 3, 3))
    stiffness[:, range(3), range(3)] = system.moduli
    stiffness[system.damageable] = system.law.tangent(response.strain[system.damageable], history)
    return assemble(system.geometry, system.pattern, stiffness)


def elastic_contacts(system):
    """Contacts without the damage law."""
    return np.setdiff1d(np.arange(len(system.geometry)), system.damageable)


def admitted(domain, cell, x):
    """Whether nuclei obey the rules of sides of a convex cell."""
    c = domain.complex
    rules = slice(c.rule_start[cell], c.rule_start[cell + 1])
    return (x @ c.rule_normal[rules].T > c.rule_offset[rules]).all(axis=1)


def nearest_admitted(domain, x, points, cells):
    """Nucleus nearest to each point, of those that may own material in the point's convex cell."""
    distance = np.linalg.norm(points[:, None] - x[None], axis=2)
    for k in np.unique(cells):
        distance[np.ix_(cells == k, ~admitted(domain, k, x))] = np.inf
    return distance.argmin(axis=1)


def half_fine(l_f=0.01, l_c=0.02):
    """Region around the notch of the small beam only."""
    return RefinedRegion(l_f, l_c, l_f, l_c, balls=np.array([[0.05, 0.02, 0.01]]), radii=np.array([0.015]))


def random_symmetric(rng, size=1.0):
    """Random symmetric tensor."""
    a = rng.normal(size=(3, 3))
    return 0.5 * size * (a + a.T)


def random_rotation(rng):
    """Random proper rotation."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def affine(tessellation, gradient):
    """Displacements ``gradient x`` of the nuclei without rotation, shape (n, 6)."""
    u = np.zeros((len(tessellation), 6))
    u[:, :3] = tessellation.x @ gradient.T
    return u


def simple_leg(stage):
    """The leg from rest to the last target of a stage, without other loads."""
    end, steps = stage.target, (stage.max_step, stage.first_step, stage.min_step)
    share = stage.max_step / abs(end) if stage.energy_step is None else stage.energy_step
    return Leg(0, stage.quantity, np.zeros(1), 0.0, end, 0.0, 1.0, *steps, share)
