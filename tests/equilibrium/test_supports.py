"""How much supports yield: a bounded share of the structure's deformation, however many bodies they hold."""

import numpy as np
import pytest
from scipy.sparse import bmat, csc_array
from scipy.sparse.linalg import spsolve

from equilibrium.models import beam, beam_system, secant_entries
from fissura.equilibrium import settle

L_F = 0.01


def pressed(size, **changes):
    """A block clamped at its lower face and pressed on its upper one, at full resolution."""
    return beam_system(
        beam(
            **{
                "specimen": {"size": [side * L_F for side in size]},
                "notch": None,
                "supports": [{"type": "clamp", "face": "bottom"}],
                "load": {"face": "top", "at": None},
                "gauge": None,
                "discretization": {"l_f": L_F},
                "control": {"type": "displacement", "target": 1e-5},
                **changes,
            }
        )
    )


def yielding(system):
    """Share of the elastic compliance that is due to supports: their energy over that of the whole."""
    state = settle(system, system.virgin(), 1.0)
    moved = system.supports.rows @ state.response.u[system.supports.dofs]
    return float((system.supports.stiffness * moved**2).sum() / (state.load * (system.load @ state.response.u)))


def test_cubes_of_any_size():
    """It was 1e-5 times the bodies across, 4e-4 with 18 of them: springs stayed as they were, and cubes got stiffer."""
    shares = [yielding(pressed((n, n, n))) for n in (3, 5, 8, 12)]
    assert shares[0] < 1e-5
    assert shares[-1] < 3e-6
    assert shares == sorted(shares, reverse=True)


@pytest.mark.slow
def test_a_cube_of_five_thousand_bodies():
    system = pressed((18, 18, 18))
    assert len(system.tessellation) > 4500
    assert yielding(system) < 2e-6


@pytest.mark.parametrize("thickness", [1.01, 2.0])
def test_slabs_of_any_width(thickness):
    """The stiffest against their supports, body for body: the bound is theirs."""
    shares = [yielding(pressed((n, thickness, n))) for n in (4, 8, 16)]
    assert max(shares) < 4e-5
    assert max(shares) < 1.3 * min(shares)


LINES = {
    "supports": [
        {"type": "pin", "face": "bottom", "at": 0.02},
        {"type": "roller", "face": "left", "at": 0.02},
    ],
    "load": {"face": "top", "at": 0.02},
}
POINT = {
    "supports": [{"type": "clamp", "face": "bottom"}, {"type": "roller", "face": "top", "point": [0.02, 0.04, 0.02]}],
    "load": {"face": "right", "at": None, "direction": [1, 1, 0]},
}


@pytest.mark.parametrize("changes", [LINES, POINT, {}], ids=["lines", "face and point", "face"])
def test_stiffness_is_that_of_exact_supports(changes):
    """Solved again with the supports as constraints, by multipliers."""
    system = pressed((4, 4, 4), **changes)
    rows = csc_array((len(system.supports.rows), system.size))
    rows = rows.tolil()
    rows[:, system.supports.dofs] = system.supports.rows
    free = csc_array(system.pattern.matrix(secant_entries(system, system.virgin()))) - csc_array(
        system.supports.constant
    )
    equations = bmat([[free, rows.T], [rows, None]], format="csc")
    exact = spsolve(equations, np.append(system.load, np.zeros(rows.shape[0])))[: system.size]
    state = settle(system, system.virgin(), 1.0)
    stiffness = 1.0 / float(system.load @ exact)
    assert len(system.pattern.low_rank) == 0
    assert state.load < stiffness
    assert state.load == pytest.approx(stiffness, rel=1e-5)


def test_supports_are_stiff_by_the_bodies_that_they_hold():
    """One body takes the roller; the clamp, last of six functionals, is shared by more than ten."""
    system = pressed((4, 4, 4), **POINT)
    contacts = system.tessellation.contacts
    typical = 1e5 * system.law.elastic[0] * np.median(contacts.area / contacts.length)
    share = system.supports.stiffness / typical
    assert len(share) == 7
    assert 0.1 < share[6] <= 1.0  # less where the body is held beside its nucleus, and may turn
    assert (share[:6] > 8.0).all()
    assert (share[:6] < 30.0).all()
