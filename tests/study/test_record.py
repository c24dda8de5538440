import tomllib
from dataclasses import replace

import numpy as np
import pytest

from fissura.case import case_from_dict
from fissura.errors import InputError
from fissura.study.record import Energies, Record, case_text

from .models import CASE, record


def test_round_trip(tmp_path, beam):
    first = record(beam, [1.0, 3.0, 2.0], variation="default")
    first.save(tmp_path / "deep" / "run.npz")
    again = Record.load(tmp_path / "deep" / "run.npz")
    for name in ("specimen", "seed", "variation", "case", "status", "message", "summary"):
        assert getattr(again, name) == getattr(first, name)
    for name, values in first.curve.items():
        np.testing.assert_array_equal(again.curve[name], values)
    np.testing.assert_array_equal(again.energies.pairs, first.energies.pairs)
    np.testing.assert_array_equal(again.energies.energy, first.energies.energy)
    np.testing.assert_allclose(again.energies.centroid, first.energies.centroid, rtol=1e-7)
    assert set(again.indicators) == set(first.indicators)
    assert again.result().peak_load is not None
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["run.npz"]


def test_a_run_without_steps_can_be_kept(tmp_path, beam):
    record(beam, [], status="refused").save(tmp_path / "run.npz")
    again = Record.load(tmp_path / "run.npz")
    assert (again.steps, again.end, again.message) == (0, "refused", "why")


def test_why_a_run_ended(beam):
    target = beam["control"]["target"]
    assert record(beam, [1.0, 2.0]).end == "target"
    assert record(beam, [1.0, 2.0], gauge=[0.1 * target, 0.2 * target]).end == "load"
    assert record(beam, [1.0, 2.0], status="stopped").end == "stopped"


def test_damaged_files_are_told(tmp_path, beam):
    path = tmp_path / "run.npz"
    with pytest.raises(InputError):
        Record.load(path)
    record(beam, [1.0]).save(path)
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(InputError, match=r"cannot be read|is damaged"):
        Record.load(path)


def test_energies_are_summed_by_pair():
    pairs = np.array([[3, 5], [1, 2], [3, 5]])
    found = Energies.summed(pairs, np.array([1.0, 2.0, 4.0]), np.array([[0, 0, 0], [1, 1, 1], [2, 2, 2.0]]))
    np.testing.assert_array_equal(found.pairs, [[1, 2], [3, 5]])
    np.testing.assert_array_equal(found.energy, [2.0, 5.0])
    np.testing.assert_array_equal(found.centroid, [[1, 1, 1], [2, 2, 2]])
    assert len(Energies.summed(pairs[:0], np.empty(0), np.empty((0, 3)))) == 0


def test_full_resolution_does_not_depend_on_adaptivity():
    case = case_from_dict(tomllib.loads(CASE))
    other = case.model_copy(
        update={
            "adaptivity": case.adaptivity.model_copy(update={"gamma": 0.5}),
            "discretization": case.discretization.model_copy(update={"l_c": 0.03}),
            "output": case.output.model_copy(update={"vtk": 0}),
        }
    )
    assert case_text(case, of_full=True) == case_text(other, of_full=True)
    assert case_text(case) != case_text(other)
    assert case_text(case) == case_text(case.model_dump(mode="json"))
    seeded = case.model_copy(update={"seed": 2})
    assert case_text(case, of_full=True) != case_text(seeded, of_full=True)


def test_head_survives_replacement(beam):
    assert replace(record(beam, [1.0]), status="failed").end == "failed"
