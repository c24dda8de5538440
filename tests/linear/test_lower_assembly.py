import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest

from equilibrium.models import beam, beam_system, half_fine, secant_entries
from equilibrium.test_low_rank import BAR
from fissura.linear import SingularMatrixError, symmetric
from fissura.linear.assembly import assemble_secant, pattern
from fissura.linear.blocks import held_bodies, lower_blocks
from fissura.linear.clusters import link_stiffness
from fissura.linear.dissection import dissected_order
from fissura.linear.lower_assembly import assemble_lower
from fissura.linear.symmetric import SymmetricSolver
from fissura.linear.two_level import TwoLevel
from fissura.machine.kernel_threads import KernelThreads


@pytest.fixture(scope="module", params=["full", "mixed", "clamped"])
def system(request):
    match request.param:
        case "full":
            return beam_system()
        case "mixed":
            return beam_system(region=half_fine())
        case _:
            return beam_system(beam(**{**BAR, "supports": [{"type": "clamp", "face": "left"}]}))


def damaged(system, seed=0):
    history = system.virgin().copy()
    history[:, 0] = np.random.default_rng(seed).uniform(size=len(history)) ** 4
    return history


def lower_of(system, domains):
    form = system.pattern
    return lower_blocks(form, *dissected_order(form, held_bodies(form, low_rank=False), domains))


@pytest.mark.parametrize("domains", [1, 2])
def test_as_gathered_from_the_whole_matrix(system, domains):
    lower = lower_of(system, domains)
    moduli = system.secant_moduli(damaged(system))
    moduli[::3] = 0.0
    expected = lower.gather(assemble_secant(system.geometry, system.pattern, moduli))
    storage = np.full_like(expected, np.nan)
    found = assemble_lower(system.geometry, system.pattern, lower, moduli, storage, KernelThreads(2))
    assert found is storage
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-15 * np.abs(expected).max())
    np.testing.assert_array_equal(found, assemble_lower(system.geometry, system.pattern, lower, moduli))
    below = np.flatnonzero(lower.rows != lower.indices)
    np.testing.assert_allclose(link_stiffness(lower, found), np.linalg.norm(found[below, :3, :3], axis=(1, 2)))


def test_a_contact_of_a_body_with_itself(system):
    """As in periodic cells that are one body wide."""
    bodies = system.geometry.bodies.copy()
    bodies[5] = bodies[5, 0]
    owner = bodies.ravel()
    adjacent = np.argsort(owner, kind="stable")
    first = np.searchsorted(owner[adjacent], np.arange(len(system.tessellation) + 1))
    geometry = replace(system.geometry, bodies=bodies, adjacent=adjacent, first=first)
    form = pattern(geometry, system.supports.constant)
    lower = lower_blocks(form, np.arange(len(system.tessellation)))
    expected = lower.gather(assemble_secant(geometry, form, system.moduli))
    found = assemble_lower(geometry, form, lower, system.moduli)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-13 * np.abs(expected).max())


def test_moduli_that_are_not_finite(system):
    solver = TwoLevel(system.pattern, system.tessellation.x)
    moduli = system.moduli.copy()
    moduli[3, 1] = np.nan
    with pytest.raises(SingularMatrixError, match="not finite"):
        solver.factor_contacts(system.geometry, moduli)
    solver.factor_contacts(system.geometry, system.moduli)
    new = TwoLevel(system.pattern, system.tessellation.x)
    new.factor_contacts(system.geometry, system.moduli)
    np.testing.assert_array_equal(solver.apply(system.load), new.apply(system.load))
    assert np.isfinite(solver.apply(system.load)).all()


@pytest.mark.parametrize("name", ["direct", "two-level", "amg"])
def test_solvers_of_contacts_and_of_entries_agree(system, name):
    solver = SymmetricSolver(system.pattern, system.tessellation.x, name)
    history = 0.9 * damaged(system)
    solver.factor(secant_entries(system, history))
    expected = solver.solve(system.load)
    solver.factor_contacts(system.geometry, system.secant_moduli(history))
    assert solver.matrices == 2
    np.testing.assert_allclose(solver.solve(system.load), expected, atol=1e-7 * np.abs(expected).max())
    found, image = solver.apply_with_product(system.load)
    np.testing.assert_allclose(
        image, system.pattern.product(secant_entries(system, history), found), atol=1e-7 * np.abs(system.load).max()
    )


def test_direct_solver_takes_over_from_contacts(system, monkeypatch):
    def fail(*arguments, **options):
        raise SingularMatrixError("does not converge")

    monkeypatch.setattr(symmetric.TwoLevel, "solve", fail)
    solver = SymmetricSolver(system.pattern, system.tessellation.x, "two-level")
    solver.factor_contacts(system.geometry, system.moduli)
    direct = SymmetricSolver(system.pattern, system.tessellation.x, "direct")
    direct.factor(secant_entries(system, system.virgin()))
    expected = direct.solve(system.load)
    np.testing.assert_allclose(solver.solve(system.load), expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("name", ["direct", "two-level"])
def test_nothing_is_kept_when_equations_are_dropped(name):
    """Memory is free at once, without the collector, for what comes next."""
    system = beam_system(linear=name)
    system.prepared.solve(system.virgin())
    kept = [weakref.ref(each) for each in (system, system.symmetric, system.geometry, system.tessellation)]
    gc.disable()
    try:
        del system
        assert [each() for each in kept] == [None] * len(kept)
    finally:
        gc.enable()
