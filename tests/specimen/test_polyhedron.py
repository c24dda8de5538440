"""Cutting a polyhedron keeps it one, whatever round-off does."""

from __future__ import annotations

from itertools import pairwise

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from fissura.specimen import polyhedron
from fissura.specimen.polyhedron import TOO_SHORT, UNCUT, following

ROOM = 256

# Only compiled functions can call these.
box = numba.njit(lambda *given: polyhedron.box(*given))
cut = numba.njit(lambda *given: polyhedron.cut(*given))
farthest = numba.njit(lambda *given: polyhedron.farthest(*given))


class Solid:
    """A box from -1 to 1, then whatever is cut from it."""

    def __init__(self, room: int = ROOM) -> None:
        self.p, self.new = np.zeros((3, room)), np.zeros((3, room))
        self.r2, self.s = np.zeros(room), np.zeros(room)
        self.twin, self.face = np.full(4 * room, -1), np.full(4 * room, -1)
        self.edges, self.gone = np.zeros(4 * room, int), np.zeros(4 * room, int)
        self.count = box(-np.ones(3), np.ones(3), self.p, self.r2, self.twin, self.face)
        self.names = 6

    def cut(self, normal, offset: float, tolerance: float = 0.0) -> int:
        structure = (self.p, self.r2, self.s, self.twin, self.face, self.count)
        work = (self.names, self.edges, self.gone, self.new)
        left = cut(*structure, *np.asarray(normal, float), offset, tolerance, *work)
        if left >= 0:
            self.count, self.names = left, self.names + 1
        return left

    def facets(self) -> dict[int, list[int]]:
        """Corners around each facet."""
        out = {}
        for edge in (4 * v + k for v in range(self.count) for k in range(3)):
            if self.face[edge] not in out:
                around = [edge]
                while (after := following(around[-1], self.twin)) != edge:
                    around.append(after)
                assert (self.face[around] == self.face[edge]).all()
                out[int(self.face[edge])] = [e >> 2 for e in around]
        return out

    def volume(self) -> float:
        total = 0.0
        for corners in self.facets().values():
            p = self.p[:, corners].T
            total += sum(float(np.linalg.det(np.array([p[0], a, b]))) for a, b in pairwise(p[1:])) / 6
        return total

    def check(self) -> None:
        edges = np.array([4 * v + k for v in range(self.count) for k in range(3)])
        assert_array_equal(self.twin[self.twin[edges]], edges)
        assert (self.twin[edges] < 4 * self.count).all()
        assert ((self.twin[edges] >> 2) != (edges >> 2)).all()
        facets = self.facets()
        assert sum(map(len, facets.values())) == 3 * self.count  # each corner once in each of its facets
        assert self.count - 3 * self.count // 2 + len(facets) == 2
        assert min(map(len, facets.values())) >= 3
        assert_allclose(self.r2[: self.count], (self.p[:, : self.count] ** 2).sum(axis=0), rtol=1e-14)
        assert farthest(self.r2, self.count) == self.r2[: self.count].max()


normals = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda n: np.linalg.norm(n) > 0.1)


def test_box():
    solid = Solid()
    solid.check()
    assert_allclose(solid.volume(), 8.0)
    for face, corners in solid.facets().items():
        assert_array_equal(solid.p[face // 2, corners], 2.0 * (face % 2) - 1.0)


@given(st.lists(st.tuples(normals, st.floats(0.0, 1.5)), max_size=30))
def test_any_cuts(planes):
    """The volume is that of the hull of all corners, and no corner lies beyond a plane."""
    from scipy.spatial import ConvexHull

    solid = Solid()
    for normal, offset in planes:
        before = solid.count
        left = solid.cut(normal, offset, 1e-13)
        assert left != 0
        if left == UNCUT:
            assert solid.count == before
            continue
        solid.check()
        assert (np.asarray(normal) @ solid.p[:, :left]).max() <= offset + 1e-12
    if np.ptp(solid.p[:, : solid.count], axis=1).min() > 1e-3:
        assert_allclose(solid.volume(), ConvexHull(solid.p[:, : solid.count].T).volume, rtol=1e-9, atol=1e-12)


def test_nothing_left():
    solid = Solid()
    assert solid.cut((1.0, 0.0, 0.0), -2.0) == 0


def test_through_corners_and_edges():
    solid = Solid()
    assert solid.cut((1.0, 1.0, 1.0), 3.0) == UNCUT
    assert solid.cut((1.0, 1.0, 0.0), 2.0) == UNCUT
    assert solid.cut((1.0, 0.0, 0.0), 1.0) == UNCUT
    assert solid.cut((1.0, 1.0, 1.0), 1.0) > 0  # through three corners
    solid.check()
    assert_allclose(solid.volume(), 8.0 - 8.0 / 6.0)
    assert solid.cut((1.0, 1.0, 0.0), 0.0) > 0  # along two edges
    solid.check()


def test_arrays_too_short():
    """Then nothing has changed."""
    solid, short = Solid(), Solid(9)
    for which in (solid, short):
        which.cut((0.0, 1.0, 0.0), 0.5)
    assert short.cut((1.0, 1.0, 1.0), 2.0) == TOO_SHORT
    short.check()
    assert_array_equal(short.p[:, :8], solid.p[:, :8])
    assert solid.cut((1.0, 1.0, 1.0), 2.0) == 10


@pytest.mark.parametrize("seed", range(20))
def test_plane_of_a_ragged_facet(seed):
    """Round-off leaves corners of one facet on either side of its plane, in many pieces."""
    rng = np.random.default_rng(seed)
    solid = Solid()
    for angle in np.arange(40) * 2 * np.pi / 40:
        solid.cut((np.cos(angle), np.sin(angle), 0.0), 0.9)
    volume = solid.volume()
    solid.p[2, : solid.count] += 1e-14 * rng.normal(size=solid.count)
    above = solid.p[2, : solid.count] > 1.0
    assert 5 < above.sum() < 35
    assert solid.cut((0.0, 0.0, 1.0), 1.0) > 0
    solid.r2[: solid.count] = (solid.p[:, : solid.count] ** 2).sum(axis=0)
    solid.check()
    assert_allclose(solid.volume(), volume, rtol=1e-12)
