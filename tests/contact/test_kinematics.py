import dataclasses

import numpy as np
import pytest

from equilibrium.models import block, random_rotation
from fissura.contact import contact_strains, kinematics, nodal_forces
from fissura.contact.kinematics import _frames

SIZE = (0.07, 0.05, 0.06)


@pytest.fixture(scope="module", params=["fine", "mixed"])
def tessellation(request):
    ball = None if request.param == "fine" else ((0.02, 0.02, 0.03), 0.015)
    return block(SIZE, 0.01, 5, fine_ball=ball)


@pytest.fixture(scope="module")
def geometry(tessellation):
    return kinematics(tessellation)


@pytest.fixture
def rng():
    return np.random.default_rng(20)


def rigid(x, translation, spin):
    return np.concatenate([translation + np.cross(spin, x), np.broadcast_to(spin, x.shape)], axis=1)


@pytest.mark.parametrize("seed", range(5))
def test_rigid_motion_strains_nothing(tessellation, geometry, seed):
    rng = np.random.default_rng(seed)
    translation, spin = rng.normal(size=3) * 0.1, rng.normal(size=3)
    u = rigid(tessellation.x, translation, spin)
    strain = contact_strains(geometry, u)
    scale = np.abs(u).max() / tessellation.contacts.length.min()
    assert np.abs(strain).max() < 1e-14 * scale


def test_strains_are_the_jump_at_the_centroid_over_the_length(tessellation, geometry, rng):
    u = rng.normal(size=(len(tessellation), 6))
    contacts = tessellation.contacts
    moved = [
        u[b, :3] + np.cross(u[b, 3:], contacts.centroid - tessellation.x[b]) for b in contacts.bodies.T
    ]  # displacement of the centroid with either body
    jump = moved[1] - moved[0]
    expected = np.einsum("cai,ci->ca", geometry.frame, jump) / contacts.length[:, None]
    np.testing.assert_allclose(contact_strains(geometry, u), expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_normal_strain_alone_when_a_body_leaves_along_the_normal(tessellation, geometry):
    c = 7
    body = tessellation.contacts.bodies[c, 1]
    u = np.zeros((len(tessellation), 6))
    u[body, :3] = 3e-6 * tessellation.contacts.normal[c]
    strain = contact_strains(geometry, u)[c]
    np.testing.assert_allclose(strain, [3e-6 / tessellation.contacts.length[c], 0, 0], rtol=1e-13, atol=1e-18)


def test_forces_are_the_transpose_of_strains(geometry, tessellation, rng):
    """Virtual work: ``sum A L s . e(u) = f(s) . u`` for any s and u."""
    for _ in range(5):
        u = rng.normal(size=(len(tessellation), 6))
        traction = rng.normal(size=(len(geometry), 3))
        inner = np.einsum("c,ca,ca->", geometry.volume, traction, contact_strains(geometry, u))
        outer = np.sum(nodal_forces(geometry, traction) * u)
        assert outer == pytest.approx(inner, rel=1e-11, abs=1e-13 * np.abs(geometry.volume).sum())


def test_internal_forces_have_no_resultant(geometry, tessellation, rng):
    forces = nodal_forces(geometry, rng.normal(size=(len(geometry), 3)))
    moments = forces[:, 3:] + np.cross(tessellation.x, forces[:, :3])
    assert np.abs(forces[:, :3].sum(axis=0)).max() < 1e-13 * np.abs(forces[:, :3]).sum()
    assert np.abs(moments.sum(axis=0)).max() < 1e-13 * np.abs(moments).sum()


def test_force_and_moment_of_one_contact(tessellation, geometry):
    """Tension pulls both bodies together: internal force on i is ``-A s``, its moment ``(c - x_i) x F``."""
    c = 11
    traction = np.zeros((len(geometry), 3))
    traction[c] = [2.0, 3.0, -1.0]
    vector = tessellation.contacts.area[c] * traction[c] @ geometry.frame[c]
    forces = nodal_forces(geometry, traction)
    for body, sign in zip(tessellation.contacts.bodies[c], (-1.0, 1.0), strict=True):
        arm = tessellation.contacts.centroid[c] - tessellation.x[body]
        np.testing.assert_allclose(forces[body, :3], sign * vector, rtol=1e-12)
        np.testing.assert_allclose(forces[body, 3:], sign * np.cross(arm, vector), rtol=1e-11, atol=1e-20)
    others = np.setdiff1d(np.arange(len(tessellation)), tessellation.contacts.bodies[c])
    assert not forces[others].any()


def test_frames_are_right_handed(geometry):
    frame = geometry.frame
    np.testing.assert_allclose(frame @ frame.transpose(0, 2, 1), np.tile(np.eye(3), (len(frame), 1, 1)), atol=1e-14)
    np.testing.assert_allclose(np.linalg.det(frame), 1.0, rtol=1e-13)


@pytest.mark.parametrize("normal", [*np.eye(3), *-np.eye(3), np.ones(3) / np.sqrt(3.0)])
def test_tangents_of_special_normals(normal):
    frame = np.empty((1, 3, 3))
    _frames(normal[None], frame)
    np.testing.assert_allclose(np.cross(frame[0, 1], frame[0, 2]), normal, atol=1e-15)


def test_strains_turn_with_the_specimen(tessellation, geometry, rng):
    """Normal strain and the size of the tangential strain do not see a rotation of everything."""
    turn = random_rotation(rng)
    contacts = tessellation.contacts
    turned = dataclasses.replace(
        tessellation,
        x=tessellation.x @ turn.T,
        contacts=dataclasses.replace(contacts, centroid=contacts.centroid @ turn.T, normal=contacts.normal @ turn.T),
    )
    u = rng.normal(size=(len(tessellation), 6))
    e = contact_strains(geometry, u)
    r = contact_strains(kinematics(turned), (u.reshape(-1, 2, 3) @ turn.T).reshape(-1, 6))
    size = np.abs(e).max()
    np.testing.assert_allclose(r[:, 0], e[:, 0], atol=1e-12 * size)
    np.testing.assert_allclose(np.hypot(*r[:, 1:].T), np.hypot(*e[:, 1:].T), atol=1e-12 * size)


def test_adjacency_lists_every_contact_of_every_body(geometry, tessellation):
    for body in range(0, len(tessellation), 7):
        listed = geometry.adjacent[geometry.first[body] : geometry.first[body + 1]]
        assert sorted(listed // 2) == np.flatnonzero((geometry.bodies == body).any(axis=1)).tolist()
        assert (geometry.bodies[listed // 2, listed % 2] == body).all()
