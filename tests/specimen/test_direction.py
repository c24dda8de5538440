"""Loads that make the gauge smaller are refused; compression is followed by a gauge that counts shortening."""

from __future__ import annotations

import pytest

from fissura.case import case_from_dict
from fissura.errors import InputError
from fissura.simulation import Simulation

UP, DOWN = [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]


def cube(load=None, gauge=None, control="gauge"):
    """A cube on its bottom, loaded at its top, with a gauge over its height."""
    direction = {"load": load, "gauge": gauge}
    of = {key: {} if value is None else {"direction": value} for key, value in direction.items()}
    return case_from_dict(
        {
            "specimen": {"size": [0.03, 0.03, 0.03]},
            "supports": {"type": "clamp", "face": "bottom"},
            "load": {"face": "top", **of["load"]},
            "gauge": {"a": {"face": "bottom"}, "b": {"face": "top"}, **of["gauge"]},
            "material": {"E": 60e9, "alpha": 0.29, "f_t": 2.2e6, "G_t": 35.0},
            "discretization": {"l_f": 0.01, "l_c": 0.01},
            "control": {"target": 1e-6, "max_step": 2e-8, "type": control},
        }
    )


def stiffness(case):
    simulation = Simulation(case)
    step = next(simulation.steps())
    assert step.load == pytest.approx(simulation.initial_stiffness * step.controlled, rel=1e-3)
    return simulation.initial_stiffness


@pytest.mark.parametrize(
    ("load", "gauge", "key"),
    [
        (None, None, "gauge.direction"),
        (DOWN, UP, "gauge.direction"),
        ([1.0, -0.5, 0.0], None, "gauge.direction"),
        (UP, DOWN, "load.direction"),
    ],
)
def test_a_load_that_makes_the_gauge_smaller_is_refused(load, gauge, key):
    with pytest.raises(InputError, match="the gauge gets smaller under the load") as caught:
        next(Simulation(cube(load, gauge)).steps())
    assert caught.value.key == key
    turned = "[0, -1, 0]" if gauge is None else f"[{', '.join(f'{-x + 0.0:g}' for x in gauge)}]"
    assert f"gauge.direction = {turned}" in caught.value.allowed


def test_pressing_and_pulling_have_the_same_first_stiffness():
    """Pressed with the opposite direction of the gauge, and pulled; the load's own displacement is always fine."""
    pressed = stiffness(cube(gauge=DOWN))
    assert stiffness(cube(load=UP)) == pytest.approx(pressed, rel=1e-9)
    assert pressed == pytest.approx(0.64 * 60e9 * 0.03, rel=0.3)
    for load in (None, UP):
        assert stiffness(cube(load, control="displacement")) > 0.0


def test_dissipation_starts_with_the_gauge_and_is_refused_too():
    with pytest.raises(InputError, match=r"gauge\.direction"):
        next(Simulation(cube(control="dissipation")).steps())
