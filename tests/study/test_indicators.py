import tomllib

import numpy as np
import pytest

from fissura.case import case_from_dict
from fissura.simulation import Simulation
from fissura.study.indicators import OBSERVED, Observer

from .models import CASE


def observed(full, **adaptivity):
    data = tomllib.loads(CASE)
    data["adaptivity"] |= adaptivity
    case = case_from_dict(data)
    simulation, observer = Simulation(case, full=full), Observer(case, full=full)
    steps = []
    for step in simulation.steps():
        observer.add(step, simulation.elastic_scale)
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
