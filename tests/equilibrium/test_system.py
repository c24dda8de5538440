import numpy as np
import pytest

from equilibrium.models import (
    CONCRETE,
    beam,
    beam_system,
    elastic_contacts,
    half_fine,
    nearest_admitted,
    secant_entries,
)
from fissura.adaptivity import gauge_compliance
from fissura.adaptivity.calibration import elastic_share
from fissura.contact import contact_strains
from fissura.equilibrium import attach, dissipation, limits, settle
from fissura.equilibrium.with_damage import changes
from fissura.specimen import Functional, domain_from_case
from fissura.tessellation import owners

YIELD = CONCRETE.f_t / CONCRETE.E


@pytest.fixture(scope="module")
def mixed():
    return beam_system(region=half_fine())


DOMAIN = domain_from_case(beam())


def random_points(rng, count):
    """Points of the beam, and the convex cells that hold them."""
    points = rng.uniform(0, 1, (count, 3)) * [0.1, 0.04, 0.02]
    return points, DOMAIN.cell_of(points)


def test_points_belong_to_the_nearest_nucleus_on_their_side_of_the_notch(mixed):
    points, cells = random_points(np.random.default_rng(0), 2000)
    x = mixed.tessellation.x
    body = owners(mixed.tessellation, points, cells)
    np.testing.assert_array_equal(body, nearest_admitted(DOMAIN, x, points, cells))
    below = points[:, 1] < 0.012
    assert ((points[:, 0] < 0.05) == (x[body, 0] < 0.05))[below].all()
    distance = np.linalg.norm(points[:, None] - x[None], axis=2)
    np.testing.assert_array_equal(body[~below], distance[~below].argmin(axis=1))
    assert 0 < (body != distance.argmin(axis=1)).sum() < 0.2 * below.sum()


def test_attached_forces_keep_resultant_and_moment(mixed):
    rng = np.random.default_rng(1)
    points, cells = random_points(rng, 30)
    functional = Functional(points, rng.normal(size=(30, 3)), cells)
    nodal = attach(functional, mixed.tessellation)
    np.testing.assert_allclose(nodal[:, :3].sum(axis=0), functional.coefficients.sum(axis=0), atol=1e-13)
    np.testing.assert_allclose(
        (nodal[:, 3:] + np.cross(mixed.tessellation.x, nodal[:, :3])).sum(axis=0),
        np.cross(functional.points, functional.coefficients).sum(axis=0),
        atol=1e-14,
    )


def test_attached_functional_measures_points_of_bodies(mixed):
    rng = np.random.default_rng(2)
    points, cells = random_points(rng, 30)
    functional = Functional(points, rng.normal(size=(30, 3)), cells)
    u = rng.normal(size=(len(mixed.tessellation), 6))
    body = owners(mixed.tessellation, points, cells)
    moved = u[body, :3] + np.cross(u[body, 3:], functional.points - mixed.tessellation.x[body])
    assert np.sum(attach(functional, mixed.tessellation) * u) == pytest.approx(np.sum(functional.coefficients * moved))


def test_only_contacts_of_two_fine_bodies_are_damaged(mixed):
    fine = mixed.tessellation.fine
    bodies = mixed.tessellation.contacts.bodies
    np.testing.assert_array_equal(mixed.damageable, np.flatnonzero(fine[bodies[:, 0]] & fine[bodies[:, 1]]))
    assert 0 < len(mixed.damageable) < len(bodies)
    assert sorted([*mixed.damageable, *elastic_contacts(mixed)]) == list(range(len(bodies)))
    u = np.random.default_rng(3).normal(size=mixed.size) * 2e-6
    response = mixed.response(u, mixed.virgin())
    np.testing.assert_allclose(
        response.traction[elastic_contacts(mixed)], (mixed.moduli * response.strain)[elastic_contacts(mixed)]
    )
    assert np.linalg.norm(response.traction[mixed.damageable], axis=1).max() < 20 * CONCRETE.f_t
    assert response.history[:, 0].max() > 0.5


def test_pairs_name_the_nuclei_of_damaged_contacts(mixed):
    pairs, t = mixed.pairs(), mixed.tessellation
    np.testing.assert_array_equal(pairs, t.nucleus[t.contacts.bodies[t.contacts.fine]])


def test_scale_acts_on_elastic_contacts_alone(mixed):
    other = mixed.scaled(1.3)
    u = np.random.default_rng(4).normal(size=mixed.size) * 1e-8
    a, b = mixed.response(u, mixed.virgin()), other.response(u, mixed.virgin())
    np.testing.assert_allclose(
        b.traction[elastic_contacts(mixed)], 1.3 * a.traction[elastic_contacts(mixed)], rtol=1e-12
    )
    np.testing.assert_array_equal(b.traction[mixed.damageable], a.traction[mixed.damageable])
    np.testing.assert_allclose(
        other.elastic_utilisation(b), 1.3 * mixed.elastic_utilisation(a), rtol=1e-12, atol=1e-300
    )
    assert mixed.elastic_scale == 1.0
    matrix = other.pattern.matrix(secant_entries(other, other.virgin()))
    free = np.setdiff1d(np.arange(mixed.size), mixed.supports.dofs)
    np.testing.assert_allclose((matrix @ u)[free], b.forces[free], atol=1e-11 * np.abs(b.forces[free]).max())


def test_elastic_share_is_the_derivative_of_compliance(mixed):
    """``d compliance / d (1/scale) = share scale``, against differences."""
    mixed.symmetric.factor(secant_entries(mixed, mixed.virgin()))
    solutions = mixed.symmetric.solve(np.stack([mixed.load, mixed.control], axis=1))
    slope = elastic_share(mixed, solutions) * mixed.elastic_scale
    h = 1e-4
    difference = (gauge_compliance(mixed.scaled(1 / (1 + h))) - gauge_compliance(mixed.scaled(1 / (1 - h)))) / (2 * h)
    assert slope == pytest.approx(difference, rel=1e-5)


def test_elastic_utilisation_is_one_at_strength(mixed):
    """A contact stretched along its normal to ``f_t / E``."""
    c = elastic_contacts(mixed)[5]
    contacts = mixed.tessellation.contacts
    u = np.zeros((len(mixed.tessellation), 6))
    u[contacts.bodies[c, 1], :3] = YIELD * contacts.length[c] * contacts.normal[c]
    value = mixed.elastic_utilisation(mixed.response(u.ravel(), mixed.virgin()))
    assert value[c] == pytest.approx(1.0, rel=1e-12)
    assert not value[mixed.damageable].any()


def test_energies(mixed):
    u = np.random.default_rng(5).normal(size=mixed.size) * 1e-9
    response = mixed.response(u, mixed.virgin())
    strain = contact_strains(mixed.geometry, u.reshape(-1, 6))
    energy = 0.5 * np.einsum("c,ca,ca->", mixed.geometry.volume, strain**2, mixed.moduli)
    springs = 0.5 * response.u @ mixed.internal(np.zeros_like(response.traction), response.u)
    assert springs > 0.0
    assert response.stored == pytest.approx(energy + springs, rel=1e-12)
    rest = mixed.response(0 * u, mixed.virgin())
    assert not dissipation(mixed, rest, response)[0].any()
    # There and back again along a proportional path: only what was broken is lost.
    far = mixed.response(2e3 * u, mixed.virgin())
    assert dissipation(mixed, rest, far)[0].sum() == 0.0  # from the origin a single step knows no loss
    further = mixed.response(3e3 * u, far.history)
    # Displacements at random are mostly taken by the supports.
    of_contacts = 0.5 * np.einsum("c,ca,ca->", mixed.geometry.volume, far.traction, far.strain)
    assert dissipation(mixed, far, further)[0].min() >= -1e-12 * of_contacts
    assert dissipation(mixed, far, further)[0].sum() > 0.01 * of_contacts
    back = mixed.response(1e3 * u, far.history)
    np.testing.assert_allclose(dissipation(mixed, far, back)[0], 0.0, atol=1e-12 * of_contacts)


def test_stiffness_does_not_change_with_the_size_of_bodies():
    """Geometry times xi: forces of the same strains go with xi squared, displacements with xi (theory section 2)."""
    case, xi = beam(), 3.0
    data = case.model_dump()
    big = beam(
        specimen={"size": [xi * s for s in data["specimen"]["size"]]},
        notch={"position": xi * 0.05, "depth": xi * 0.012},
        supports=[
            {"type": "pin", "face": "bottom", "at": xi * 0.01},
            {"type": "roller", "face": "bottom", "at": xi * 0.09},
        ],
        load={"at": xi * 0.05},
        gauge={"a": {"face": "bottom", "at": xi * 0.046}, "b": {"face": "bottom", "at": xi * 0.054}},
        discretization={"l_f": xi * 0.01, "l_c": xi * 0.02},
        control={"target": xi * 1e-4},
    )
    small, large = beam_system(case), beam_system(big)
    np.testing.assert_allclose(large.tessellation.x, xi * small.tessellation.x, rtol=1e-9)
    a = settle(small, small.virgin(), 1e-6)
    b = settle(large, large.virgin(), xi * 1e-6)
    assert b.load == pytest.approx(xi**2 * a.load, rel=1e-7)
    size = np.abs(a.response.strain).max()
    np.testing.assert_allclose(np.sort(b.response.strain[:, 0]), np.sort(a.response.strain[:, 0]), atol=1e-6 * size)


def test_elastic_forces_are_those_of_the_secant_matrix_without_damage(mixed):
    u = np.random.default_rng(3).normal(size=mixed.size)
    scaled = mixed.scaled(1.3)
    expected = scaled.pattern.product(secant_entries(scaled, scaled.virgin()), u)
    np.testing.assert_allclose(
        scaled.internal(scaled.strain(u) * scaled.moduli, u), expected, rtol=0.0, atol=1e-12 * np.abs(expected).max()
    )


def test_contacts_that_differ_from_a_secant_stiffness(mixed):
    rng = np.random.default_rng(4)
    intact = rng.uniform(0.1, 1.0, (len(mixed.damageable), 3))
    tangent = np.zeros((len(mixed.damageable), 3, 3))
    tangent[:, range(3), range(3)] = intact * mixed.moduli[mixed.damageable]
    of = (mixed.moduli, mixed.damageable, limits.SAME_STIFFNESS * mixed.stiffest)
    differ = np.array([0, 3, len(tangent) - 1])
    by = 1e-9 * CONCRETE.E * rng.normal(size=(3, 3, 3))
    tangent[differ] += by
    contacts, change = changes(tangent, intact, *of)
    np.testing.assert_array_equal(contacts, mixed.damageable[differ])
    np.testing.assert_allclose(change, by, atol=1e-14 * CONCRETE.E)
    assert len(changes(tangent, intact + 1e-9, *of)[0]) == len(tangent)
