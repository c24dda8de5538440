import numpy as np
import pytest

from equilibrium.models import CONCRETE, beam_system, half_fine, secant_entries, tangent_entries
from fissura.contact import contact_strains, nodal_forces
from fissura.linear.assembly import assemble, pattern
from fissura.linear.direct import upper_triangle

YIELD = CONCRETE.f_t / CONCRETE.E


@pytest.fixture(scope="module", params=["full", "mixed"])
def system(request):
    return beam_system(region=None if request.param == "full" else half_fine())


@pytest.fixture(scope="module")
def damaged(system):
    """Displacements that damage many contacts, and a history of earlier ones."""
    rng = np.random.default_rng(1)
    u = rng.normal(size=(len(system.tessellation), 6)) * np.repeat([1.0, 100.0], 3) * 3 * YIELD * 0.01
    earlier = system.response(0.5 * rng.normal(size=u.shape).ravel() * u.ravel(), system.virgin())
    return u.ravel(), earlier.history


def test_assembly_is_the_sum_over_contacts(system):
    """Against dense loops: ``K = sum A L B^T C B`` with random unsymmetric C."""
    geometry = system.geometry
    tangent = np.random.default_rng(0).normal(size=(len(geometry), 3, 3))
    expected = system.supports.constant.toarray()
    for c, (i, j) in enumerate(geometry.bodies):
        for a in range(3, 6):
            spin = system.pattern.spin[c] * np.array([[1.0, -1.0], [-1.0, 1.0]])
            expected[np.ix_([6 * i + a, 6 * j + a], [6 * i + a, 6 * j + a])] += spin
        dofs = np.concatenate([6 * i + np.arange(6), 6 * j + np.arange(6)])
        expected[np.ix_(dofs, dofs)] += geometry.volume[c] * geometry.rows[c].T @ tangent[c] @ geometry.rows[c]
    matrix = system.pattern.matrix(assemble(geometry, system.pattern, tangent)).toarray()
    free = np.setdiff1d(np.arange(system.size), system.supports.dofs)
    difference = np.abs(matrix - expected)
    assert difference[np.ix_(free, free)].max() < 1e-13 * np.abs(expected[np.ix_(free, free)]).max()
    assert difference.max() < 1e-14 * np.abs(expected).max()


def test_pattern_without_a_constant_part(system):
    empty = system.supports.constant * 0.0
    empty.eliminate_zeros()
    form = pattern(system.geometry, empty)
    assert len(form.fixed) == 0
    u = np.random.default_rng(0).normal(size=system.size)
    moduli = np.zeros((len(system.geometry), 3, 3))
    moduli[:, range(3), range(3)] = system.moduli
    forces = nodal_forces(system.geometry, system.moduli * contact_strains(system.geometry, u.reshape(-1, 6))).ravel()
    np.testing.assert_allclose(
        form.matrix(assemble(system.geometry, form, moduli)) @ u, forces, atol=1e-12 * np.abs(forces).max()
    )


def test_tangent_is_the_derivative_of_internal_forces(system, damaged):
    u, history = damaged
    response = system.response(u, history)
    assert (response.history[:, 0] > history[:, 0]).mean() > 0.1
    matrix = system.pattern.matrix(tangent_entries(system, response, history))
    rng = np.random.default_rng(5)
    for _ in range(3):
        way = rng.normal(size=system.size) * np.abs(u).mean()
        way[system.supports.dofs] = 0.0  # five orders stiffer than the rest, they would hide it
        h = 1e-6  # short enough for no contact to reach a corner of the law in between
        difference = (system.response(u + h * way, history).forces - system.response(u - h * way, history).forces) / (
            2 * h
        )
        size = np.abs(matrix @ way).max()
        assert np.linalg.norm(difference - matrix @ way) < 1e-7 * np.sqrt(system.size) * size


def test_secant_gives_internal_forces(system, damaged):
    u, history = damaged
    response = system.response(u, history)
    matrix = system.pattern.matrix(secant_entries(system, response.history))
    free = np.setdiff1d(np.arange(system.size), system.supports.dofs)
    forces = response.forces
    np.testing.assert_allclose((matrix @ u)[free], forces[free], atol=1e-11 * np.abs(forces[free]).max())
    np.testing.assert_allclose(matrix @ u, forces, rtol=1e-9, atol=1e-11 * np.abs(forces).max())


def test_secant_is_symmetric_and_positive(system, damaged):
    u, history = damaged
    matrix = system.pattern.matrix(secant_entries(system, system.response(u, history).history)).toarray()
    assert np.abs(matrix - matrix.T).max() < 1e-14 * np.abs(matrix).max()
    np.linalg.cholesky(matrix)  # fails unless it is positive definite


def test_elastic_tangent_is_the_secant(system):
    u = 1e-9 * np.random.default_rng(2).normal(size=system.size)
    response = system.response(u, system.virgin())
    np.testing.assert_allclose(
        tangent_entries(system, response, system.virgin()),
        secant_entries(system, system.virgin()),
        rtol=1e-12,
        atol=1e-3,
    )


def test_upper_entries_hold_the_whole_symmetric_matrix(system):
    full = system.pattern.matrix(np.arange(1.0, len(system.pattern.indices) + 1)).tocoo()
    above = np.flatnonzero(full.col >= full.row)
    upper = upper_triangle(system.pattern, full.data)
    np.testing.assert_array_equal(upper.data, full.data[above])
    np.testing.assert_array_equal(upper.indices, full.col[above])
    assert upper.nnz == len(above)
