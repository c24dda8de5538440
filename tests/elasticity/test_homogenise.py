"""Periodic cells: what is exact, what theory gives, and what must not change anything."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from equilibrium.models import random_rotation
from fissura.case.macroscopic import voigt
from fissura.elasticity.homogenise import Homogenisation
from fissura.elasticity.stiffness import PAIRS, Isotropic, anisotropy, isotropic_part, unit_strains
from fissura.tessellation.periodic import PeriodicCell


@pytest.fixture(scope="module")
def cell():
    return PeriodicCell.placed(6.0, 1.0, np.random.default_rng(2))


@pytest.fixture(scope="module")
def structure(cell):
    return Homogenisation(cell)


def test_alpha_one_is_exact(structure):
    stiffness = structure.stiffness(1.0, 60e9)
    np.testing.assert_allclose(stiffness, Isotropic(20e9, 30e9).matrix(), atol=1e-12 * 60e9)
    found = isotropic_part(stiffness)
    assert pytest.approx(60e9, rel=1e-13) == found.E
    assert found.nu == pytest.approx(0.0, abs=1e-13)
    assert anisotropy(stiffness) < 1e-13


@given(alpha=st.floats(1e-3, 1.0))
def test_volumetric_strain_is_exact_for_every_alpha(structure, alpha):
    stiffness = structure.stiffness(alpha)
    found = isotropic_part(stiffness)
    assert pytest.approx(1.0 - 2.0 * found.nu, rel=1e-12) == found.E
    # Uniform volumetric strain has uniform stress, and no shear.
    np.testing.assert_allclose(stiffness[:, :3].sum(axis=1), [1, 1, 1, 0, 0, 0], atol=1e-12)


@pytest.mark.parametrize("alpha", [0.05, 0.3, 0.8])
def test_stiffness_is_symmetric_positive_and_below_voigt(structure, alpha):
    stiffness, bound = structure.stiffness(alpha), structure.voigt(alpha)
    np.testing.assert_allclose(stiffness, stiffness.T, atol=1e-13)
    assert np.linalg.eigvalsh(stiffness).min() > 0.0
    assert np.linalg.eigvalsh(bound - stiffness).min() > -1e-13
    assert isotropic_part(bound).shear > 1.001 * isotropic_part(stiffness).shear


def test_voigt_estimate_is_the_cell_without_fluctuations():
    """The average over directions is exact for the isotropic part: it only needs ``sum A L n n``."""
    structure = Homogenisation(PeriodicCell.placed(5.0, 1.0, np.random.default_rng(1)))
    for alpha in (0.01, 0.29, 0.9):
        found = isotropic_part(structure.voigt(alpha))
        assert (found.E, found.nu) == pytest.approx(voigt(alpha), rel=1e-13)


def test_average_stress_balances_energy(structure):
    """Average of tractions over contacts against the definition by positions, for a random strain."""
    alpha, cell, geometry = 0.2, structure.cell, structure.geometry
    strains = structure._solve(alpha, structure.affine)
    traction = np.array([1.0, alpha, alpha]) * strains
    force = cell.contacts.area[:, None] * np.einsum("kca,cai->kci", traction, geometry.frame)
    reach = cell.x[cell.contacts.bodies[:, 1]] + cell.shift - cell.x[cell.contacts.bodies[:, 0]]
    stress = np.einsum("kci,cj->kij", force, reach) / cell.side**3
    # Balance of moments makes it symmetric without further ado.
    np.testing.assert_allclose(stress, stress.transpose(0, 2, 1), atol=1e-13)
    columns = np.stack([[s[a, b] for a, b in PAIRS] for s in stress], axis=1)
    np.testing.assert_allclose(columns, structure.stiffness(alpha), atol=1e-13)


def _tensor(stiffness):
    out = np.zeros((3, 3, 3, 3))
    for k, (a, b) in enumerate(PAIRS):
        for m, (c, d) in enumerate(PAIRS):
            for i, j in {(a, b), (b, a)}:
                for p, q in {(c, d), (d, c)}:
                    out[i, j, p, q] = stiffness[k, m]
    return out


def test_turning_and_renumbering(cell, structure):
    """Everything turned, bodies and contacts renumbered: the same tensor, turned; the same isotropic part."""
    rng = np.random.default_rng(4)
    turn, contacts = random_rotation(rng), cell.contacts
    order, sequence = rng.permutation(len(cell)), rng.permutation(len(contacts))
    place = np.argsort(order)
    turned = dataclasses.replace(
        cell,
        x=cell.x[order] @ turn.T,
        contacts=dataclasses.replace(
            contacts,
            bodies=place[contacts.bodies[sequence]],
            area=contacts.area[sequence],
            length=contacts.length[sequence],
            centroid=contacts.centroid[sequence] @ turn.T,
            normal=contacts.normal[sequence] @ turn.T,
        ),
        shift=cell.shift[sequence] @ turn.T,
    )
    a, b = structure.stiffness(0.15), Homogenisation(turned).stiffness(0.15)
    expected = np.einsum("ai,bj,ck,dl,ijkl->abcd", turn, turn, turn, turn, _tensor(a))
    np.testing.assert_allclose(_tensor(b), expected, atol=1e-12)
    assert pytest.approx(isotropic_part(a).E, rel=1e-12) == isotropic_part(b).E
    assert anisotropy(b) == pytest.approx(anisotropy(a), rel=1e-9)
    assert np.abs(a - b).max() > 1e-4  # it is not isotropic by itself


def test_size_of_bodies_does_not_matter(structure):
    large = Homogenisation(PeriodicCell.placed(6e3, 1e3, np.random.default_rng(2)))
    np.testing.assert_allclose(large.stiffness(0.29, 2.0), 2.0 * structure.stiffness(0.29), atol=1e-12)


def test_bulk_law_against_fresh_structures():
    """Table of the package, made of other structures, within the scatter of a few cells."""
    from fissura.case.macroscopic import macroscopic_elasticity

    cells = [Homogenisation(PeriodicCell.placed(8.0, 1.0, np.random.default_rng(seed))) for seed in range(90, 96)]
    for alpha in (0.02, 0.1, 0.29, 0.62):
        found = np.array([isotropic_part(each.stiffness(alpha)).E for each in cells])
        error = found.std(ddof=1) / np.sqrt(len(found))
        assert abs(found.mean() - macroscopic_elasticity().macroscopic(1.0, alpha)[0]) < 5.0 * error


def test_isotropic_part():
    rng = np.random.default_rng(0)
    known = Isotropic(2.0, 0.7)
    assert isotropic_part(known.matrix()) == Isotropic(pytest.approx(2.0), pytest.approx(0.7))
    assert pytest.approx(3.0 * known.bulk * (1.0 - 2.0 * known.nu)) == known.E
    a = rng.normal(size=(6, 6))
    a = a + a.T
    # It is the nearest one: any other is farther.
    scale = np.outer(*[np.repeat([1.0, np.sqrt(2.0)], 3)] * 2)
    best = isotropic_part(a)
    least = np.linalg.norm(scale * (a - best.matrix()))
    for bulk, shear in rng.normal(size=(50, 2)) * 0.1:
        assert np.linalg.norm(scale * (a - Isotropic(best.bulk + bulk, best.shear + shear).matrix())) > least
    assert unit_strains().sum() == 3.0 + 3.0
