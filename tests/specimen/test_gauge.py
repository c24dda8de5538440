"""Loads that make the gauge smaller are refused; gauges beside the notch are a warning."""

from __future__ import annotations

import pytest

from fissura.case import case_from_dict
from fissura.errors import InputError
from fissura.simulation.loop import Simulation
from fissura.specimen import conditions_from_case, domain_from_case, gauge_notices

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


# --- beside the notch ------------------------------------------------------------------------------------------------


def notices(case):
    domain = domain_from_case(case)
    return gauge_notices(domain, conditions_from_case(case, domain))


@pytest.mark.parametrize(
    ("changes", "warned"),
    [
        ({}, False),
        ({"gauge__b__at": 0.057}, True),  # a at 55 mm, the notch at 60 mm
        ({"gauge__a__at": 0.061}, True),
        ({"gauge__a__at": 0.061, "notch": []}, False),
        (
            {"gauge__a__at": 0.061, "notch": [{"position": 0.03, "depth": 0.01}, {"position": 0.09, "depth": 0.01}]},
            False,
        ),
        ({"gauge__a__at": 0.061, "control__type": "displacement"}, True),
        ({"gauge": None, "control__type": "displacement"}, False),
        ({"gauge": {"a": {"face": "left"}, "b": {"face": "right"}}}, False),
        ({"gauge": {"a": {"face": "left"}, "b": {"face": "top"}}}, False),  # the top lies on both sides
        ({"gauge": {"a": {"face": "left"}, "b": {"face": "top", "at": 0.055, "width": 0.02}}}, False),
        ({"gauge": {"a": {"face": "left"}, "b": {"face": "top", "at": 0.04, "width": 0.02}}}, True),
        ({"gauge": {"a": {"face": "left"}, "b": {"face": "bottom", "point": [0.05, 0.0, 0.02]}}}, True),
        # A deflection, from the support to beside the notch.
        ({"gauge__a__at": 0.01, "gauge__b__at": 0.055, "gauge__direction": [0, -1, 0]}, False),
    ],
)
def test_both_ends_on_one_side_of_the_only_notch(small_case, changes, warned):
    found = notices(small_case(**changes))
    assert [notice.key for notice in found] == (["gauge"] if warned else [])
    if warned:
        assert "one side of the notch at x = 60 mm" in found[0].problem


def test_a_gauge_beside_the_notch_is_told_by_check(small_case):
    found = Simulation(small_case(gauge__a__at=0.02, gauge__b__at=0.05)).notices
    assert "gauge" in [notice.key for notice in found]
