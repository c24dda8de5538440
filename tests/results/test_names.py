"""What loads and gauges are called, and what is made of curves with cycles and several loads."""

from types import SimpleNamespace

import numpy as np
import pytest

from conftest import small_beam
from fissura.results.load_path import LoadPath
from fissura.results.names import driven_in, load_name, value_axis
from fissura.results.notices import _pushes

A, B = {"face": "top", "at": 0.04}, {"face": "top", "at": 0.07}
SHEAR = {"load": "a", "control": "force", "to": "300 N"}
TWO = {"control": None, "load": None, "loads": {"a": A, "b": B}}


def two_loads(*stages):
    return small_beam(**TWO, stage=list(stages))


def test_a_load_needs_a_name_where_it_has_one():
    assert load_name(small_beam()) == "load"
    assert load_name(two_loads({"load": {"a": 1, "b": 2}, "to": 1e-5})) == "load (a, b)"
    many = {f"load{k}": A for k in range(5)}
    case = small_beam(control=None, load=None, loads=many, stage={"load": dict.fromkeys(many, 0.2), "to": 1e-5})
    assert load_name(case) == "load (load0, load1, ...)"


def test_a_gauge_with_a_name_need_not_open():
    gauge = {"a": {"face": "bottom", "at": 0.05}, "b": {"face": "bottom", "at": 0.07}}
    case = small_beam(control=None, gauge=None, gauges={"sliding": gauge}, stage={"to": 1e-5})
    assert value_axis(case, "gauge") == "gauge sliding"
    assert value_axis(small_beam(), "gauge") == "gauge opening"
    assert value_axis(case, "displacement") == "displacement of the load"


def test_progress_tells_the_load_that_is_driven():
    case = two_loads(SHEAR, {"load": {"a": 0.5, "b": 0.5}, "to": 1e-5})
    step = SimpleNamespace(stage=1, load=150.0, forces={"a": 300.0, "b": 0.0})
    assert driven_in(case, step) == ("load (a)", 300.0)
    step = SimpleNamespace(stage=2, load=450.0, forces={"a": 600.0, "b": 300.0})
    assert driven_in(case, step) == ("load (a, b)", 450.0)
    heavy = small_beam(gravity={"density": 2400.0})
    step = SimpleNamespace(stage=0, load=0.0, forces={"load": 0.0, "gravity": 7.0})
    assert driven_in(heavy, step) == ("load (gravity)", 7.0)


@pytest.mark.parametrize(
    ("case", "pushes"),
    [
        (small_beam(), True),
        (small_beam(control=None, stage={"to": ["10 um", "5 % of load", "20 um"]}), True),
        (small_beam(control=None, stage={"to": ["10 um", "-10 um"]}), False),
        (small_beam(control=None, stage={"to": ["10 um", "-5 % of load", "20 um"]}), False),
        (small_beam(gravity={"density": 2400.0}), False),
        (two_loads(SHEAR, {"load": "b", "to": 1e-5}), False),
    ],
)
def test_a_negative_load_is_a_fault_only_where_nothing_asks_for_it(case, pushes):
    assert _pushes(case) == pushes


def test_over_energy_a_cycle_is_the_point_where_it_turned():
    energy = np.array([0.0, 1.0, 2.0, 2.0, 2.0 + 1e-15, 2.0, 4.0])
    load = np.array([3.0, 5.0, 6.0, 1.0, 3.0, 5.9, 4.0])
    value = np.array([1.0, 2.0, 3.0, 0.5, 1.5, 2.9, 5.0])
    curve = {"gauge_m": value, "load_N": load, "dissipated_J": energy}
    path = LoadPath.of(curve, "run", "gauge")
    assert not path.grows
    found, of = path.over_energy()
    assert found.tolist() == [0.0, 1.0, 2.0, 4.0]
    assert of[0].tolist() == [3.0, 5.0, 6.0, 4.0]
    assert of[1].tolist() == [1.0, 2.0, 3.0, 5.0]
