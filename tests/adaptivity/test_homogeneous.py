"""A homogeneous coarse part: exact in uniform strain, and the same as it is where everything is fine."""

from dataclasses import replace

import numpy as np
import pytest

from fissura.adaptivity import gauge_compliance, limits, region_from_case
from fissura.adaptivity.homogeneous import homogeneous, homogeneous_compliance, is_tabulated
from fissura.case.macroscopic import macroscopic_elasticity
from fissura.contact import law_from_case
from fissura.equilibrium import System
from fissura.material import material_from_case
from fissura.specimen import conditions_from_case, domain_from_case
from fissura.tessellation import discretize, nuclei_from_case


def system(case, linear="auto", **region):
    """Equations of a case where nothing is fine but what is asked for."""
    domain = domain_from_case(case)
    nuclei = nuclei_from_case(case, domain)
    found = replace(region_from_case(case, domain, full=False), **region)
    return System(
        discretize(nuclei, domain, found.spacing(nuclei.x)),
        material_from_case(case),
        law_from_case(case),
        conditions_from_case(case, domain),
        linear,
    )


@pytest.fixture(scope="module")
def coarse(small_case):
    """A beam without a notch and without anything fine, with bodies of graded size."""
    case = small_case(notch=[], specimen={"size": [0.2, 0.08, 0.08]})
    return system(case, balls=np.array([[0.0, 0.0, 0.0]]), radii=np.array([-1e-6]), l_c=0.016, ramp=0.2)


@pytest.fixture
def without_layer(monkeypatch):
    """The surface is as stiff as the bulk."""
    monkeypatch.setattr(limits, "LAYER", tuple(0.0 for _ in limits.LAYER))


def displaced(equations, gradient):
    """Internal forces under a displacement with that gradient, (n, 6), and bodies without another load.

    Spin stiffness and supports are left out: the first does no work in uniform strain, the second holds bodies.
    """
    own = equations.system
    u = np.zeros((len(own.tessellation), 6))
    u[:, :3] = own.tessellation.x @ gradient.T
    flat = u.ravel()
    inner = own.internal(own.strain(flat) * equations.moduli, flat) - own.supports.constant @ flat
    out = np.zeros_like(u)
    own.pattern.low_rank.add_product(u, out)
    return (inner - out.ravel() + equations.volumetric(flat)).reshape(-1, 6)


def test_uniaxial_stress_with_free_faces(coarse, without_layer):
    """Bodies at free sides are in balance: their forces are zero to round-off, whatever their size and shape."""
    equations = homogeneous(coarse, 0.008)
    _, nu = macroscopic_elasticity().macroscopic(60e9, 0.29)
    strain = 1e-4
    forces = displaced(equations, strain * np.diag([1.0, -nu, -nu]))
    surface, bodies = coarse.tessellation.surface, coarse.tessellation.contacts.bodies
    ends = np.unique(surface.body[np.abs(surface.normal[:, 0]) > 0.5])
    # End faces are not free, so that bodies there, and those that touch them, are in no balance.
    near = np.unique(bodies[np.isin(bodies, ends).any(axis=1)])
    free = np.setdiff1d(np.arange(len(coarse.tessellation)), near)
    assert len(np.intersect1d(free, surface.body)) > 50
    size = 60e9 * strain * 0.02**2
    np.testing.assert_allclose(forces[free, :3], 0.0, atol=1e-10 * size)
    np.testing.assert_allclose(forces[free, 3:], 0.0, atol=1e-10 * size * 0.02)


def test_a_cut_carries_the_modulus_of_the_bulk(coarse, without_layer):
    equations = homogeneous(coarse, 0.008)
    modulus, nu = macroscopic_elasticity().macroscopic(60e9, 0.29)
    forces = displaced(equations, 1e-4 * np.diag([1.0, -nu, -nu]))
    assert forces[coarse.tessellation.x[:, 0] < 0.1, 0].sum() == pytest.approx(-modulus * 1e-4 * 0.08 * 0.08, rel=1e-9)


def test_any_uniform_strain_inside(coarse, without_layer):
    equations = homogeneous(coarse, 0.008)
    gradient = 1e-4 * np.array([[0.3, 0.2, -0.5], [0.2, -0.4, 0.1], [-0.5, 0.1, 0.7]])
    forces = displaced(equations, gradient)
    bodies = coarse.tessellation.contacts.bodies
    near = np.unique(bodies[np.isin(bodies, coarse.tessellation.surface.body).any(axis=1)])
    inside = np.setdiff1d(np.arange(len(coarse.tessellation)), near)
    assert len(inside)
    np.testing.assert_allclose(forces[inside, :3], 0.0, atol=1e-10 * 60e9 * 1e-4 * 0.02**2)


def test_a_rotation_costs_nothing(coarse):
    equations = homogeneous(coarse, 0.008)
    turn = np.array([0.1, -0.2, 0.3])
    u = np.zeros((len(coarse.tessellation), 6))
    u[:, :3], u[:, 3:] = np.cross(turn, coarse.tessellation.x), turn
    np.testing.assert_allclose(equations.rows @ u.ravel(), 0.0, atol=1e-14)


def test_the_layer_makes_the_surface_stiffer_or_softer(coarse, monkeypatch):
    found = []
    for layer in (-0.1, 0.0, 0.1):
        monkeypatch.setattr(limits, "LAYER", tuple(layer for _ in limits.LAYER))
        found.append(homogeneous_compliance(homogeneous(coarse, 0.008)))
    assert found[0] > found[1] > found[2]


def test_nothing_to_make_homogeneous(small_case):
    full = system(small_case(), everywhere=True)
    equations = homogeneous(full, 0.008)
    assert equations.rows.shape[0] == 0
    np.testing.assert_array_equal(equations.moduli, full.moduli)
    assert homogeneous_compliance(equations) == pytest.approx(gauge_compliance(full), rel=2e-4)


def test_with_an_iterative_solver(small_case):
    """From 500 bodies on the preconditioner is not exact for the contacts alone."""
    mixed = system(small_case(discretization={"l_f": 0.005, "l_c": 0.008}), r_f=0.015)
    assert len(mixed.tessellation) > 500
    equations = homogeneous(mixed, 0.005)
    found = homogeneous_compliance(equations)
    direct = system(small_case(discretization={"l_f": 0.005, "l_c": 0.008}), linear="direct", r_f=0.015)
    assert found == pytest.approx(homogeneous_compliance(homogeneous(direct, 0.005)), rel=1e-4)


def test_which_materials_are_tabulated(small_case):
    def of(alpha):
        return system(small_case(material={"E": 60e9, "alpha": alpha, "f_t": 2.2e6, "G_t": 2000.0}))

    assert is_tabulated(of(0.29))
    assert is_tabulated(of(1.0))
    assert not is_tabulated(of(0.005))
