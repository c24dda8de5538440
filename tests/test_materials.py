"""Several materials in one specimen: series stiffness, patch test, the weaker half, and what a case may say."""

import json
from dataclasses import replace

import numpy as np
import pytest

from equilibrium.models import CONCRETE, affine, beam, block, box_domain
from fissura.case import case_from_dict, case_notices
from fissura.contact import CusatisCedolin, limits_from_case
from fissura.equilibrium import System, settle
from fissura.errors import InputError
from fissura.material import Material, Materials, Regions, material_from_case, materials_from_case
from fissura.material.several import joined
from fissura.simulation.discretization import Discretization
from fissura.simulation.loop import Simulation
from fissura.specimen import conditions_from_case, domain_from_case
from fissura.tessellation.discretize import tessellate

LENGTH, SIDE = 0.1, 0.03
RIGHT = {"type": "box", "lower": [0.5 * LENGTH, -1.0, -1.0], "upper": [1.0, 1.0, 1.0]}
SOFT = Material.standard(20e9, 0.5, 1.5e6, 20.0)


def bar(side=SIDE, **changes):
    """An unnotched bar that is pulled; its elongation is controlled."""
    return beam(
        specimen={"size": [LENGTH, side, side]},
        notch=None,
        supports=[{"type": "clamp", "face": "left"}],
        load={"face": "right", "direction": [1, 0, 0], "at": None},
        gauge=None,
        **{"control": {"type": "displacement"}, **changes},
    )


def half(material):
    """Concrete, and another material in the right half of the bar."""
    return Materials(
        CONCRETE, ((Regions(lower=np.array([RIGHT["lower"]]), upper=np.array([RIGHT["upper"]])), material),)
    )


def steps_of(case, **options):
    return list(Simulation(case, **options).steps())


def test_the_same_material_in_regions_changes_no_bit():
    plain = beam(adaptivity={"r_f": 0.015})
    same = beam(adaptivity={"r_f": 0.015}, materials=[{"region": RIGHT}, {"region": RIGHT, "E": "60 GPa"}])
    for a, b in zip(steps_of(plain), steps_of(same), strict=True):
        assert (a.load, a.gauge, a.dissipated) == (b.load, b.gauge, b.dissipated)
        np.testing.assert_array_equal(a.snapshot.traction, b.snapshot.traction)


def test_sets_of_contacts_answer_as_one():
    """A constant that matters nowhere in this run divides the contacts into sets; the run is the same, bit for bit."""
    plain, divided = (
        beam(adaptivity={"coarsen": True}),
        beam(adaptivity={"coarsen": True}, materials=[{"region": RIGHT, "n_c": 2.5}]),
    )
    for a, b in zip(steps_of(plain), steps_of(divided), strict=True):
        assert a.load == b.load
        np.testing.assert_array_equal(a.snapshot.traction, b.snapshot.traction)
        np.testing.assert_array_equal(a.snapshot.damage, b.snapshot.damage)
        np.testing.assert_array_equal(a.utilisation, b.utilisation)


def test_two_halves_are_springs_in_series():
    """Four bodies in a row: the contact in the middle has half its length in each material."""
    case = bar()
    domain, step = domain_from_case(case), LENGTH / 4
    x = np.column_stack([step * (0.5 + np.arange(4)), np.full((4, 2), 0.5 * SIDE)])
    bodies = tessellate(x, domain.cell_of(x), domain.complex, domain.surfaces, np.full(4, step))
    system = System(bodies, half(SOFT), CusatisCedolin, conditions_from_case(case, domain))
    state = settle(system, system.virgin(), 1e-6)
    u = state.response.u.reshape(-1, 6)[:, 0]
    compliance = step / SIDE**2 * np.array([1 / CONCRETE.E, 0.5 / CONCRETE.E + 0.5 / SOFT.E, 1 / SOFT.E])
    np.testing.assert_allclose(np.diff(u), state.load * compliance, rtol=1e-10)


def test_many_materials_are_compared_once():
    """Comparing them again for every pair took 28 s for 120 materials."""
    parts = half(SOFT).parts
    many = Materials(CONCRETE, tuple((parts[0][0], replace(SOFT, f_t=SOFT.f_t + k)) for k in range(50)))
    assert many.each is many.each
    assert len(many.pairs()) == 51 * 52 // 2
    case = beam(materials=[{"region": RIGHT, "E": "50 GPa"}])
    assert case.resolved_materials is case.resolved_materials


def test_joined_material():
    both = joined(CONCRETE, SOFT)
    assert joined(SOFT, CONCRETE) == both
    assert joined(SOFT, SOFT) is SOFT
    assert pytest.approx(2 / (1 / 60e9 + 1 / 20e9)) == both.E
    assert both.alpha * both.E == pytest.approx(2 / (1 / (0.29 * 60e9) + 1 / (0.5 * 20e9)))
    assert (both.f_t, both.G_t, both.f_s, both.f_c, both.G_s) == (SOFT.f_t, SOFT.G_t, SOFT.f_s, SOFT.f_c, SOFT.G_s)
    brittle = Material.standard(60e9, 0.29, 2.2e6, 20.0)
    assert joined(CONCRETE, brittle).G_t == 20.0


def test_patch_test_within_each():
    """With alpha = 1, uniform strain gives every body inside a material the stress of that material."""
    stiff, soft = (Material.standard(E, 1.0, 2.2e6, 35.0) for E in (60e9, 20e9))
    bodies = block((LENGTH, 0.04, 0.04), 0.008, 3)
    domain = box_domain((LENGTH, 0.04, 0.04))
    case = bar(side=0.04)
    regions = half(soft).parts[0][0]
    system = System(bodies, Materials(stiff, ((regions, soft),)), CusatisCedolin, conditions_from_case(case, domain))
    gradient = 1e-6 * np.array([[1.0, 0.3, 0.0], [0.3, -0.2, 0.1], [0.0, 0.1, 0.5]])
    response = system.response(affine(bodies, gradient).ravel(), system.virgin())
    stress = system.stress(response, 0.0)
    right = bodies.x[:, 0] >= 0.5 * LENGTH
    ends = bodies.contacts.bodies
    mixed = np.zeros(len(bodies), dtype=bool)
    mixed[ends[right[ends[:, 0]] != right[ends[:, 1]]]] = True
    inside = ~mixed
    inside[np.unique(bodies.surface.body)] = False
    assert (inside & right).any()
    assert (inside & ~right).any()
    expected = np.where(right, soft.E, stiff.E)[:, None, None] * gradient
    np.testing.assert_allclose(stress[inside], expected[inside], atol=1e-9 * stiff.E * 1e-6)


@pytest.mark.parametrize("full", [False, True])
def test_the_crack_is_in_the_weaker_half(full):
    weak = {"region": RIGHT, "f_t": "1.6 MPa"}
    case = bar(materials=[weak], control={"type": "dissipation", "target": 3e-5}, adaptivity={"r_f": 0.015})
    steps = steps_of(case, full=full)
    contacts, damage = steps[-1].snapshot.tessellation.contacts, steps[-1].snapshot.damage
    assert steps[-1].load < 0.5 * max(step.load for step in steps)
    assert damage.max() > 0.9
    assert contacts.centroid[damage > 0.9, 0].min() > 0.5 * LENGTH - 0.01
    peak = max(step.load for step in steps) / SIDE**2
    assert 1.6e6 < peak < 1.6e6 * 1.35


def test_strength_of_bodies_is_that_of_their_material():
    system = Discretization(bar(materials=[{"region": RIGHT, "f_t": 1.6e6}]), full=True).system
    expected = np.where(system.tessellation.x[:, 0] >= 0.5 * LENGTH, 1.6e6, 2.2e6)
    np.testing.assert_array_equal(system.strength, expected)


def test_defaults_follow_what_is_given_and_numbers_are_kept():
    case = bar(materials=[{"region": RIGHT, "f_t": "1.6 MPa", "macro": {"E": "20 GPa", "nu": 0.2}}])
    (found,) = case.resolved_materials
    assert (found.f_t, found.f_s, found.G_t) == (1.6e6, pytest.approx(4.8e6), 35.0)
    dumped = case.model_dump(mode="json", exclude={"source"})
    assert set(dumped["materials"][0]) == {"region", "f_t", "E", "alpha", "f_s", "f_c", "K_c"}
    again = case_from_dict(json.loads(json.dumps(dumped)))
    assert again.model_dump(mode="json", exclude={"source"}) == dumped
    assert again.resolved_materials == case.resolved_materials
    other = case.model_copy(update={"material": case.material.model_copy(update={"G_t": 50.0})})
    assert other.resolved_materials[0].G_t == 50.0


def test_the_last_region_counts():
    everywhere = {**RIGHT, "lower": [-1.0, -1.0, -1.0]}
    case = bar(materials=[{"region": everywhere, "f_t": 1.8e6}, {"region": [RIGHT], "f_t": 1.6e6}])
    materials = materials_from_case(case)
    kinds = materials.kinds(np.array([[0.01, 0.01, 0.01], [0.09, 0.01, 0.01]]))
    assert [materials.each[k].f_t for k in kinds] == [1.8e6, 1.6e6]
    assert materials.base == material_from_case(case)


def test_limits_are_the_least_of_all_materials():
    brittle = bar(materials=[{"region": RIGHT, "G_t": 20.0}])
    assert limits_from_case(brittle)["in tension"] == pytest.approx(20 / 35 * limits_from_case(bar())["in tension"])


@pytest.mark.parametrize(
    ("part", "key"),
    [
        ({"f_t": 1e6}, "materials[0].region"),
        ({"region": []}, "materials[0].region"),
        ({"region": {**RIGHT, "type": "cone"}}, "materials[0].region.type"),
        ({"region": RIGHT, "f_t": "3 kg"}, "materials[0].f_t"),
        ({"region": RIGHT, "ft": 1e6}, "materials[0].ft"),
        ({"region": RIGHT, "law": "cusatis-cedolin"}, "materials[0].law"),
        ({"region": RIGHT, "f_s": 1e3}, "materials[0].f_s"),
    ],
)
def test_errors_name_the_key(part, key):
    with pytest.raises(InputError) as caught:
        bar(materials=[part])
    assert caught.value.key == key
    assert caught.value.allowed


def test_constants_that_look_wrong_are_named():
    (notice,) = case_notices(bar(materials=[{"region": RIGHT, "f_t": 1.6}]))
    assert notice.key == "materials[0].f_t"


def test_a_region_outside():
    with pytest.raises(InputError, match="outside the specimen") as caught:
        materials_from_case(bar(materials=[{"region": {**RIGHT, "lower": [0.5, 0.5, 0.5]}, "f_t": 1e6}]))
    assert caught.value.key == "materials[0].region"
