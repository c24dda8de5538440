import numpy as np
import pytest

from equilibrium.models import beam, beam_system, secant_entries
from fissura.case.registry import SOLVERS
from fissura.errors import InputError
from fissura.linear import SingularMatrixError
from fissura.linear import amg as module
from fissura.linear.amg import SmoothedAggregation, rigid_motions
from fissura.linear.direct import best_solver

CLAMPED = {
    "supports": [{"type": "clamp", "face": "left"}],
    "load": {"at": None, "face": "right", "direction": [0.0, -1.0, 0.0]},
}
needs_pyamg = pytest.mark.skipif(module.pyamg is None, reason="PyAMG is not installed")


def expected_of(system, data):
    direct = best_solver()(system.pattern)
    direct.factor(data, symmetric=True)
    return direct.solve(system.load)


@needs_pyamg
@pytest.mark.parametrize("changes", [{}, CLAMPED], ids=["line supports", "clamped face"])
def test_same_solution_as_the_direct_solver(changes, monkeypatch):
    monkeypatch.setattr("fissura.equilibrium.limits.NARROW", 12)
    system = beam_system(beam(discretization={"l_f": 0.006, "l_c": 0.012}, **changes))
    assert bool(changes) == (len(system.pattern.low_rank) > 0)
    data = secant_entries(system, system.virgin())
    solver = SmoothedAggregation(system.pattern, system.tessellation.x, 1e-8)
    solver.factor(data, symmetric=True)
    expected = expected_of(system, data)
    np.testing.assert_allclose(solver.solve(system.load), expected, rtol=0.0, atol=1e-6 * np.abs(expected).max())
    assert 0 < solver.iterations <= 60
    assert not solver.solve(np.zeros(system.size)).any()
    x, y = np.random.default_rng(0).normal(size=(2, system.size))
    assert x @ solver.apply(y) == pytest.approx(y @ solver.apply(x), rel=1e-6)
    assert x @ solver.apply(x) > 0.0


@needs_pyamg
def test_what_it_refuses():
    system = beam_system()
    data = secant_entries(system, system.virgin())
    solver = SmoothedAggregation(system.pattern, system.tessellation.x, max_iterations=1)
    with pytest.raises(ValueError, match="symmetric"):
        solver.factor(data, symmetric=False)
    with pytest.raises(SingularMatrixError, match="finite"):
        solver.factor(np.full_like(data, np.inf), symmetric=True)
    solver.factor(data, symmetric=True)
    with pytest.raises(SingularMatrixError, match="converge"):
        solver.solve(system.load)


def test_without_pyamg(monkeypatch):
    monkeypatch.setattr(module, "pyamg", None)
    system = beam_system()
    with pytest.raises(InputError, match="pyamg"):
        SmoothedAggregation(system.pattern, system.tessellation.x)


def test_rigid_motions_strain_nothing():
    """Without supports, the stiffness times a motion of all bodies as one is zero."""
    system = beam_system()
    motions = rigid_motions(system.tessellation.x)
    strains = system.response(motions @ np.array([1.0, 2.0, 3.0, 40.0, 50.0, 60.0]), system.virgin()).strain
    assert np.abs(strains).max() < 1e-10


@pytest.mark.parametrize("name", sorted(SOLVERS))
def test_solvers_by_name(name):
    if name == "amg" and module.pyamg is None:
        pytest.skip("PyAMG is not installed")
    system = beam_system()
    data = secant_entries(system, system.virgin())
    solver = SOLVERS[name](system.pattern, system.tessellation.x, 1e-8)
    solver.factor(data, symmetric=True)
    expected = expected_of(system, data)
    np.testing.assert_allclose(solver.solve(system.load), expected, rtol=0.0, atol=1e-6 * np.abs(expected).max())
    once = solver.apply(system.load)
    assert 0.2 < (system.load @ once) / (system.load @ expected) < 2.0
    assert solver.factorizations == 1
