"""Whole systems and runs with regions that stay elastic."""

from __future__ import annotations

import numpy as np
import pytest

from equilibrium.models import CONCRETE, beam, beam_system, elastic_contacts, half_fine, secant_entries
from fissura.adaptivity import calibrated
from fissura.adaptivity.calibration import elastic_share
from fissura.contact import CusatisCedolin
from fissura.equilibrium import System
from fissura.errors import InputError
from fissura.material import Material, Regions, elastic_from_case
from fissura.simulation.loop import Simulation

MODULI = CONCRETE.E * np.array([1.0, CONCRETE.alpha, CONCRETE.alpha])


def box(low, high):
    """Part of the small beam between two values of x."""
    return {"type": "box", "lower": [low, 0, 0], "upper": [high, 0.04, 0.02]}


def inside(simulation, contacts):
    return elastic_from_case(simulation.case).contains(contacts.centroid)


#: Few fine bodies at first, so that refinement has work to do.
REFINING = {"discretization": {"l_f": 0.006, "l_c": 0.02}, "adaptivity": {"r_f": 0.012}}


# --- equations -------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def systems():
    """Half fine: with elastic regions that hold fine and coarse contacts, and without."""
    plain = beam_system(region=half_fine())
    elastic = Regions(lower=np.array([[0.0, 0.0, 0.0]]), upper=np.array([[0.05, 0.04, 0.02]]))
    return plain, with_regions(plain, elastic), elastic


def with_regions(plain, elastic):
    return System(plain.tessellation, plain.law.material, CusatisCedolin, plain.conditions, elastic=elastic)


def test_active_contacts_are_fine_and_outside(systems):
    plain, held, elastic = systems
    contacts = held.tessellation.contacts
    there = elastic.contains(contacts.centroid)
    assert (there & contacts.fine).any()
    assert (there & ~contacts.fine).any()
    np.testing.assert_array_equal(held.damageable, np.flatnonzero(contacts.fine & ~there))
    assert sorted([*held.damageable, *elastic_contacts(held)]) == list(range(len(contacts)))
    np.testing.assert_array_equal(held.coarse, elastic_contacts(plain))


def test_same_elastic_stiffness(systems):
    plain, held, _ = systems
    np.testing.assert_array_equal(secant_entries(held, held.virgin()), secant_entries(plain, plain.virgin()))
    u = np.random.default_rng(0).normal(size=plain.size) * 1e-9
    a, b = plain.response(u, plain.virgin()), held.response(u, held.virgin())
    assert not a.history[:, 0].any()
    np.testing.assert_array_equal(a.traction, b.traction)
    np.testing.assert_array_equal(a.forces, b.forces)


def test_calibration_scales_coarse_contacts_alone(systems):
    plain, held, _ = systems
    np.testing.assert_array_equal(held.scaled(1.3).moduli, plain.scaled(1.3).moduli)
    fine = held.tessellation.contacts.fine
    np.testing.assert_array_equal(held.scaled(1.3).moduli[fine], np.tile(MODULI, (fine.sum(), 1)))
    np.testing.assert_array_equal(held.scaled(1.3).moduli[~fine], np.tile(1.3 * MODULI, ((~fine).sum(), 1)))
    u = np.random.default_rng(1).normal(size=(plain.size, 2)) * 1e-9
    assert elastic_share(held, u) == elastic_share(plain, u)


def test_nothing_to_calibrate_where_everything_is_fine():
    held = with_regions(beam_system(), Regions(balls=np.array([[0.02, 0.02, 0.01]]), radii=np.array([0.01])))
    assert len(elastic_contacts(held))
    assert calibrated(held, 1.0) is held
    assert held.symmetric.factorizations == 0


def test_utilisation_is_asked_of_coarse_contacts_outside_alone(systems):
    plain, held, elastic = systems
    u = np.random.default_rng(2).normal(size=plain.size) * 1e-6
    there = elastic.contains(held.tessellation.contacts.centroid)
    expected = plain.elastic_utilisation(plain.response(u, plain.virgin()))
    assert expected[there].max() > 1.0
    found = held.elastic_utilisation(held.response(u, held.virgin()))
    np.testing.assert_array_equal(found, np.where(there, 0.0, expected))


def test_limit_on_length_is_for_contacts_that_can_soften():
    """The longest fine contact of the beam is too long for a more brittle material."""
    plain = beam_system()
    contacts = plain.tessellation.contacts
    lengths = np.sort(contacts.length)
    limit = 0.5 * (lengths[-2] + lengths[-1])
    tougher = limit / min(CusatisCedolin.limits(CONCRETE).values())
    brittle = Material.standard(CONCRETE.E, CONCRETE.alpha, CONCRETE.f_t, CONCRETE.G_t * tougher)
    assert min(CusatisCedolin.limits(brittle).values()) == pytest.approx(limit)
    with pytest.raises(InputError, match="mm long"):
        System(plain.tessellation, brittle, CusatisCedolin, plain.conditions)
    there = Regions(balls=contacts.centroid[[contacts.length.argmax()]], radii=np.array([1e-6]))
    system = System(plain.tessellation, brittle, CusatisCedolin, plain.conditions, elastic=there)
    assert len(elastic_contacts(system)) == 1


# --- runs ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("full", [True, False])
def test_contacts_inside_never_get_damage(full):
    """Though they carry more than their strength; the beam cracks beside the region."""
    case = beam(material={"elastic": [box(0.04, 0.06)]}, control={"target": 2e-5}, **REFINING)
    simulation = Simulation(case, full=full)
    refined = False
    for step in simulation.steps():
        s = step.snapshot
        contacts = s.tessellation.contacts
        there = inside(simulation, contacts)
        assert not s.damage[there].any()
        assert not s.opening[there].any()
        factor = np.where(contacts.fine, 1.0, simulation.elastic_scale)[:, None]
        np.testing.assert_allclose(s.traction[there], (factor * MODULI * s.strain)[there], rtol=1e-12)
        refined |= step.refinements > 0 and simulation.elastic_scale != 1.0
    assert s.traction[there, 0].max() > 2.0 * CONCRETE.f_t
    assert s.damage.max() > 0.5
    assert refined != full


def test_a_region_far_from_the_crack_changes_nothing():
    reference = Simulation(beam(), full=True)
    steps = list(reference.steps())
    simulation = Simulation(beam(material={"elastic": [box(0.0, 0.02), box(0.09, 0.1)]}), full=True)
    same = list(simulation.steps())
    last = steps[-1].snapshot
    there = inside(simulation, last.tessellation.contacts)
    assert there.sum() > 50
    assert not last.damage[there].any()
    assert last.damage.max() > 0.9
    assert reference.initial_stiffness == simulation.initial_stiffness
    for name in ("gauge", "load", "load_displacement", "dissipated", "stored", "work", "iterations", "residual"):
        assert [getattr(s, name) for s in same] == [getattr(s, name) for s in steps], name
    np.testing.assert_array_equal(same[-1].snapshot.damage, last.damage)
    np.testing.assert_array_equal(same[-1].snapshot.traction, last.traction)


def test_adaptive_and_full_agree():
    """The region crosses the refined one, so that it holds fine and coarse contacts."""
    case = beam(material={"elastic": [box(0.0, 0.046)]}, discretization={"l_f": 0.006, "l_c": 0.02})
    full = Simulation(case, full=True)
    reference = list(full.steps())
    simulation = Simulation(case)
    steps = list(simulation.steps())
    assert simulation.initial_stiffness == pytest.approx(full.initial_stiffness, rel=2e-4)
    assert simulation.elastic_scale != 1.0
    contacts = steps[-1].snapshot.tessellation.contacts
    there = inside(simulation, contacts)
    assert (there & contacts.fine).any()
    assert (there & ~contacts.fine).any()
    peak = max(s.load for s in reference)
    load = np.interp([s.gauge for s in steps], [s.gauge for s in reference], [s.load for s in reference])
    assert max(s.load for s in steps) == pytest.approx(peak, rel=0.002)
    np.testing.assert_allclose([s.load for s in steps], load, atol=0.01 * peak)


@pytest.mark.parametrize("criterion", ["utilisation", "rankine"])
def test_nothing_is_refined_because_of_elastic_regions(criterion):
    """All but the free end of a beam is elastic: it stays coarse under any load."""
    changes = {
        "notch": None,
        "gauge": None,
        "supports": [{"type": "pin", "face": "bottom", "at": 0.01}, {"type": "roller", "face": "bottom", "at": 0.05}],
        "load": {"at": 0.03},
        "control": {"type": "displacement", "target": 2e-5},
        "adaptivity": {"criterion": criterion, "calibrate": False},
        "discretization": {"l_f": 0.006, "l_c": 0.02},
    }
    simulation = Simulation(beam(material={"elastic": [box(0.0, 0.08)]}, **changes))
    steps = list(simulation.steps())
    assert simulation.bodies_start == steps[-1].bodies < simulation.bodies_full
    assert not any(step.refinements for step in steps)
    last = steps[-1].snapshot
    assert last.traction[:, 0].max() > 2.0 * CONCRETE.f_t
    assert np.linalg.eigvalsh(last.stress).max() > CONCRETE.f_t
    assert any(step.refinements for step in Simulation(beam(**changes)).steps())


def test_a_bar_with_elastic_ends_breaks_between_them():
    """Without them single bodies of the loaded face are torn out."""
    bar = {
        "specimen": {"size": [0.1, 0.03, 0.03]},
        "notch": None,
        "gauge": None,
        "supports": [{"type": "clamp", "face": "left"}],
        "load": {"face": "right", "at": None, "direction": [1, 0, 0]},
        "control": {"type": "dissipation", "target": 2e-4},
    }
    ends = [{"type": "box", "lower": [x, 0, 0], "upper": [x + 0.02, 0.03, 0.03]} for x in (0.0, 0.08)]
    places, spent = [], []
    for elastic in ([], ends):
        steps = list(Simulation(beam(material={"elastic": elastic}, **bar), full=True).steps())
        last = steps[-1].snapshot
        places.append(last.tessellation.contacts.centroid[last.opening > 0.3 * last.opening.max(), 0])
        spent.append(steps[-1].dissipated / (CONCRETE.G_t * 0.03 * 0.03))
    loose, held = places
    assert loose.min() > 0.09
    assert held.min() > 0.03
    assert held.max() < 0.07
    # A crack through the whole section takes more than one through single facets.
    assert spent[1] > max(1.0, 1.5 * spent[0])


@pytest.mark.parametrize("full", [True, False])
def test_a_band_without_nuclei_can_crack(full):
    """All nuclei lie in elastic regions, but facets between them do not."""
    x = np.sort(Simulation(beam(), full=True).tessellation.x[:, 0])
    low = int(np.argmax(np.where((x[1:] > 0.03) & (x[:-1] < 0.07), np.diff(x), 0.0)))
    ends = (x[low] + 1e-6, x[low + 1] - 1e-6)
    simulation = Simulation(beam(material={"elastic": [box(0.0, ends[0]), box(ends[1], 0.1)]}), full=full)
    last = list(simulation.steps())[-1].snapshot
    centroid = last.tessellation.contacts.centroid[:, 0]
    band = (centroid > ends[0]) & (centroid < ends[1])
    assert band.any()
    assert last.damage[band].max() > 0.0
    assert not last.damage[~band].any()


@pytest.mark.parametrize(
    ("elastic", "key"),
    [
        ([box(0.0, 0.1)], "material.elastic"),
        ([box(0.0, 0.05), box(0.05, 0.1)], "material.elastic"),
        ([{"type": "ball", "center": [0.05, 0.02, 0.01], "radius": 1.0}], "material.elastic"),
        ([box(0.0, 0.02), box(0.2, 0.3)], "material.elastic[1]"),
    ],
)
def test_errors_come_before_any_step(elastic, key):
    with pytest.raises(InputError) as caught:
        Simulation(beam(material={"elastic": elastic}))
    assert caught.value.key == key
