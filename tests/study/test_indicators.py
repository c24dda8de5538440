import tomllib

import numpy as np
import pytest

from fissura.case import case_from_dict
from fissura.contact import CusatisCedolin
from fissura.material import material_from_case
from fissura.simulation.loop import Simulation
from fissura.study.indicators import OBSERVED, Observer

from .models import CASE


def observed(full, field=None, **adaptivity):
    data = tomllib.loads(CASE) | ({} if field is None else {"field": field})
    data["adaptivity"] |= adaptivity
    case = case_from_dict(data)
    simulation, observer = Simulation(case, full=full), Observer(case.material.f_t, full=full)
    steps = []
    for step in simulation.steps():
        observer.add(step)
        steps.append(step)
    return simulation, observer, steps


@pytest.fixture(scope="module")
def adaptive():
    return observed(False, gamma=0.9)


def test_energy_of_contacts_is_that_of_the_run(adaptive):
    for _, observer, steps in (adaptive, observed(True)):
        energies = observer.energies()
        assert energies.energy.sum() == pytest.approx(steps[-1].dissipated, rel=1e-9)
        assert energies.energy.min() > 0.0
        assert (energies.pairs[:, 0] < energies.pairs[:, 1]).all()
        assert len(np.unique(energies.pairs, axis=0)) == len(energies)


def test_energy_of_a_step_is_that_of_its_contacts(adaptive):
    steps = adaptive[2]
    assert [step.spent.sum() for step in steps] == pytest.approx(
        np.diff([0.0, *(step.dissipated for step in steps)]), rel=1e-9, abs=1e-18
    )
    assert all(len(step.spent) == len(step.snapshot.tessellation.contacts) for step in steps)


def test_indicators_are_what_they_say(adaptive):
    _, observer, steps = adaptive
    found = observer.indicators()
    assert set(found) == set(OBSERVED)
    assert all(len(values) == len(steps) for values in found.values())
    np.testing.assert_allclose(found["utilisation"], [step.max_elastic_utilisation for step in steps], rtol=1e-12)
    assert (found["border_utilisation"] <= found["utilisation"] * (1 + 1e-12)).all()
    assert (found["strained_70"] <= found["strained_50"]).all()
    assert (found["border_1"] <= found["border_2"]).all()
    assert all((values >= 0.0).all() for values in found.values())
    assert found["utilisation"].max() > 0.3
    last = steps[-1]
    assert found["balance"][-1] == pytest.approx(abs(last.exchanged) / last.work, rel=1e-12)
    changed = sum(step.load_change for step in steps) / max(step.load for step in steps)
    assert found["load_change"][-1] == pytest.approx(changed, rel=1e-12)
    assert changed > 0.0


def test_indicators_know_the_random_field():
    simulation, observer, steps = observed(False, {"length": "20 mm", "cov": 0.3})
    found, shot, f_t = observer.indicators(), steps[-1].snapshot, simulation.case.material.f_t
    assert (found["border_utilisation"] <= found["utilisation"] * (1 + 1e-12)).all()
    # The same from the state, with strengths of its own.
    contacts, fine = shot.tessellation.contacts, shot.tessellation.fine
    coarse = np.flatnonzero(~contacts.fine)
    scale = simulation.field.strength(contacts.centroid[coarse])
    law = CusatisCedolin.create(material_from_case(simulation.case), np.full(len(coarse), 1e-3), scale)
    used = law.utilisation(simulation.elastic_scale * shot.strain[coarse])
    mixed = fine[contacts.bodies[coarse]].any(axis=1)
    assert found["utilisation"][-1] == pytest.approx(used.max(), rel=1e-12)
    assert found["border_utilisation"][-1] == pytest.approx(used[mixed].max(), rel=1e-12)
    bodies = np.unique(contacts.bodies[coarse[mixed]])
    bodies = bodies[~fine[bodies]]
    stress = np.linalg.eigvalsh(shot.stress[bodies])[:, -1]
    strength = f_t * simulation.field.strength(shot.tessellation.x[bodies])
    assert found["border_stress"][-1] == pytest.approx((stress / strength).max(), rel=1e-12)
    assert found["border_stress"][-1] != pytest.approx(stress.max() / f_t, rel=1e-2)


def test_full_resolution_has_no_indicators():
    _, observer, _ = observed(True)
    assert observer.indicators() == {}


def test_times_of_refinements_are_counted(adaptive):
    simulation, _, steps = adaptive
    refined = sum(step.refinements for step in steps)
    assert refined > 0
    assert simulation.cpu_refining > 0.0
    assert simulation.cpu_repeated > 0.0
    whole, _, _ = observed(True)
    assert whole.cpu_refining == whole.cpu_repeated == 0.0
