"""Platens: rigid bodies glued to a specimen, or touching it without friction, and how they are guided."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fissura.case import case_from_dict
from fissura.equilibrium import reactions, settle
from fissura.errors import InputError
from fissura.simulation.discretization import Discretization
from fissura.simulation.loop import Simulation
from fissura.specimen import conditions_from_case, domain_from_case

E, SIDE, HEIGHT = 30e9, 0.04, 0.06


def prism(contact="glued", turning="held", alpha=1.0, seed=1, **tables):
    """A prism between two platens; pressed, unless the tables say otherwise."""
    return case_from_dict(
        {
            "specimen": {"size": [SIDE, HEIGHT, SIDE]},
            "seed": seed,
            "supports": [{"type": "clamp", "face": "bottom", "platen": contact}],
            "load": {"face": "top", "platen": {"contact": contact, "turning": turning}},
            "material": {"E": E, "alpha": alpha, "f_t": 2.2e6, "G_t": 35.0},
            "discretization": {"l_f": 0.01, "l_c": 0.02},
            "control": {"type": "displacement", "target": 1e-4},
        }
        | tables
    )


def elastic(case, full=True, value=1e-6):
    system = Discretization(case, full=full).system
    return system, settle(system, system.virgin(), value)


def on_platen(system, state, k):
    """Force and moment that contacts exert on a platen, about its middle."""
    own = system.platens.contacts[k]
    traction = np.zeros_like(state.response.traction)
    traction[own] = state.response.traction[own]
    forces = system.internal(traction, np.zeros(system.size)).reshape(-1, 6)
    return -forces[len(system.tessellation) + k]


@pytest.mark.parametrize("full", [True, False], ids=["full", "graded"])
@pytest.mark.parametrize("contact", ["glued", "frictionless"])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_patch(contact, full, seed):
    """At alpha = 1 nothing swells: uniaxial stress, the same in all bodies."""
    regions = [{"type": "ball", "center": [0.0, 0.0, 0.0], "radius": 0.03}]
    case = prism(contact, seed=seed, adaptivity={"regions": regions, "calibrate": False, "r_f": 0.02})
    system, state = elastic(case, full)
    assert len(np.unique(system.tessellation.fine)) == (1 if full else 2)
    exact = -1e-6 / HEIGHT * system.geometry.frame[:, :, 1] * system.geometry.frame[:, 0, 1][:, None]
    share = state.load / (E * SIDE**2 * 1e-6 / HEIGHT)  # supports yield a little
    assert share == pytest.approx(1.0, abs=1e-5)
    # Tractions, for contacts without friction may slip by round-off.
    moduli = E * np.where(np.arange(3) > 0, system.platens.share, 1.0)
    assert_allclose(state.response.traction, share * moduli * exact, atol=2e-8 * E * np.abs(exact).max())
    inside = system.stress(state.response, state.load)
    assert_allclose(inside[:, 1, 1], -state.load / SIDE**2, rtol=1e-6)


def test_areas_under_platens():
    """Whole faces, strips, boxes and strips on round surfaces, from the facets of bodies."""
    places = {
        "whole": ({"face": "top"}, SIDE**2),
        "strip": ({"face": "top", "at": 0.013, "width": 0.007}, 0.007 * SIDE),
        "box": ({"face": "top", "box": {"lower": [0.003, HEIGHT, 0.0], "upper": [0.02, HEIGHT, 0.011]}}, 0.017 * 0.011),
    }
    for place, area in places.values():
        system = Discretization(prism(load={**place, "platen": "glued"}), full=True).system
        own = system.platens.contacts[1]
        contacts = system.platens.tessellation.contacts
        assert contacts.area[own].sum() == pytest.approx(area, rel=1e-9)
        middle = contacts.area[own] @ contacts.centroid[own] / area
        assert_allclose(middle, system.conditions.platens[1].middle, atol=2e-4)
    disc = case_from_dict(
        {
            "specimen": {"cylinder": {"diameter": 0.06, "length": 0.03, "axis": "z"}},
            "supports": [{"type": "clamp", "on": "lateral", "toward": [0, -1, 0], "width": 0.01, "platen": "glued"}],
            "load": {"on": "lateral", "toward": [0, 1, 0], "width": 0.01, "platen": "glued"},
            "material": {"E": E, "alpha": 0.29, "f_t": 2.2e6, "G_t": 35.0},
            "discretization": {"l_f": 0.008, "l_c": 0.008},
            "control": {"type": "displacement", "target": 1e-4},
        }
    )
    system = Discretization(disc, full=True).system
    for own in system.platens.contacts:
        parts = system.platens.tessellation.contacts
        assert parts.area[own].sum() == pytest.approx(0.06 * np.arcsin(0.01 / 0.06) * 0.03, rel=0.01)


@pytest.mark.parametrize(("turning", "free"), [("free", [0, 1, 2]), ("hinged", [2]), ("held", [])])
def test_a_platen_transmits_no_moment_about_what_it_can_turn(turning, free):
    """The specimen is pressed beside its axis, at a notch: platens that can turn do, and others feel moments."""
    notch = {"face": "left", "position": 0.03, "depth": 0.015, "normal": "y"}
    system, state = elastic(prism("glued", turning, 0.29, notch=notch))
    force, moment = np.split(on_platen(system, state, 1), 2)
    n = len(system.tessellation)
    turned = state.response.u.reshape(-1, 6)[n + 1, 3:]
    assert force[1] == pytest.approx(state.load, rel=1e-6)
    arm = moment / state.load
    held = [axis for axis in range(3) if axis not in free]
    assert np.abs(arm[free]).max(initial=0.0) < 1e-7 * SIDE
    assert np.abs(turned[held]).max(initial=0.0) * SIDE < 1e-4 * 1e-6
    if 2 in held:
        assert abs(arm[2]) > 0.01 * SIDE
    else:
        assert abs(turned[2]) * SIDE > 0.05 * 1e-6
    held = reactions(system, state.response, state.load)
    assert np.linalg.norm(held.rest[:3]) < 1e-9 * state.load
    assert len(held.each) == (1 if turning == "free" else 2)


def test_platens_without_friction_let_a_specimen_swell():
    _, glued = elastic(prism("glued", alpha=0.29))
    system, slipping = elastic(prism("frictionless", alpha=0.29))
    assert glued.load > 1.005 * slipping.load
    for k in range(2):
        own = system.platens.contacts[k]
        traction = np.abs(slipping.response.traction[own])
        assert traction[:, 1:].max() < 1e-4 * traction[:, 0].max()
    # The modulus of the material as a whole, from its table, is that of a longer prism.
    assert slipping.load / (SIDE**2 * 1e-6 / HEIGHT) < E


def test_a_refined_run_between_platens():
    """Pulled to a tenth of its strength; reactions, guides included, balance the load."""
    pulled = {"face": "top", "direction": [0, 1, 0], "platen": {"contact": "glued", "turning": "hinged"}}
    case = prism(alpha=0.29, load=pulled, control={"type": "displacement", "target": 4e-5, "stop_load": 0.1})
    simulation = Simulation(case)
    steps = list(simulation.steps())
    peak = max(s.load for s in steps)
    assert 0.8 < peak / (2.2e6 * SIDE**2) < 2.0
    assert steps[-1].bodies > simulation.bodies_start
    for s in steps:
        assert len(s.snapshot.displacement) == len(s.snapshot.tessellation)
        assert len(s.snapshot.strain) == len(s.snapshot.tessellation.contacts) == len(s.spent)
        assert s.held == ("support_0", "platen_load")
        assert np.linalg.norm(s.rest[:3]) < 1e-8 * peak
        assert abs(s.work + s.exchanged - s.stored - s.dissipated) < 1e-4 * s.work


@pytest.mark.parametrize(("direction", "slides"), [([0, -1, 0], False), ([1, 0, 0], True)])
def test_a_specimen_that_slides_on_a_platen_is_warned_of(direction, slides):
    """Only the load across meets nothing."""
    load = {"face": "top", "direction": direction, "platen": "glued"}
    held = [{"type": "clamp", "face": "bottom", "platen": "frictionless"}]
    simulation = Simulation(
        prism(load=load, supports=held, control={"type": "displacement", "target": 1e-6}), full=True
    )
    list(simulation.steps())
    assert [notice.key for notice in simulation.notices if "slides" in notice.problem] == (
        ["supports[0].platen"] if slides else []
    )


@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        ({"load": {"face": "top", "at": 0.02, "platen": "glued"}}, "load.platen", "line or a point"),
        ({"load": {"face": "top", "platen": "sticky"}}, "load.platen", "is not known"),
        ({"load": {"face": "top", "platen": {"turning": "held"}}}, "load.platen.contact", "missing"),
        (
            {"load": {"face": "top", "platen": {"contact": "glued", "turning": "no"}}},
            "load.platen.turning",
            "not known",
        ),
        (
            {"supports": [{"type": "clamp", "face": "bottom", "platen": {"contact": "glued", "turning": "free"}}]},
            "supports[0].platen.turning",
            "unknown key",
        ),
    ],
)
def test_platens_that_cannot_be(change, key, words):
    with pytest.raises(InputError, match=words) as caught:
        conditions_from_case(case := prism(**change), domain_from_case(case))
    assert caught.value.key == key
