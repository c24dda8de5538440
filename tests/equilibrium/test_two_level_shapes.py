"""The two-level solver on structures that are hard for iterative ones, and against other numbers of bodies."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_array

from equilibrium.models import beam, beam_system, secant_entries
from fissura.adaptivity import RefinedRegion
from fissura.linear.assembly import assemble, pattern
from fissura.linear.direct import best_solver
from fissura.linear.two_level import TwoLevel


def cantilever(length, depth, l_f, **changes):
    """Clamped on the left over its whole face, bent and twisted by a force on an edge of the right one."""
    shape = {
        "specimen": {"size": [length, depth, depth]},
        "notch": None,
        "supports": [{"type": "clamp", "face": "left"}],
        "load": {"at": None, "face": "right", "point": [length, depth, 0.3 * depth], "direction": [0.0, -1.0, 0.0]},
        "gauge": {"a": {"face": "bottom", "at": 0.2 * length}, "b": {"face": "bottom", "at": 0.8 * length}},
        "discretization": {"l_f": l_f, "l_c": 4.0 * l_f},
    }
    return beam(**{**shape, **changes})


def compared(system, data, *, most, tolerance=1e-8, error=1e-6):
    """Solve for the load, and compare with the direct solver."""
    solver = TwoLevel(system.pattern, system.tessellation.x, tolerance)
    solver.factor(data, symmetric=True)
    found = solver.solve(system.load)
    direct = best_solver()(system.pattern)
    direct.factor(data, symmetric=True)
    expected = direct.solve(system.load)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=error * np.abs(expected).max())
    assert solver.iterations <= most
    return solver


@pytest.mark.parametrize(("length", "depth", "l_f", "most"), [(0.16, 0.02, 0.004, 45), (0.4, 0.01, 0.0035, 60)])
def test_slender_cantilevers(length, depth, l_f, most):
    """8:1:1 and 40:1:1; the condition number of the latter is about 1e9 times that of a cube."""
    system = beam_system(cantilever(length, depth, l_f))
    assert len(system.tessellation) > 500
    compared(system, secant_entries(system, system.virgin()), most=most)


def test_slender_and_cracked():
    system = beam_system(cantilever(0.16, 0.02, 0.005))
    x, b = system.tessellation.x, system.geometry.bodies[system.damageable]
    across = (x[b[:, 0], 0] < 0.08) != (x[b[:, 1], 0] < 0.08)
    history = system.virgin().copy()
    history[across & (x[b, 1].mean(axis=1) > 0.004), 0] = 0.999
    compared(system, secant_entries(system, history), most=60)


def test_graded_by_four():
    """Fine near the middle of the bar, four times as coarse elsewhere."""
    case = cantilever(0.16, 0.04, 0.005)
    region = RefinedRegion(0.005, 0.02, 0.02, 0.04, balls=np.array([[0.08, 0.02, 0.02]]), radii=np.array([0.02]))
    system = beam_system(case, region=region)
    assert not system.tessellation.fine.all()
    compared(system, secant_entries(system, system.virgin()), most=45)


def test_numbers_of_bodies_do_not_matter():
    """The same structure with its bodies renumbered: nearly the same iterations, and the same solution."""
    system = beam_system(cantilever(0.08, 0.04, 0.006))
    geometry, form, n = system.geometry, system.pattern, len(system.tessellation)
    solver = compared(system, secant_entries(system, system.virgin()), most=40)
    expected = solver.solve(system.load)
    number = np.random.default_rng(0).permutation(n)  # new number of each body
    bodies = number[geometry.bodies]
    adjacent = np.argsort(bodies.ravel(), kind="stable")
    first = np.searchsorted(bodies.ravel()[adjacent], np.arange(n + 1))
    other = replace(geometry, bodies=bodies, first=first, adjacent=adjacent)
    dofs = (6 * number[:, None] + np.arange(6)).ravel()
    turn = csr_array((np.ones(6 * n), (dofs, np.arange(6 * n))))
    order = np.argsort(number[form.low_rank.bodies])
    low_rank = replace(form.low_rank, bodies=number[form.low_rank.bodies][order], rows=form.low_rank.rows[:, order])
    again = pattern(other, csr_array(turn @ system.supports.constant @ turn.T), form.spin, low_rank)
    moduli = np.zeros((len(geometry), 3, 3))
    moduli[:, range(3), range(3)] = system.moduli
    x = np.empty_like(system.tessellation.x)
    x[number] = system.tessellation.x
    second = TwoLevel(again, x)
    second.factor(assemble(other, again, moduli), symmetric=True)
    found = second.solve(turn @ system.load)
    np.testing.assert_allclose(found, turn @ expected, rtol=0.0, atol=1e-6 * np.abs(expected).max())
    assert abs(second.iterations - solver.iterations) <= 5


@pytest.mark.slow
def test_iterations_with_a_whole_face_held():
    """A bar of several thousand bodies, one face clamped, the other pulled."""
    changes = {"load": {"at": None, "face": "right", "direction": [1.0, 0.0, 0.0]}}
    system = beam_system(cantilever(0.2, 0.05, 0.0045, **changes))
    assert len(system.tessellation) > 4000
    assert len(system.pattern.low_rank.bodies) > 100
    compared(system, secant_entries(system, system.virgin()), most=30)
