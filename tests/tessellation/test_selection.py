"""Selection of nuclei: a pure function of the nuclei and the wanted spacing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from fissura.adaptivity import RefinedRegion
from fissura.tessellation import Nuclei, select

from .build import L_C, L_F, NOTCHES, SIZE, box_with, expected_count, nuclei_in

BOX = box_with(*NOTCHES["saw"])
NUCLEI = nuclei_in(BOX, 11)

points = st.tuples(*(st.floats(0.0, side) for side in SIZE))
balls = st.lists(points, max_size=5)


def spacing_of(centers, nuclei: Nuclei = NUCLEI, r_f: float = 0.015, ramp: float = 0.05) -> np.ndarray:
    region = RefinedRegion(L_F, L_C, r_f, ramp, centers=np.asarray(centers, float).reshape(-1, 3))
    return region.spacing(nuclei.x)


def by_the_book(nuclei: Nuclei, spacing: np.ndarray) -> np.ndarray:
    """The selection as theory section 5 says it, with no concern for speed."""
    kept = spacing == 0.0
    for i in np.argsort(nuclei.priority):
        if not kept[i]:
            kept[i] = not (np.linalg.norm(nuclei.x[i] - nuclei.x[kept], axis=1) < spacing[i]).any()
    return np.flatnonzero(kept)


@given(balls)
def test_by_the_book(centers):
    spacing = spacing_of(centers)
    assert_array_equal(select(NUCLEI, spacing)[0], by_the_book(NUCLEI, spacing))


@given(balls)
def test_spacing_and_saturation(centers):
    spacing = spacing_of(centers)
    kept, fine = select(NUCLEI, spacing)
    # All of the refined region, and only that, is fine.
    assert np.isin(np.flatnonzero(spacing == 0.0), kept).all()
    assert_array_equal(fine, spacing[kept] == 0.0)
    # Apart.
    distance = np.linalg.norm(NUCLEI.x[:, None] - NUCLEI.x[kept], axis=2)
    among = distance[kept].copy()
    among[kept[:, None] == kept] = np.inf
    assert (among >= np.minimum(spacing[kept][:, None], spacing[kept])).all()
    # Saturated: whoever is left out has a neighbour too near.
    dropped = np.setdiff1d(np.arange(len(NUCLEI)), kept)
    assert (distance[dropped].min(axis=1, initial=np.inf) < spacing[dropped]).all()


@given(balls, st.randoms(use_true_random=False))
def test_order_of_refinements_does_not_matter(centers, random):
    region = RefinedRegion(L_F, L_C, 0.015, 0.05)
    at_once = region.grown(np.array(centers).reshape(-1, 3))
    shuffled = centers * 2
    random.shuffle(shuffled)
    for center in shuffled:
        region = region.grown(np.array([center]))
    one, other = select(NUCLEI, at_once.spacing(NUCLEI.x)), select(NUCLEI, region.spacing(NUCLEI.x))
    assert_array_equal(one[0], other[0])
    assert_array_equal(one[1], other[1])


@given(balls, st.integers(0, 2**32 - 1))
def test_numbering_does_not_matter(centers, seed):
    order = np.random.default_rng(seed).permutation(len(NUCLEI))
    renumbered = Nuclei(NUCLEI.x[order], NUCLEI.home[order], NUCLEI.priority[order], L_F, NUCLEI.complex)
    spacing = spacing_of(centers)
    kept, fine = select(NUCLEI, spacing)
    kept2, fine2 = select(renumbered, spacing[order])
    assert_array_equal(np.sort(order[kept2]), kept)
    assert_array_equal(np.sort(order[kept2[fine2]]), kept[fine])


def test_arguments_stay_as_they_are():
    spacing = spacing_of([(0.06, 0.03, 0.02)])
    before = spacing.copy()
    select(NUCLEI, spacing)
    assert_array_equal(spacing, before)


def test_all_fine_and_finest():
    everything = np.arange(len(NUCLEI))
    kept, fine = select(NUCLEI, np.zeros(len(NUCLEI)))
    assert_array_equal(kept, everything)
    assert fine.all()
    kept, fine = select(NUCLEI, np.full(len(NUCLEI), L_F * (1 - 1e-9)))
    assert_array_equal(kept, everything)
    assert not fine.any()


def test_one_spacing_beyond_the_specimen_keeps_the_first():
    nuclei = nuclei_in(box_with(), 1)
    kept, _ = select(nuclei, np.full(len(nuclei), 1.0))
    assert_array_equal(kept, np.flatnonzero(nuclei.priority == 0))


@pytest.mark.parametrize("ratio", [2.0, 3.0, 4.0])
def test_coarse_count(ratio):
    """A selection is nearly as dense as a placement with its spacing."""
    size = (0.15, 0.12, 0.12)
    nuclei = nuclei_in(box_with(size=size), 0)
    kept, _ = select(nuclei, np.full(len(nuclei), ratio * L_F))
    assert 0.65 < len(kept) / expected_count(size, ratio * L_F) < 1.1
