"""History of contacts by pairs of nuclei."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal

from fissura.adaptivity import transfer_history

pairs = st.sets(st.tuples(st.integers(0, 30), st.integers(0, 30)).filter(lambda p: p[0] < p[1]), max_size=40).map(
    lambda s: np.array(sorted(s), dtype=np.int64).reshape(-1, 2)
)


def moved(old_pairs, old, new_pairs):
    """History on new contacts; that of virgin ones need not be zero."""
    return transfer_history(old_pairs, old, new_pairs, np.full((len(new_pairs), old.shape[1]), 0.01))


def by_dictionary(old_pairs, old, new_pairs):
    known = {frozenset(pair): row for pair, row in zip(old_pairs.tolist(), old, strict=True)}
    virgin = np.full(old.shape[1], 0.01)
    rows = [known.get(frozenset(pair), virgin) for pair in new_pairs.tolist()]
    return np.array(rows).reshape(-1, old.shape[1])


@given(pairs, pairs, st.integers(0, 2**32 - 1))
def test_kept_by_pair_and_virgin_otherwise(old_pairs, new_pairs, seed):
    rng = np.random.default_rng(seed)
    old = rng.random((len(old_pairs), 3)) + 0.1
    assert_array_equal(moved(old_pairs, old, new_pairs), by_dictionary(old_pairs, old, new_pairs))


@given(pairs, pairs, st.integers(0, 2**32 - 1))
def test_order_of_pairs_and_within_pairs_does_not_matter(old_pairs, new_pairs, seed):
    rng = np.random.default_rng(seed)
    old = rng.random((len(old_pairs), 3))
    expected = moved(old_pairs, old, new_pairs)
    order, new_order = rng.permutation(len(old_pairs)), rng.permutation(len(new_pairs))
    turned = old_pairs[order].copy()
    swap = rng.random(len(turned)) < 0.5
    turned[swap] = turned[swap, ::-1]
    assert_array_equal(moved(turned, old[order], new_pairs[new_order, ::-1]), expected[new_order])


def test_back_and_forth():
    """Large identities, and a pair that comes back without its history."""
    old_pairs = np.array([[3, 100_000], [5, 99_999]])
    old = np.array([[0.5, 1e-4, 2e-4], [0.25, 3e-4, 4e-4]])
    kept = moved(old_pairs, old, old_pairs[:1])
    assert_array_equal(kept, old[:1])
    assert_array_equal(moved(old_pairs[:1], kept, old_pairs), [old[0], [0.01, 0.01, 0.01]])


def test_arguments_stay_as_they_are():
    old_pairs, old = np.array([[2, 1]]), np.ones((1, 3))
    moved(old_pairs, old, np.array([[1, 2]]))[:] = 7.0
    assert_array_equal(old, 1.0)
    assert_array_equal(old_pairs, [[2, 1]])
