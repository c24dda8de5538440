"""Runs with a random field: limits, and the same field whatever the discretization."""

import json
from functools import cache

import numpy as np
import pytest

from equilibrium.models import beam
from fissura import run
from fissura.api.check import check
from fissura.errors import InputError, RunStopped
from fissura.results.state import read_state
from fissura.results.vtk import bodies_grid, contacts_grid
from fissura.simulation.loop import Simulation

REFINING = {"discretization": {"l_f": 0.006, "l_c": 0.02}, "adaptivity": {"r_f": 0.012}}
FIELD = {"length": 0.015, "seed": 6}


@cache
def done(full=False, criterion="utilisation", r_f=0.024):
    case = beam(field=FIELD, **REFINING | {"adaptivity": {"r_f": r_f, "criterion": criterion}})
    simulation = Simulation(case, full=full)
    return simulation, list(simulation.steps())


def test_long_correlation_is_another_material():
    """A field that is the same everywhere, against a case with its strengths and fracture energies."""
    one = Simulation(beam(field={"length": 1e6, "seed": 4}, **REFINING))
    h = float(one.field.strength(np.zeros((1, 3)))[0])
    assert abs(h - 1.0) > 0.02
    other = Simulation(beam(material={"f_t": 2.2e6 * h, "G_t": 35.0 * h * h}, **REFINING))
    curves = [np.array([[s.gauge, s.load, s.dissipated, s.bodies] for s in run.steps()]) for run in (one, other)]
    assert len(curves[0]) == len(curves[1])
    np.testing.assert_allclose(curves[0][:, 0], curves[1][:, 0], rtol=1e-12)
    np.testing.assert_allclose(curves[0][:, 1], curves[1][:, 1], rtol=1e-7)
    np.testing.assert_allclose(curves[0][:, 2], curves[1][:, 2], rtol=1e-6, atol=1e-9)
    np.testing.assert_array_equal(curves[0][:, 3], curves[1][:, 3])


@pytest.mark.parametrize(("criterion", "r_f", "apart"), [("utilisation", 0.024, 0.02), ("rankine", 0.012, 0.1)])
def test_adaptive_and_full_runs_see_the_same_field(criterion, r_f, apart):
    """Contacts between nuclei that both have, at the same place: the same relative strength."""
    adaptive, full = (done(f, criterion, r_f) for f in (False, True))
    assert sum(s.refinements for s in adaptive[1]) > 0
    a, b = adaptive[1][-1].snapshot, full[1][-1].snapshot
    keys = []
    for shot in (a, b):
        t = shot.tessellation
        pairs = t.nucleus[t.contacts.bodies]
        place = np.round(t.contacts.centroid, 9)
        rows = zip(pairs.tolist(), place.tolist(), shot.contact_factor, strict=True)
        keys.append({(*pair, *x): h for pair, x, h in rows})
        np.testing.assert_allclose(shot.contact_factor, full[0].field.strength(t.contacts.centroid), rtol=1e-12)
        np.testing.assert_allclose(shot.body_factor, full[0].field.strength(t.x), rtol=1e-12)
    common = keys[0].keys() & keys[1].keys()
    assert len(common) > 250
    assert max(abs(keys[0][k] - keys[1][k]) for k in common) < 1e-6
    # And so they break alike, the better the more is fine around what breaks.
    loads = [
        np.interp(np.linspace(0, 1e-4, 60), [0] + [s.gauge for s in r[1]], [0] + [s.load for s in r[1]])
        for r in (adaptive, full)
    ]
    assert np.abs(loads[0] - loads[1]).max() < apart * loads[1].max()


def test_criterion_uses_local_strength():
    """Utilisation of coarse contacts is that of the mean material over the local relative strength; so is Rankine's."""
    plain, random = (Simulation(beam(**REFINING, **extra))._discretization.system for extra in ({}, {"field": FIELD}))
    u = np.random.default_rng(1).normal(size=random.size) * 1e-6
    one, other = (s.elastic_utilisation(s.response(u, s.virgin())) for s in (plain, random))
    assert len(random.coarse) > 20
    h = random.field.strength(random.tessellation.contacts.centroid)
    np.testing.assert_allclose(other[random.coarse], one[random.coarse] / h[random.coarse], rtol=1e-12)
    np.testing.assert_allclose(random.strength, 2.2e6 * random.field.strength(random.tessellation.x))
    np.testing.assert_array_equal(plain.strength, 2.2e6)
    assert plain.body_factor is None
    assert plain.contact_factor is None


def test_no_contact_without_damage_exceeds_its_own_strength():
    simulation, steps = done()
    assert max(s.max_elastic_utilisation for s in steps) <= simulation.case.adaptivity.gamma + 1e-12


def test_twice_the_same():
    again = list(Simulation(done()[0].case).steps())
    assert [s.load for s in again] == [s.load for s in done()[1]]


def test_elastic_regions_keep_their_mean():
    region = {"type": "box", "lower": [0.0, 0.0, 0.0], "upper": [0.03, 0.04, 0.02]}
    material = {"elastic": [region]}
    system = Simulation(beam(field=FIELD, material=material))._discretization.system
    inside = system.tessellation.contacts.centroid[:, 0] < 0.03
    assert (system.contact_factor[inside] == 1.0).all()
    assert (system.contact_factor[~inside] != 1.0).all()


def test_energy_with_a_field_of_its_own():
    system = Simulation(beam(field={**FIELD, "energy": {"cross_correlation": 0.5, "cov": 0.15}}))._discretization.system
    x = system.tessellation.contacts.centroid[system.damageable]
    h, g = system.field.strength(x), system.field.energy(x)
    m, length = system.law.material, system.tessellation.contacts.length[system.damageable]
    f = m.f_t * h
    np.testing.assert_allclose(system.law.k_t, 2 * m.E * f**2 * length / (2 * m.E * m.G_t * g - f**2 * length))
    brittle = beam(field={**FIELD, "energy": {"marginal": "weibull", "cov": 1.5}}, material={"G_t": 3.0})
    with pytest.raises((InputError, RunStopped), match=r"field\.energy"):
        list(Simulation(brittle).steps())


def test_files_of_a_run(tmp_path):
    case = beam(field=FIELD, control={"target": 2e-5})
    result = run(case, output=tmp_path)
    assert (tmp_path / "field.png").stat().st_size > 20_000
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["field"]["seed"] == 6
    assert 0.0 < summary["field"]["variance_error"] <= 0.01 < summary["field"]["variance_error_max"]
    shot = result.last
    bodies = bodies_grid(shot).cell_data
    assert (bodies["strength_factor"] == shot.body_factor[bodies["body"]]).all()
    facets = shot.tessellation.contacts.polygons.facet
    assert (contacts_grid(shot).cell_data["strength_factor"] == shot.contact_factor[facets]).all()
    _, again = read_state(tmp_path / "state_last.npz")
    np.testing.assert_array_equal(again.body_factor, shot.body_factor)
    np.testing.assert_array_equal(again.contact_factor, shot.contact_factor)


def test_nothing_of_a_field_without_one(tmp_path):
    result = run(beam(control={"target": 2e-5}), output=tmp_path)
    assert not (tmp_path / "field.png").exists()
    assert json.loads((tmp_path / "summary.json").read_text())["field"] is None
    assert "strength_factor" not in bodies_grid(result.last).cell_data
    assert read_state(tmp_path / "state_last.npz")[1].body_factor is None


def test_check_tells_of_the_field():
    rows = dict(check(beam(field={"length": ["20 mm", "10 mm", "10 mm"]}, seed=7)).table())
    assert rows["random field"] == "squared-exponential, 20 x 10 x 10 mm; grafted, CoV 0.25; seed 7"
    assert "modes" in rows["expansion"]
    assert "on average" in rows["variance error"]
    assert "random field" not in dict(check(beam()).table())
