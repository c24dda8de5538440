"""The warning that a specimen broke at the places of load and supports."""

import numpy as np
import pytest

from fissura.case import case_from_dict
from fissura.results import Result
from fissura.results.curve import columns, row
from fissura.results.notices import torn_at_places
from fissura.running.recorder import Recorder
from fissura.simulation.loop import Simulation

from .synthetic import simulation, step


def curve(*at, dissipated=1.0):
    """Curve that ends with energies at the load, at supports, and at any of them."""
    reactions = np.arange(6.0 * (len(at) - 2)).reshape(-1, 6)
    places = {"reactions": reactions, "held": tuple(f"support_{k}" for k in range(len(reactions)))}
    early = step(1, 1e-6, 1.0, dissipated=0.0, dissipated_at=0.0 * np.array(at), **places)
    late = step(2, 2e-6, 2.0, dissipated=dissipated, dissipated_at=np.array(at), **places, work=2.0)
    return columns([row(early, 0.0, 0.0), row(late, 0.0, 0.0)])


def test_half_of_the_energy_is_the_limit():
    assert torn_at_places(curve(0.3, 0.1, 0.1, 0.5)) == []
    (notice,) = torn_at_places(curve(0.3, 0.1, 0.11, 0.51))
    assert notice.key == "load"
    assert "51 % of the energy" in notice.problem
    assert "(30 % at load, 11 % at supports[1], 10 % at supports[0])" in notice.problem
    assert "material.elastic" in notice.advice


def test_the_place_with_most_is_named_and_those_with_nothing_are_not():
    (notice,) = torn_at_places(curve(0.001, 0.0, 0.9, 0.9))
    assert notice.key == "supports[1]"
    assert "(90 % at supports[1])" in notice.problem


@pytest.mark.parametrize("dissipated", [0.0, 1e-15])
def test_round_off_is_not_energy(dissipated):
    assert torn_at_places(curve(dissipated, 0.0, dissipated, dissipated=dissipated)) == []


def test_files_without_these_columns_and_runs_without_steps_say_nothing():
    assert torn_at_places({name: values for name, values in curve(0.9, 0.0, 0.9).items() if "_at_" not in name}) == []
    assert torn_at_places(columns([])) == []


def test_columns_and_summary(tmp_path):
    recorder = Recorder(simulation(vtk=0), tmp_path)
    reactions = np.array([[0.0, -100.0, 0.0, 0.0, 0.0, 2.5]])
    rest = np.array([3e-7, 4e-7, 0.0, 0.0, 0.0, 1e-9])
    for k, load in enumerate([100.0, 50.0], 1):
        at = np.array([1e-4, 0.8e-3, 0.9e-3]) * k
        recorder.add(step(k, 1e-5 * k, load, reactions=reactions * k, rest=rest, dissipated_at=at))
    result, again = recorder.finish("finished"), Result.load(tmp_path)
    for found in (result, again):
        assert found.curve["support_0_force_y_N"].tolist() == [-100.0, -200.0]
        assert found.curve["support_0_moment_z_Nm"].tolist() == [2.5, 5.0]
        assert found.curve["dissipated_at_support_0_J"].tolist() == pytest.approx([0.8e-3, 1.6e-3])
        assert found.curve["dissipated_at_load_J"].tolist() == pytest.approx([1e-4, 2e-4])
        assert found.curve["unbalanced_N"].tolist() == pytest.approx([5e-7] * 2, abs=1e-15)
        assert found.summary["unbalanced_force"] == pytest.approx(5e-9, abs=1e-15)
        assert found.summary["unbalanced_arm_m"] == pytest.approx(1e-11, abs=1e-17)
        assert [text.split(":")[0] for text in found.summary["warnings"]] == ["supports[0]"]


def test_a_cube_that_is_pulled_at_its_faces_loses_bodies_there():
    """With zones without damage at both ends it breaks inside, and nothing is said."""
    size = 0.03
    data = {
        "specimen": {"size": [size, size, size]},
        "supports": [{"type": "clamp", "face": "bottom"}],
        "load": {"face": "top", "direction": [0.0, 1.0, 0.0]},
        "material": {"E": 60e9, "alpha": 0.29, "f_t": 2.2e6, "G_t": 35.0},
        "discretization": {"l_f": 0.0075, "l_c": 0.0075},
        "control": {"type": "dissipation", "target": 1e-4, "stop_load": 0.5},
    }

    def broken(**material):
        simulation = Simulation(case_from_dict({**data, "material": {**data["material"], **material}}))
        return columns([row(s, 0.0, 0.0) for s in simulation.steps()])

    (notice,) = torn_at_places(broken())
    assert notice.key in ("load", "supports[0]")
    ends = [{"type": "box", "lower": [0, y, 0], "upper": [size, y + 0.011, size]} for y in (0.0, size - 0.011)]
    inside = broken(elastic=ends)
    assert inside["load_N"][-1] < 0.5 * inside["load_N"].max()
    assert torn_at_places(inside) == []
