"""Nuclei in blocks: a function of seed and place, whatever is asked for and in whatever order."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from scipy.spatial import cKDTree

from fissura.adaptivity import RefinedRegion
from fissura.specimen import Domain
from fissura.tessellation import Nuclei, Tessellation, discretize, needed_spacing, select
from fissura.tessellation.levels import Levels
from fissura.tessellation.limits import LEVELS, MOST_IN_BLOCK

from .build import L_C, L_F, SHAPES, box_with, discretized, farthest, region, shape

SIZE = (0.4, 0.25, 0.06)
BEAM = box_with({"position": 0.2, "depth": 0.12}, size=SIZE)

points = st.tuples(*(st.floats(0.0, side) for side in SIZE))
balls = st.lists(points, min_size=1, max_size=4)


def none(domain: Domain, seed: int = 1, l_f: float = L_F) -> Nuclei:
    return Nuclei.in_blocks(domain.complex, l_f, seed)


def known(nuclei: Nuclei) -> dict[int, bytes]:
    rows = np.column_stack([nuclei.x, nuclei.home, nuclei.priority.view(float)])
    return dict(zip(nuclei.identity.tolist(), map(bytes, rows), strict=True))


def fine_at(centers, r_f: float = 2 * L_F, ramp: float = 2 * L_C) -> RefinedRegion:
    return RefinedRegion(L_F, L_C, r_f, ramp, centers=np.asarray(centers, float).reshape(-1, 3))


def same(a: Tessellation, b: Tessellation) -> None:
    for name in ("nucleus", "x", "fine", "volume"):
        assert_array_equal(getattr(a, name), getattr(b, name))
    for name in ("bodies", "area", "centroid", "length"):
        assert_array_equal(getattr(a.contacts, name), getattr(b.contacts, name))


WHOLE = none(BEAM).complete()
EACH = known(WHOLE)


@given(balls)
def test_any_order_of_requests_gives_the_same_nuclei(centers):
    one_by_one = none(BEAM)
    for center in centers:
        one_by_one = one_by_one.known_for(fine_at(center).spacing)
    for nuclei in (one_by_one, none(BEAM).known_for(fine_at(centers).spacing)):
        assert (np.diff(nuclei.identity) > 0).all()
        assert known(nuclei).items() <= EACH.items()
    assert known(one_by_one.complete()) == EACH


@given(balls, points)
def test_what_else_is_known_does_not_matter(centers, other):
    where = fine_at(centers)
    least = none(BEAM).known_for(where.spacing)
    more = none(BEAM).known_for(fine_at(other, r_f=0.05).spacing).known_for(where.spacing)
    first = discretized(least, BEAM, where)
    for nuclei in (more, WHOLE):
        same(first, discretized(nuclei, BEAM, where))


@given(balls, st.floats(1.0, 40.0), st.floats(1e-3, 0.2))
def test_all_that_may_be_used_is_known(centers, ratio, ramp):
    """Nothing that a selection from all nuclei would use is missing."""
    where = RefinedRegion(L_F, ratio * L_F, 2 * L_F, ramp, centers=np.array(centers))
    nuclei = none(BEAM).known_for(where.spacing)
    wanted = WHOLE.identity[WHOLE.used(where.spacing(WHOLE.x))]
    assert np.isin(wanted, nuclei.identity).all()
    assert_array_equal(nuclei.identity[nuclei.used(where.spacing(nuclei.x))], wanted)


def test_the_refined_region_has_the_nuclei_of_full_resolution():
    where = region(BEAM, [(0.3, 0.1, 0.02)])
    t = discretized(none(BEAM).known_for(where.spacing), BEAM, where)
    full = discretize(WHOLE, BEAM, np.zeros(len(WHOLE)))
    inside = where.distance(WHOLE.x) <= 0.0
    assert inside.sum() > 80
    assert_array_equal(t.nucleus[t.fine], full.nucleus[inside])
    assert_array_equal(t.x[t.fine], full.x[inside])
    assert len(t) < 0.5 * len(full)


def test_spacing_asks_for_no_finer_levels():
    """Where the wanted spacing is `2^m l_f`, by round-off or exactly, nuclei of level `m` and coarser ones are all."""
    for level, ratio in ((2, 4.0), (2, 4.0 * (1 - 1e-15)), (2, 7.9), (1, 3.9), (4, 16.0), (4, 1000.0)):
        nuclei = none(BEAM).known_for(lambda x, _, ratio=ratio: np.full(len(x), ratio * L_F))
        levels = nuclei.blocks.levels.level_of(nuclei.identity)
        assert levels.min() == level
        assert needed_spacing(L_F, ratio * L_F) == 2.0**level * L_F
        kept, fine = select(nuclei, np.full(len(nuclei), 2.0**level * L_F))
        assert_array_equal(kept, np.arange(len(nuclei)))
        assert not fine.any()


@pytest.mark.parametrize("level", range(LEVELS))
def test_every_level_is_saturated(level):
    """Given the coarser ones: apart, and without holes."""
    spacing = 2.0**level * L_F
    domain = box_with({"position": 0.2, "depth": 0.12}, size=(0.6, 0.5, 0.1 + spacing))
    nuclei = none(domain).known_for(lambda x, _: np.full(len(x), spacing))
    assert cKDTree(nuclei.x).query(nuclei.x, k=2)[0][:, 1].min() >= spacing * (1 - 1e-12)
    rng = np.random.default_rng(0)
    inside = domain.bounds[0] + (domain.bounds[1] - domain.bounds[0]) * rng.random((200_000, 3))
    assert cKDTree(nuclei.x).query(inside)[0].max() <= spacing * (1 + 1e-6)


@pytest.mark.parametrize("name", SHAPES)
def test_saturated_in_any_shape(name):
    domain = shape(name)
    nuclei = none(domain).complete()
    assert cKDTree(nuclei.x).query(nuclei.x, k=2)[0][:, 1].min() >= L_F * (1 - 1e-12)
    assert_array_equal(domain.cell_of(nuclei.x), nuclei.home)
    assert farthest(nuclei, domain) <= 1.0 + 1e-6


@pytest.mark.parametrize("name", ["saw", "crossing", "cylinder", "L-panel", "ball"])
def test_a_region_of_any_shape(name):
    domain = shape(name)
    where = region(domain, [domain.complex.corner.mean(axis=1)], r_f=L_F)
    same(
        discretized(none(domain).known_for(where.spacing), domain, where),
        discretized(none(domain).complete(), domain, where),
    )


def test_seed_decides():
    first, again, other = (none(shape("saw"), seed).complete() for seed in (7, 7, 8))
    assert known(first) == known(again)
    assert not np.isin(first.x[:, 0], other.x[:, 0]).any()


def test_density_and_contacts_of_the_bulk():
    """As nuclei that are placed all at once: 0.734 in a cube of one spacing, 14.89 contacts."""
    domain = box_with(size=(0.2, 0.2, 0.2))
    count, contacts = [], []
    for seed in range(3):
        nuclei = none(domain, seed).complete()
        t = discretize(nuclei, domain, np.zeros(len(nuclei)))
        bulk = ((t.x > 4 * L_F) & (t.x < 0.2 - 4 * L_F)).all(axis=1)
        count.append(bulk.sum() * (L_F / (0.2 - 8 * L_F)) ** 3)
        contacts.append(np.bincount(t.contacts.bodies.ravel(), minlength=len(t))[bulk].mean())
    assert np.mean(count) == pytest.approx(0.734, rel=0.01)
    assert np.mean(contacts) == pytest.approx(14.89, rel=0.005)


def test_faces_of_blocks_are_no_walls():
    """Nuclei are as dense along them as elsewhere."""
    side = 24 * L_F
    layers = np.zeros(8)
    for seed in range(4):
        x = none(box_with(size=(side, side, side)), seed).complete().x / L_F
        x = x[((x > 4) & (x < 20)).all(axis=1)]
        layers += np.histogram(np.mod(x, 8), 8, (0, 8))[0]
    # Each layer has 1160 nuclei; alike at random they would scatter by 3 %, and these are more even.
    assert abs(layers / layers.mean() - 1.0).max() < 0.06


def test_numbers_of_blocks():
    """Levels of the numbers that identities are made of; all blocks once."""
    levels = Levels.of(BEAM.complex, L_F)
    assert_array_equal(levels.shape[0], [13, 8, 2])
    asked = levels.asked(lambda x, _: np.zeros(len(x)))
    assert_array_equal([len(index) for index in asked], levels.shape.prod(axis=1))
    order = levels.missing(asked, np.empty(0, np.int64))
    assert_array_equal(np.sort(order), np.arange(levels.base[-1]))
    assert_array_equal(np.unique(levels.level_of(MOST_IN_BLOCK * np.arange(levels.base[-1])), return_counts=True)[1],
                       levels.shape.prod(axis=1))  # fmt: skip
    assert (np.diff(levels.level_of(MOST_IN_BLOCK * order)) <= 0).all()
