import json
from dataclasses import replace

import numpy as np
import pytest

from fissura.errors import InputError
from fissura.results import compare, compare_results
from fissura.running.recorder import Recorder

from .synthetic import SNAP_BACK, simulation, snapping, step


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
    assert c.at_max_difference == pytest.approx(2e-5)
    assert compare_results(b, a).max_load_difference == pytest.approx(60 / 200)


def test_only_the_common_range_counts():
    a = run([1e-5, 2e-5], [100.0, 200.0], energy=1.1)
    b = run([1e-5, 2e-5, 3e-5], [100.0, 200.0, 900.0], energy=1.0)
    c = compare_results(a, b)
    assert c.over == "gauge"
    assert c.abscissa[-1] == pytest.approx(2e-5)
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
    turned = dict(compare_results(run([2e-5], [200.0], cpu=3.0), run([2e-5], [190.0])).table())
    assert turned["processor time"] == "3.00 s against 1.00 s: 3.00 times slower"


def turning(factor=1.0, keep=6, **changes):
    recorder = Recorder(simulation(vtk=0), None)
    path = {"gauges": SNAP_BACK[0], "loads": SNAP_BACK[1], "energies": SNAP_BACK[2]} | changes
    for taken in snapping(*(values[:keep] for values in path.values())):
        recorder.add(replace(taken, load=factor * taken.load))
    return recorder.finish("finished")


def test_where_the_gauge_turns_back_energies_are_compared():
    a, b = turning(1.1), turning()
    c = compare_results(a, b)
    assert c.over == "dissipated energy"
    assert c.abscissa == pytest.approx([1e-3, 2e-3, 4e-3, 5e-3])
    assert c.load_b == pytest.approx([300.0, 200.0, 60.0, 30.0])
    assert c.max_load_difference == pytest.approx(0.1)
    assert c.at_max_difference == pytest.approx(1e-3)
    assert c.peak_difference == pytest.approx(0.1)
    assert c.gauges_at_peak == pytest.approx((3e-5, 3e-5))
    table = dict(c.table())
    assert table["common dissipated energy range"] == "1.00 mJ to 5.00 mJ; the gauge turns back"
    assert table["largest load difference"] == "10.00 % of the peak, at 1.00 mJ"


def test_one_curve_that_turns_back_is_enough():
    straight = turning(gauges=[1e-5, 2e-5, 3e-5, 3.1e-5, 3.2e-5, 3.3e-5])
    for a, b in ((straight, turning()), (turning(), straight)):
        c = compare_results(a, b)
        assert c.over == "dissipated energy"
        assert c.max_load_difference == c.peak_difference == 0


def test_steps_of_other_lengths_before_the_gauge_turns_back_are_no_difference():
    """One straight line of loads over gauges; over energy, which grows ever faster along it, it is not straight."""
    path = {
        "gauges": [1.0e-5, 1.1e-5, 2e-5, 3e-5, 2.5e-5, 2e-5],
        "loads": [100.0, 110.0, 200.0, 300.0, 200.0, 60.0],
        "energies": [0.0, 1e-6, 1e-4, 1e-3, 2e-3, 4e-3],
    }
    long = {key: values[:2] + values[3:] for key, values in path.items()}
    for a, b in ((path, long), (long, path)):
        c = compare_results(turning(**a), turning(**b))
        assert c.over == "dissipated energy"
        assert c.max_load_difference == pytest.approx(0.0, abs=1e-12)
        assert np.all(np.diff(c.abscissa) > 0)
        assert c.abscissa[[0, -1]] == pytest.approx([1e-6, 4e-3])
    # A load that is wrong there is found, at the energy of B.
    wrong = compare_results(turning(**{**path, "loads": [100.0, 110.0, 230.0, 300.0, 200.0, 60.0]}), turning(**path))
    assert wrong.max_load_difference == pytest.approx(0.1)
    assert wrong.at_max_difference == pytest.approx(1e-4)


def test_energies_are_compared_up_to_the_common_end_and_told_at_the_ends():
    c = compare_results(turning(keep=5), turning())
    assert c.abscissa[-1] == pytest.approx(4e-3)
    assert c.energy_difference == pytest.approx(-0.2)
    assert dict(c.table())["dissipated energy at the ends"] == "-20.00 %"


def test_an_elastic_peak_counts_where_energies_are_compared():
    a, b = turning(loads=[100.0, 310.0, 290.0, 200.0, 60.0, 30.0]), turning()
    c = compare_results(a, b)
    assert c.peaks == (310.0, 300.0)
    assert c.gauges_at_peak == pytest.approx((2e-5, 3e-5))


def test_rounding_and_standstill_of_the_energy_do_no_harm():
    energies = [1e-21, -2e-21, 1e-3, 2e-3, 2e-3 - 1e-18, 5e-3]
    c = compare_results(turning(energies=energies), turning(energies=energies))
    assert c.max_load_difference == 0
    assert np.all(np.diff(c.abscissa) > 0)


def test_a_gauge_that_turns_back_without_damage_cannot_be_compared():
    with pytest.raises(InputError, match="no dissipated energy"):
        compare_results(turning(energies=[0.0] * 6), turning())
    with pytest.raises(InputError, match="no energy in common"):
        compare_results(turning(keep=3), turning())


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
