import dataclasses

import numpy as np
import pytest

from equilibrium.models import (
    affine,
    beam,
    beam_system,
    block,
    half_fine,
    random_rotation,
    random_symmetric,
)
from fissura.contact import body_stress, contact_strains, kinematics
from fissura.equilibrium import settle

E = 60e9


@pytest.fixture(scope="module")
def tessellation():
    return block((0.07, 0.05, 0.06), 0.01, 9, fine_ball=((0.02, 0.02, 0.03), 0.015))


def uniform(tessellation, strain, alpha=1.0):
    """Frames and elastic tractions of an affine displacement."""
    geometry = kinematics(tessellation)
    traction = contact_strains(geometry, affine(tessellation, strain)) * E * np.array([1.0, alpha, alpha])
    return geometry.frame, traction


def surface_forces(tessellation, stress):
    """Tractions of a uniform stress on the surface facets: bodies, points, forces."""
    skin = tessellation.surface
    return skin.body, skin.centroid, skin.area[:, None] * (skin.normal @ stress)


@pytest.mark.parametrize("seed", range(3))
def test_uniform_strain_is_exact_in_every_body(tessellation, seed):
    """alpha = 1: ``sigma = E eps``; bodies on the surface count their surface tractions too."""
    strain = random_symmetric(np.random.default_rng(seed), 1e-5)
    stress = body_stress(tessellation, *uniform(tessellation, strain), *surface_forces(tessellation, E * strain))
    np.testing.assert_allclose(stress, np.tile(E * strain, (len(tessellation), 1, 1)), atol=1e-10 * E * 1e-5)


def test_interior_bodies_need_no_surface_forces(tessellation):
    strain = random_symmetric(np.random.default_rng(4), 1e-5)
    stress = body_stress(tessellation, *uniform(tessellation, strain))
    interior = np.setdiff1d(np.arange(len(tessellation)), tessellation.surface.body)
    assert len(interior) >= 5
    np.testing.assert_allclose(stress[interior], np.tile(E * strain, (len(interior), 1, 1)), atol=1e-10 * E * 1e-5)
    on_surface = np.unique(tessellation.surface.body)
    assert np.abs(stress[on_surface] - E * strain).max() > 0.1 * E * np.abs(strain).max()


@pytest.mark.parametrize("alpha", [0.05, 0.29, 1.0])
def test_volumetric_strain_is_exact_for_every_alpha(tessellation, alpha):
    strain = 2e-5 * np.eye(3)
    stress = body_stress(tessellation, *uniform(tessellation, strain, alpha), *surface_forces(tessellation, E * strain))
    np.testing.assert_allclose(stress, np.tile(E * strain, (len(tessellation), 1, 1)), atol=1e-10 * E * 1e-5)


def test_stress_is_symmetric_and_linear_in_traction(tessellation):
    rng = np.random.default_rng(2)
    geometry = kinematics(tessellation)
    a, b = rng.normal(size=(2, len(geometry), 3))
    one, two, both = (body_stress(tessellation, geometry.frame, t) for t in (a, b, 2 * a - b))
    np.testing.assert_array_equal(one, one.transpose(0, 2, 1))
    np.testing.assert_allclose(both, 2 * one - two, atol=1e-12 * np.abs(both).max())


@pytest.mark.parametrize("region", [None, half_fine()], ids=["full", "mixed"])
def test_mean_stress_is_the_virial_of_the_external_forces(region):
    """Equilibrium: ``sum V_i sigma_i = sym sum f (x) p`` over load and reactions."""
    system = beam_system(beam(), region=region)
    state = settle(system, system.virgin(), 1e-6)
    stress = system.stress(state.response, state.load)
    total = np.einsum("i,iab->ab", system.tessellation.volume, stress)
    reactions = -system.supports.stiffness * (system.supports.rows @ state.response.u[system.supports.dofs])
    acting = [(system.conditions.loads[0], state.load), *zip(system.conditions.supports, reactions, strict=True)]
    forces = np.concatenate([size * f.coefficients for f, size in acting])
    points = np.concatenate([f.points for f, _ in acting])
    virial = np.einsum("ka,kb->ab", forces, points)
    np.testing.assert_allclose(total, 0.5 * (virial + virial.T), atol=1e-7 * np.abs(virial).max())
    # The reactions are what they must be: statics of a beam in three-point bending, up to the trace of spin stiffness.
    np.testing.assert_allclose(forces.sum(axis=0), 0.0, atol=1e-7 * state.load)
    np.testing.assert_allclose(np.cross(points, forces).sum(axis=0), 0.0, atol=1e-7 * state.load * 0.1)


def test_stress_turns_with_the_specimen(tessellation):
    rng = np.random.default_rng(3)
    turn = random_rotation(rng)
    contacts = tessellation.contacts
    turned = dataclasses.replace(
        tessellation,
        x=tessellation.x @ turn.T,
        contacts=dataclasses.replace(contacts, centroid=contacts.centroid @ turn.T, normal=contacts.normal @ turn.T),
    )
    u = rng.normal(size=(len(tessellation), 6)) * 1e-6
    moduli = E * np.array([1.0, 0.29, 0.29])
    stresses = []
    for structure, motion in ((tessellation, u), (turned, (u.reshape(-1, 2, 3) @ turn.T).reshape(-1, 6))):
        geometry = kinematics(structure)
        stresses.append(body_stress(structure, geometry.frame, contact_strains(geometry, motion) * moduli))
    np.testing.assert_allclose(stresses[1], turn @ stresses[0] @ turn.T, atol=1e-11 * np.abs(stresses[0]).max())
