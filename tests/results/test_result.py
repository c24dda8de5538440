import numpy as np
import pytest

from fissura.errors import InputError
from fissura.results import Result
from fissura.running.recorder import Recorder

from .synthetic import simulation, steps


@pytest.fixture
def result():
    recorder = Recorder(simulation(), None)
    for step in steps([100.0, 300.0, 1234.0, 50.0]):
        recorder.add(step)
    return recorder.finish("finished")


def test_properties(result):
    np.testing.assert_allclose(result.gauge, [2.5e-5, 5e-5, 7.5e-5, 1e-4])
    np.testing.assert_allclose(result.load_values, [100, 300, 1234, 50])
    assert result.peak_load == 1234.0
    assert result.gauge_at_peak == pytest.approx(7.5e-5)
    assert result.dissipated_energy == pytest.approx(4e-3)
    assert result.initial_stiffness == 1.5e8
    assert result.steps == 4
    assert result.last is result.snapshots[4]
    assert result.folder is None


def test_table(result):
    table = dict(result.table())
    assert table["peak load"] == "1.23 kN at 75.0 µm"
    assert table["status"] == "finished"
    assert table["bodies"] == "2 → 2 (full: 40)"
    assert table["case"] == "little beam, seed 7, adaptive (utilisation)"
    assert repr(result).startswith("case ")
    assert len(repr(result).splitlines()) == len(table)


def test_folders_that_are_none(tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        Result.load(tmp_path / "none")
    with pytest.raises(InputError, match="holds no results of a run"):
        Result.load(tmp_path)


def test_broken_case(tmp_path):
    Recorder(simulation(), tmp_path).finish("finished")
    (tmp_path / "case.json").write_text("{")
    with pytest.raises(InputError, match=r"case\.json"):
        Result.load(tmp_path)


def test_no_state():
    empty = Recorder(simulation(), None).finish("stopped")
    with pytest.raises(InputError, match="no state"):
        _ = empty.last
