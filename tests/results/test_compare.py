import json
from dataclasses import replace

import numpy as np
import pytest

from fissura.errors import InputError
from fissura.results import Recorder, compare, compare_results

from .synthetic import simulation, step


def run(gauges, loads, folder=None, energy=1.0, cpu=1.0):
    recorder = Recorder(simulation(vtk=0), folder)
    for k, (gauge, load) in enumerate(zip(gauges, loads, strict=True), 1):
        recorder.add(step(k, gauge, load, dissipated=energy * gauge))
    result = recorder.finish("finished")
    return replace(result, curve=result.curve | {"cpu_s": cpu * np.arange(1.0, len(gauges) + 1)})


def test_a_run_against_itself():
    a = run([1e-5, 2e-5, 4e-5], [100.0, 150.0, 80.0])
    c = compare_results(a, a)
    assert c.max_load_difference == 0
    assert c.peak_difference == c.energy_difference == c.stiffness_difference == 0
    assert c.cpu_ratio == 1


def test_difference_is_found_between_steps_and_taken_of_the_peak_of_b():
    # A goes straight from the origin to 200 N; B has a corner of 160 N half way.
    a, b = run([4e-5], [200.0]), run([2e-5, 4e-5], [160.0, 200.0])
    c = compare_results(a, b)
    assert c.max_load_difference == pytest.approx(60 / 200)
    assert c.gauge_of_max_difference == pytest.approx(2e-5)
    assert compare_results(b, a).max_load_difference == pytest.approx(60 / 200)


def test_only_the_common_range_counts():
    a = run([1e-5, 2e-5], [100.0, 200.0], energy=1.1)
    b = run([1e-5, 2e-5, 3e-5], [100.0, 200.0, 900.0], energy=1.0)
    c = compare_results(a, b)
    assert c.gauge[-1] == pytest.approx(2e-5)
    assert c.max_load_difference == 0
    assert c.peak_difference == 0
    assert c.energy_difference == pytest.approx(0.1)


def test_signs_and_ratio():
    a = run([1e-5, 2e-5, 3e-5], [90.0, 190.0, 50.0], cpu=1.0)
    b = run([1e-5, 2e-5, 3e-5], [100.0, 200.0, 60.0], cpu=4.0)
    c = compare_results(a, b)
    assert c.peak_difference == pytest.approx(-0.05)
    assert c.gauge_at_peak_difference == 0
    assert c.cpu_ratio == pytest.approx(4.0)
    stiffer = replace(a, summary=a.summary | {"initial_stiffness_N_per_m": 1.8e8})
    assert compare_results(stiffer, b).stiffness_difference == pytest.approx(0.2)


def test_table_tells_both_values():
    table = dict(compare_results(run([2e-5], [190.0]), run([2e-5], [200.0], cpu=3.0)).table())
    assert table["peak load"] == "190 N against 200 N (-5.00 %)"
    assert table["largest load difference"] == "5.00 % of the peak, at 20.0 µm"
    assert table["processor time"] == "1.00 s against 3.00 s: 3.00 times faster"


def test_folders(tmp_path):
    gauges, loads = [1e-5, 2e-5], [100.0, 120.0]
    a, b = run(gauges, loads, tmp_path / "a"), run(gauges, loads, tmp_path / "b")
    c = compare(tmp_path / "a", tmp_path / "b")
    assert c.max_load_difference == compare_results(a, b).max_load_difference == 0
    assert json.loads((tmp_path / "a" / "summary.json").read_text())["peak_load_N"] == c.a.peak_load


def test_runs_without_steps_cannot_be_compared(tmp_path):
    with pytest.raises(InputError, match="no step"):
        compare_results(run([], []), run([1e-5], [1.0]))
    with pytest.raises(InputError, match="no such folder"):
        compare(tmp_path / "a", tmp_path / "b")
