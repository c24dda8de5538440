"""Supports that hold many bodies: kept as rows, they give what they give as entries of the matrix."""

import numpy as np
import pytest
from scipy.sparse import csr_array

from equilibrium.models import beam, beam_system, secant_entries, tangent_entries
from fissura.equilibrium import limits, settle
from fissura.linear import SingularMatrixError
from fissura.linear.blocks import held_bodies
from fissura.linear.direct import SOLVERS
from fissura.linear.low_rank import LowRank
from fissura.linear.two_level import TwoLevel

BAR = {
    "specimen": {"size": [0.1, 0.05, 0.04]},
    "notch": None,
    "supports": [{"type": "clamp", "face": "left"}],
    "load": {"face": "right", "direction": [1.0, 0.2, 0.0]},
    "gauge": {"a": {"face": "bottom", "at": 0.03}, "b": {"face": "bottom", "at": 0.07}},
    "discretization": {"l_f": 0.01, "l_c": 0.02},
}
BOTH = {"supports": [{"type": "clamp", "face": "left"}, {"type": "roller", "face": "right"}]}


def systems(changes, monkeypatch):
    """The same structure with its supports as entries, and as rows."""
    case = beam(**{**BAR, **changes})
    monkeypatch.setattr(limits, "NARROW", 10**9)
    narrow = beam_system(case)
    monkeypatch.setattr(limits, "NARROW", 0)
    return narrow, beam_system(case)


@pytest.fixture(params=[{}, BOTH], ids=["clamp", "clamp and roller"])
def pair(request, monkeypatch):
    return systems(request.param, monkeypatch)


def secant(system, seed=0):
    """With random damage."""
    history = system.virgin().copy()
    history[:, 0] = np.random.default_rng(seed).uniform(size=len(history)) ** 4
    return secant_entries(system, history)


def tangent(system):
    u = np.random.default_rng(0).normal(size=system.size) * np.tile(
        np.repeat([1e-6, 1e-4], 3), len(system.tessellation)
    )
    return tangent_entries(system, system.response(u, system.virgin()), system.virgin())


def near(found, expected, tolerance=1e-9):
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=tolerance * np.abs(expected).max())


def test_rows_are_no_entries(pair):
    narrow, low_rank = pair
    assert len(narrow.pattern.low_rank) == 0
    assert len(low_rank.pattern.low_rank) == len(low_rank.conditions.supports)
    assert len(low_rank.pattern.fixed) == 0
    assert len(low_rank.pattern.indices) < len(narrow.pattern.indices)
    np.testing.assert_array_equal(held_bodies(low_rank.pattern), held_bodies(narrow.pattern))
    assert not held_bodies(low_rank.pattern, low_rank=False).any()


def test_same_matrix_and_forces(pair):
    narrow, low_rank = pair
    u = np.random.default_rng(1).normal(size=low_rank.size)
    expected = narrow.pattern.matrix(secant(narrow)) @ u
    near(narrow.pattern.product(secant(narrow), u), expected, 1e-14)
    near(low_rank.pattern.product(secant(low_rank), u), expected, 1e-12)
    u *= 1e-7
    near(low_rank.response(u, low_rank.virgin()).forces, narrow.response(u, narrow.virgin()).forces, 1e-12)


@pytest.mark.parametrize("name", sorted(SOLVERS))
@pytest.mark.parametrize("symmetric", [True, False])
def test_direct_solvers(pair, name, symmetric):
    narrow, low_rank = pair
    matrix = secant if symmetric else tangent
    right = np.stack([low_rank.load, low_rank.control], axis=1)
    direct, solver = SOLVERS[name](narrow.pattern), SOLVERS[name](low_rank.pattern)
    direct.factor(matrix(narrow), symmetric=symmetric)
    solver.factor(matrix(low_rank), symmetric=symmetric)
    expected = direct.solve(right)
    near(solver.solve(right), expected)
    near(solver.solve(right[:, 0]), expected[:, 0])
    near(solver.apply(right[:, 1]), expected[:, 1])


def test_two_level(pair):
    narrow, low_rank = pair
    direct = SOLVERS["superlu"](narrow.pattern)
    direct.factor(secant(narrow), symmetric=True)
    solver = TwoLevel(low_rank.pattern, low_rank.tessellation.x, 1e-11)
    solver.factor(secant(low_rank), symmetric=True)
    expected = direct.solve(low_rank.load)
    near(solver.solve(low_rank.load), expected)
    near(solver.product(expected), narrow.pattern.matrix(secant(narrow)) @ expected, 1e-6)
    solver.tolerance = 1e-6
    solver.solve(low_rank.load)
    assert solver.iterations <= 30


def test_equilibrium_is_the_same(pair):
    narrow, low_rank = pair
    expected = settle(narrow, narrow.virgin(), 1e-6)
    found = settle(low_rank, low_rank.virgin(), 1e-6)
    assert found.load == pytest.approx(expected.load, rel=1e-8)
    near(found.response.u, expected.response.u, 1e-7)


def test_rows_of_several_supports():
    rng = np.random.default_rng(0)
    dense = np.zeros((2, 30))
    dense[0, 6:12], dense[1, 18:24] = rng.normal(size=6), rng.normal(size=6)
    part = LowRank.of(csr_array(dense), 3.0)
    assert list(part.bodies) == [1, 3]
    u = rng.normal(size=(5, 6))
    out = np.ones((5, 6))
    part.add_product(u, out)
    np.testing.assert_allclose(out.ravel(), 1.0 + 3.0 * dense.T @ (dense @ u.ravel()), rtol=1e-13)
    np.testing.assert_allclose(part.values(u), dense @ u.ravel(), rtol=1e-13)
    sizes = np.zeros((5, 6))
    part.add_sizes(u, sizes)
    np.testing.assert_allclose(sizes.ravel(), 3.0 * abs(dense).T @ (abs(dense) @ abs(u).ravel()), rtol=1e-13)


def test_nothing_at_all():
    none, out = LowRank.none(), np.ones((4, 6))
    none.add_product(out, out)
    none.add_sizes(out, out)
    assert len(none) == 0
    assert np.all(out == 1.0)


def test_what_scipy_does_not_solve_is_a_singular_matrix(monkeypatch):
    """A structure that hangs by a thread may overflow; SciPy calls that a ValueError."""
    monkeypatch.setattr(limits, "NARROW", 0)
    system = beam_system(beam(**BAR))

    def refuse(matrix):
        raise ValueError("array must not contain infs or NaNs")

    monkeypatch.setattr("fissura.linear.woodbury.lu_factor", refuse)
    with pytest.raises(SingularMatrixError, match="infs or NaNs"):
        SOLVERS["superlu"](system.pattern).factor(secant(system), symmetric=True)
