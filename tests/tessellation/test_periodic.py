"""Periodic cells: saturated across their faces, every contact once, exact volumes and closed bodies."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from fissura.tessellation.periodic import PeriodicCell, periodic_cell
from fissura.tessellation.periodic_placement import place_periodic

SIDES = (4.0, 4.7, 7.3)


@pytest.fixture(scope="module", params=SIDES)
def cell(request):
    return PeriodicCell.placed(request.param, 1.0, np.random.default_rng(3))


@pytest.mark.parametrize("side", SIDES)
def test_nuclei_keep_their_distance_and_leave_no_gap(side):
    x = place_periodic(side, 1.0, np.random.default_rng(5))
    assert ((x >= 0.0) & (x < side)).all()
    tree = cKDTree(x, boxsize=side)
    distance, _ = tree.query(x, k=2)
    assert distance[:, 1].min() >= 1.0
    points = np.random.default_rng(6).random((20_000, 3)) * side
    assert tree.query(points)[0].max() < 1.0


def test_density_is_that_of_saturation():
    """Fraction 0.384 of balls with half the distance as radius (Torquato, Uche & Stillinger 2006)."""
    counts = [len(place_periodic(8.0, 1.0, np.random.default_rng(seed))) for seed in range(20)]
    assert np.mean(counts) / 8.0**3 * np.pi / 6.0 == pytest.approx(0.3841, rel=0.01)


def test_placement_repeats_itself():
    a, b = (place_periodic(5.0, 1.0, np.random.default_rng(1)) for _ in range(2))
    assert np.array_equal(a, b)
    c = place_periodic(0.05, 0.01, np.random.default_rng(1))
    assert len(c) == len(a)


def test_small_cubes_are_refused():
    with pytest.raises(ValueError, match="at least 4 spacings"):
        place_periodic(3.9, 1.0, np.random.default_rng(1))


def test_volumes_sum_to_the_cell(cell):
    assert cell.volume.min() > 0.0
    assert cell.volume.sum() == pytest.approx(cell.side**3, rel=1e-14)


def test_bodies_are_closed(cell):
    """The area vectors of the facets of each body sum to zero."""
    contacts = cell.contacts
    vectors = contacts.area[:, None] * contacts.normal
    total = np.zeros((len(cell), 3))
    np.add.at(total, contacts.bodies[:, 0], vectors)
    np.add.at(total, contacts.bodies[:, 1], -vectors)
    surface = np.bincount(contacts.bodies.ravel(), np.repeat(contacts.area, 2))
    assert (np.abs(total) < 1e-14 * surface[:, None]).all()


def test_lengths_reach_to_images(cell):
    contacts = cell.contacts
    i, j = contacts.bodies.T
    reach = cell.x[j] + cell.shift - cell.x[i]
    np.testing.assert_allclose(contacts.length[:, None] * contacts.normal, reach, atol=1e-13)
    steps = cell.shift / cell.side
    assert np.array_equal(steps, np.round(steps))
    # The centroid is as far from both nuclei.
    a = np.linalg.norm(contacts.centroid - cell.x[i], axis=1)
    b = np.linalg.norm(contacts.centroid - cell.x[j] - cell.shift, axis=1)
    np.testing.assert_allclose(a, b, rtol=1e-12)
    # Sum of A L n n: the identity of any cells that fill space.
    tensor = np.einsum("c,ca,cb->ab", contacts.area * contacts.length, contacts.normal, contacts.normal)
    np.testing.assert_allclose(tensor, cell.side**3 * np.eye(3), atol=1e-12 * cell.side**3)


def test_every_contact_is_there_once(cell):
    """No pair of bodies twice with one shift, nor from its other side."""
    steps = np.round(cell.shift / cell.side).astype(int)
    keys = {(*pair, *step) for pair, step in zip(cell.contacts.bodies.tolist(), steps.tolist(), strict=True)}
    assert len(keys) == len(cell.contacts)
    assert not any((j, i, -a, -b, -c) in keys for i, j, a, b, c in keys)


def test_translation_does_not_change_the_structure():
    """Nuclei moved through the faces: the same volumes and areas, body by body."""
    side = 5.0
    x = place_periodic(side, 1.0, np.random.default_rng(8))
    a = periodic_cell(x, side, 1.0)
    b = periodic_cell(np.mod(x + np.array([1.7, 2.9, 4.1]), side), side, 1.0)
    np.testing.assert_allclose(b.volume, a.volume, rtol=1e-12)
    np.testing.assert_allclose(np.sort(b.contacts.area), np.sort(a.contacts.area), atol=1e-12)


def test_gaps_are_refused():
    x = place_periodic(6.0, 1.0, np.random.default_rng(8))
    with pytest.raises(ValueError, match="leave gaps"):
        periodic_cell(x[np.linalg.norm(x - 3.0, axis=1) > 2.4], 6.0, 1.0)
