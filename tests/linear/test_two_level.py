import numpy as np
import pytest
from scipy.sparse import coo_array

from equilibrium.models import beam, beam_system, half_fine, secant_entries
from fissura.linear import SingularMatrixError
from fissura.linear import coarse_solver as module
from fissura.linear.assembly import pattern
from fissura.linear.block_cholesky import IncompleteCholesky
from fissura.linear.blocks import held_bodies, lower_blocks, multiply, term_sizes
from fissura.linear.clusters import bisected, body_weights, connected, intact
from fissura.linear.coarse import CoarseSpace
from fissura.linear.direct import best_solver
from fissura.linear.symmetric import SymmetricSolver
from fissura.linear.two_level import TwoLevel

FINE = {"discretization": {"l_f": 0.005, "l_c": 0.01}}
SLENDER = {
    "specimen": {"size": [0.4, 0.02, 0.02]},
    "notch": None,
    "supports": [
        {"type": "pin", "face": "bottom", "at": 0.02},
        {"type": "roller", "face": "bottom", "at": 0.38},
    ],
    "load": {"face": "top", "at": 0.2},
    "gauge": {"a": {"face": "bottom", "at": 0.19}, "b": {"face": "bottom", "at": 0.21}},
    "discretization": {"l_f": 0.006, "l_c": 0.012},
}
CLAMPED = {
    "notch": None,
    "supports": [{"type": "clamp", "face": "left"}, {"type": "clamp", "face": "right"}],
    "gauge": {"a": {"face": "bottom", "at": 0.04}, "b": {"face": "bottom", "at": 0.06}},
    "discretization": {"l_f": 0.006, "l_c": 0.012},
}


@pytest.fixture(scope="module")
def sound():
    return beam_system(beam(**FINE))


@pytest.fixture(scope="module")
def clamped():
    return beam_system(beam(**CLAMPED))


def middle(system):
    """Contacts with damage across the middle of the beam, and their height in shares of the depth."""
    x, b = system.tessellation.x, system.geometry.bodies[system.damageable]
    half = 0.5 * system.tessellation.x[:, 0].max()
    across = (x[b[:, 0], 0] < half) != (x[b[:, 1], 0] < half)
    return across, x[b, 1].mean(axis=1) / x[:, 1].max()


def damaged(system, damage):
    history = system.virgin().copy()
    history[:, 0] = damage
    return secant_entries(system, history)


def half_cracked(system):
    across, height = middle(system)
    return damaged(system, np.where(across & (height < 0.65), 0.99, 0.0))


def agrees(system, data, *, most, reference=True, tolerance=1e-6):
    """Solve for load and gauge and compare with the direct solver; returns the solver."""
    solver = TwoLevel(
        system.pattern,
        system.tessellation.x,
        reference=secant_entries(system, system.virgin()) if reference else None,
    )
    solver.factor(data, symmetric=True)
    direct = best_solver()(system.pattern)
    direct.factor(data, symmetric=True)
    for right in (system.load, system.control):
        found, expected = solver.solve(right), direct.solve(right)
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=tolerance * np.abs(expected).max())
        assert 0 < solver.iterations <= most
    return solver


def test_sound_beam(sound):
    solver = agrees(sound, secant_entries(sound, sound.virgin()), most=40)
    assert solver.factorizations == 1
    assert solver.shift == 0.0


def test_graded_beam():
    system = beam_system(beam(**FINE), region=half_fine(0.005, 0.02))
    assert not system.tessellation.fine.all()
    agrees(system, secant_entries(system, system.virgin()), most=40)


@pytest.mark.parametrize("reference", [True, False])
def test_a_crack_does_not_slow_it_down(sound, reference):
    solver = agrees(sound, half_cracked(sound), most=40, reference=reference)
    solver.factor(secant_entries(sound, sound.virgin()), symmetric=True)
    solver.solve(sound.control)
    undamaged = solver.iterations
    solver.factor(half_cracked(sound), symmetric=True)
    solver.solve(sound.control)
    assert solver.iterations <= 1.5 * undamaged + 2


@pytest.mark.parametrize(("damage", "tolerance"), [(0.99, 1e-6), (1 - 1e-6, 1e-5)])
def test_a_hinge_almost_without_stiffness(sound, damage, tolerance):
    across, _ = middle(sound)
    agrees(sound, damaged(sound, np.where(across, damage, 0.0)), most=80, tolerance=tolerance)


def test_a_hinge_that_hardly_anything_but_spin_stiffness_holds(sound):
    """Round-off keeps it from its tolerance; the direct solver then takes over, and both are as good."""
    across, _ = middle(sound)
    data = damaged(sound, np.where(across, 1 - 1e-9, 0.0))
    answers = []
    for linear in ("two-level", "direct"):
        solver = SymmetricSolver(sound.pattern, sound.tessellation.x, linear)
        solver.factor(data)
        answers.append(solver.solve(sound.load))
    assert np.linalg.norm(answers[0] - answers[1]) <= 1e-3 * np.linalg.norm(answers[1])


def test_separated_pieces_that_are_supported(clamped):
    across, _ = middle(clamped)
    agrees(clamped, damaged(clamped, np.where(across, 1.0, 0.0)), most=40)


def test_supports_over_whole_faces(clamped):
    agrees(clamped, secant_entries(clamped, clamped.virgin()), most=40)


def test_slender_bar():
    system = beam_system(beam(**SLENDER))
    agrees(system, secant_entries(system, system.virgin()), most=45)


def test_stiffness_over_six_orders_of_magnitude(sound):
    rng = np.random.default_rng(3)
    data = damaged(sound, 1.0 - 10.0 ** rng.uniform(-6.0, 0.0, len(sound.damageable)))
    solver = agrees(sound, data, most=200)
    assert solver.clusters > 100


def test_iterations_hardly_depend_on_size(sound):
    counts = []
    for system in (beam_system(), sound):
        solver = TwoLevel(system.pattern, system.tessellation.x)
        solver.factor(secant_entries(system, system.virgin()), symmetric=True)
        solver.solve(system.load)
        counts.append(solver.iterations)
    assert max(counts) <= 35


def test_several_right_hand_sides_and_none_at_all(sound):
    solver = TwoLevel(sound.pattern, sound.tessellation.x)
    solver.factor(secant_entries(sound, sound.virgin()), symmetric=True)
    both = solver.solve(np.stack([sound.load, sound.control], axis=1))
    total = solver.iterations
    each, single = [], 0
    for right in (sound.load, sound.control):
        each.append(solver.solve(right))
        single += solver.iterations
    np.testing.assert_array_equal(both, np.stack(each, axis=1))
    assert total == single
    assert not solver.solve(np.zeros(sound.size)).any()
    assert solver.iterations == 0


def test_it_is_deterministic(sound):
    def once():
        solver = TwoLevel(sound.pattern, sound.tessellation.x)
        solver.factor(half_cracked(sound), symmetric=True)
        return solver.solve(sound.load)

    np.testing.assert_array_equal(once(), once())


def test_no_solution_without_convergence(sound):
    solver = TwoLevel(sound.pattern, sound.tessellation.x, max_iterations=3)
    solver.factor(secant_entries(sound, sound.virgin()), symmetric=True)
    with pytest.raises(SingularMatrixError, match="do not converge"):
        solver.solve(sound.load)


def test_matrices_that_it_cannot_solve(sound):
    solver = TwoLevel(sound.pattern, sound.tessellation.x)
    data = secant_entries(sound, sound.virgin())
    with pytest.raises(ValueError, match="symmetric"):
        solver.factor(data, symmetric=False)
    with pytest.raises(SingularMatrixError):
        solver.factor(np.full_like(data, np.nan), symmetric=True)
    with pytest.raises(SingularMatrixError):
        solver.factor(-data, symmetric=True)
    loose = data.copy()
    loose[sound.pattern.fixed] -= sound.pattern.fixed_values  # neither supports nor anything else
    with pytest.raises(SingularMatrixError):
        solver.factor(0.0 * loose, symmetric=True)


def test_the_preconditioner_is_symmetric_and_positive(sound):
    solver = TwoLevel(sound.pattern, sound.tessellation.x)
    solver.factor(half_cracked(sound), symmetric=True)
    rng = np.random.default_rng(0)

    def without_rigid_part(r):
        out = np.zeros_like(r)
        solver._coarse.add_motion(solver._solver.solve(solver._coarse.restrict(r)), out)
        return r - solver._product(out)

    x, y = (without_rigid_part(rng.normal(size=(len(sound.tessellation), 6))) for _ in range(2))
    mx, my = solver._preconditioned(x), solver._preconditioned(y)
    assert np.sum(x * my) == pytest.approx(np.sum(y * mx), rel=1e-8)
    assert np.sum(x * mx) > 0
    smooth = solver._smoother.solve
    assert np.sum(x * smooth(y)) == pytest.approx(np.sum(y * smooth(x)), rel=1e-10)


def clusters_of(solver):
    """Cluster of each body."""
    return solver._coarse.label[solver._lower.place]


def test_clusters_do_not_reach_across_broken_contacts(sound):
    across, _ = middle(sound)
    solver = TwoLevel(sound.pattern, sound.tessellation.x, reference=secant_entries(sound, sound.virgin()))
    solver.factor(damaged(sound, np.where(across, 0.99, 0.0)), symmetric=True)
    b = sound.geometry.bodies[sound.damageable][across]
    assert np.all(clusters_of(solver)[b[:, 0]] != clusters_of(solver)[b[:, 1]])
    assert clusters_of(solver).max() + 1 == solver.clusters


def test_bodies_held_by_supports_have_their_own_clusters(sound):
    solver = TwoLevel(sound.pattern, sound.tessellation.x)
    solver.factor(secant_entries(sound, sound.virgin()), symmetric=True)
    held = np.zeros(len(sound.tessellation), dtype=bool)
    held[sound.supports.dofs // 6] = True
    np.testing.assert_array_equal(held_bodies(sound.pattern), held)
    assert not set(clusters_of(solver)[held]) & set(clusters_of(solver)[~held])


def test_bisection_makes_groups_of_equal_size():
    rng = np.random.default_rng(1)
    x = rng.uniform(size=(1000, 3)) ** 3  # much denser in one corner
    groups = bisected(x, 30)
    sizes = np.bincount(groups)
    assert sizes.max() <= 30
    assert sizes.min() >= 25
    extent = [np.ptp(x[groups == k], axis=0).prod() for k in range(len(sizes))]
    assert sum(extent) < 1.0  # of the unit cube: they overlap nowhere
    assert len(bisected(x[:0], 30)) == 0


def test_bisection_by_weight():
    rng = np.random.default_rng(2)
    x, weight = rng.uniform(size=(1000, 3)), rng.uniform(1.0, 8.0, size=1000)
    groups = bisected(x, 40.0, weight)
    total = np.bincount(groups, weight)
    assert total.max() <= 40.0
    assert np.median(total) >= 0.6 * 40.0  # a cut may miss its share by a point, which weighs up to 8
    assert sum(np.ptp(x[groups == k], axis=0).prod() for k in range(len(total))) < 1.0
    heavy = bisected(x, 0.5, weight)  # no point is cut
    assert sorted(heavy) == list(range(1000))


def test_weights_of_bodies(sound):
    solver = TwoLevel(sound.pattern, sound.tessellation.x)
    weight = body_weights(solver._lower, solver._x)
    larger = body_weights(solver._lower, 7.0 * solver._x)
    np.testing.assert_allclose(larger, weight, rtol=1e-12)  # only ratios of sizes count
    assert 1.0 == weight.min() < weight.max() < 3.0  # all are fine


def test_parts_of_a_cluster():
    label = np.array([5, 5, 5, 7, 7])
    row, column = np.array([0, 2, 3]), np.array([1, 3, 4])
    assert list(connected(label, row, column)) == [0, 0, 1, 2, 2]


def test_which_contacts_hold():
    row, column = np.array([0, 1, 2]), np.array([1, 2, 3])
    stiffness = np.array([1.0, 0.01, 2.0])
    assert list(intact(row, column, stiffness, np.array([1.0, 0.02, 100.0]), 0.05)) == [True, True, False]
    assert list(intact(row, column, stiffness, None, 0.05)) == [True, False, True]


def chain(n, rng):
    """Pattern and entries of a random block tridiagonal matrix, symmetric and positive definite."""
    system = beam_system()
    blocks = rng.normal(size=(n, 6, 12))
    dense = np.zeros((6 * n, 6 * n))
    for k in range(n):
        where = np.arange(6 * k, 6 * min(k + 2, n))
        b = blocks[k, :, : len(where)]
        dense[np.ix_(where, where)] += b.T @ b
    dense += 0.1 * np.eye(6 * n)
    geometry = system.geometry
    bodies = np.stack([np.arange(n - 1), np.arange(1, n)], axis=1)
    few = type(geometry)(
        bodies,
        geometry.rows[: n - 1],
        geometry.frame[: n - 1],
        geometry.volume[: n - 1],
        np.searchsorted(np.sort(bodies.ravel()), np.arange(n + 1)),
        np.argsort(bodies.ravel(), kind="stable"),
    )
    form = pattern(few, coo_array((6 * n, 6 * n)).tocsr())
    rows = np.repeat(np.arange(form.size), np.diff(form.indptr))
    return form, dense[rows, form.indices], dense


def test_incomplete_is_complete_without_fill():
    rng = np.random.default_rng(2)
    form, data, dense = chain(12, rng)
    lower = lower_blocks(form, np.arange(12))
    blocks = lower.gather(data)
    r = rng.normal(size=(12, 6))
    np.testing.assert_allclose(multiply(lower, blocks, r).ravel(), dense @ r.ravel(), rtol=1e-12, atol=1e-11)
    factor = IncompleteCholesky(lower)
    factor.factor(blocks)
    assert factor.share == 0.0
    exact = np.linalg.solve(dense, r.ravel())
    # As exact as single precision allows with this condition number.
    allowed = 2.0**-24 * np.linalg.cond(dense) * np.abs(exact).max()
    np.testing.assert_allclose(factor.solve(r).ravel(), exact, rtol=0.0, atol=allowed)


def test_factor_of_an_indefinite_matrix_is_positive():
    rng = np.random.default_rng(2)
    form, data, _ = chain(12, rng)
    lower = lower_blocks(form, np.arange(12))
    blocks = lower.gather(data)
    blocks[lower.rows != lower.indices] *= 3.0
    factor = IncompleteCholesky(lower)
    factor.factor(blocks)
    assert factor.share > 0.0
    r = rng.normal(size=(12, 6))
    assert np.sum(r * factor.solve(r)) > 0.0
    blocks[0] *= -1.0
    with pytest.raises(ValueError, match="positive definite"):
        factor.factor(blocks)


def test_product_in_another_order(sound):
    data = half_cracked(sound)
    rng = np.random.default_rng(0)
    order = rng.permutation(len(sound.tessellation))
    lower = lower_blocks(sound.pattern, order)
    u = rng.normal(size=(len(order), 6))
    expected = sound.pattern.matrix(data) @ u.ravel()
    found = multiply(lower, lower.gather(data), u[order])
    np.testing.assert_allclose(found, expected.reshape(-1, 6)[order], rtol=1e-10, atol=1e-12 * np.abs(expected).max())
    sizes = abs(sound.pattern.matrix(data)) @ np.abs(u).ravel()
    np.testing.assert_allclose(term_sizes(lower, lower.gather(data), u[order]), sizes.reshape(-1, 6)[order], rtol=1e-12)


def test_coarse_matrix_is_that_of_rigid_motions(sound):
    data = half_cracked(sound)
    n = len(sound.tessellation)
    lower = lower_blocks(sound.pattern, np.arange(n))
    coarse = CoarseSpace(lower, lower.gather(data), sound.tessellation.x, bisected(sound.tessellation.x, 40))
    motions = np.empty((6 * n, 6 * coarse.clusters))
    for k in range(motions.shape[1]):
        u = np.zeros((n, 6))
        coarse.add_motion(np.eye(1, motions.shape[1], k).reshape(-1, 6), u)
        motions[:, k] = u.ravel()
    product = sound.pattern.matrix(data) @ motions
    expected = motions.T @ product
    np.testing.assert_allclose(
        coarse.upper().toarray(), np.triu(expected), rtol=1e-9, atol=1e-10 * np.abs(expected).max()
    )
    r = np.random.default_rng(0).normal(size=(n, 6))
    np.testing.assert_allclose(coarse.restrict(r).ravel(), motions.T @ r.ravel(), rtol=1e-9, atol=1e-9)
    forces = product.T @ r.ravel()
    np.testing.assert_allclose(
        coarse.restrict_product(r).ravel(), forces, rtol=1e-9, atol=1e-11 * np.abs(product).max() * n
    )


def test_without_pardiso(sound, monkeypatch):
    monkeypatch.setattr(module, "pymklpardiso", None)
    agrees(sound, half_cracked(sound), most=40)


def test_one_cycle_for_other_iterations(sound):
    """What it leaves of a right-hand side has no part in the coarse space."""
    solver = TwoLevel(sound.pattern, sound.tessellation.x)
    data = half_cracked(sound)
    solver.factor(data, symmetric=True)
    right = np.random.default_rng(1).normal(size=sound.size)
    found = solver.apply(right)
    rest = (right - sound.pattern.matrix(data) @ found).reshape(-1, 6)[solver._lower.order]
    np.testing.assert_allclose(solver._coarse.restrict(rest), 0.0, atol=1e-6)
    np.testing.assert_array_equal(found, solver.apply(right))


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("domains", [1, 3])
def test_values_that_are_not_finite_are_refused_and_later_ones_solved(sound, value, domains):
    data = secant_entries(sound, sound.virgin())
    solver = TwoLevel(sound.pattern, sound.tessellation.x, domains=domains)
    for body in (0, len(sound.tessellation) - 1):
        worse = data.copy()
        worse[sound.pattern.start[body] + sound.pattern.diagonal[body]] = value
        with pytest.raises(SingularMatrixError, match="finite"):
            solver.factor(worse, symmetric=True)
    solver.factor(data, symmetric=True)
    assert np.isfinite(solver.solve(sound.load)).all()
