"""The peak is the load of largest magnitude, with its sign, wherever one is looked for."""

import numpy as np
import pytest

from fissura.pictures.moments import moments
from fissura.results import compare_results
from fissura.results.curve import peak_position
from fissura.results.notices import negative_before_peak
from fissura.running.recorder import Recorder

from .synthetic import simulation, steps

LOADS = [100.0, 300.0, 200.0, 50.0]
OTHERS = [100.0, 280.0, 210.0, 40.0]


def run(loads, folder=None):
    recorder = Recorder(simulation(vtk=0), folder)
    for step in steps(loads):
        recorder.add(step)
    return recorder.finish("finished")


def negated(loads):
    return [-load for load in loads]


@pytest.mark.parametrize(("load", "position"), [([1, 3, -2], 1), ([1, -3, 2], 1), ([2, -2, 1], 0), ([0.0], 0)])
def test_position(load, position):
    assert peak_position(np.array(load, float)) == position


def test_summary_recorder_and_result():
    plus, minus = run(LOADS), run(negated(LOADS))
    assert (plus.peak_load, minus.peak_load) == (300.0, -300.0)
    assert minus.gauge_at_peak == plus.gauge_at_peak == 0.5e-4
    assert list(minus.snapshots) == list(plus.snapshots) == [2, 4]
    assert "-300 N" in dict(minus.table())["peak load"].replace("−", "-")


def test_comparison_is_the_same_with_all_signs_changed():
    plus = compare_results(run(OTHERS), run(LOADS))
    minus = compare_results(run(negated(OTHERS)), run(negated(LOADS)))
    assert minus.peaks == (-280.0, -300.0)
    for name in ("max_load_difference", "peak_difference", "gauge_at_peak_difference", "at_max_difference"):
        assert getattr(minus, name) == pytest.approx(getattr(plus, name), rel=1e-12), name


@pytest.mark.parametrize("loads", [LOADS, negated(LOADS), [-50.0, 300.0, -20.0, 10.0]])
def test_pictures_of_any_sign_can_be_drawn(tmp_path, loads):
    result = run(loads, tmp_path)
    assert (tmp_path / "curve.png").stat().st_size > 5000
    compare_results(result, run(LOADS)).save(tmp_path / "both.png")
    assert (tmp_path / "both.png").stat().st_size > 5000


def test_moments_find_the_peak(tmp_path):
    from fissura.results.history import Frame, Section

    section = Section(np.empty(0), np.empty(0), np.empty((0, 2, 2)), np.empty((0, 2)))
    nothing = np.empty(0)
    frames = [Frame(k, 1e-5 * k, load, 2, section, nothing, nothing, nothing) for k, load in enumerate(negated(LOADS))]
    assert [m.frame.number for m in moments(frames) if m.name == "peak"] == [1]


def test_a_negative_load_before_the_peak_is_a_warning():
    assert run(LOADS).summary["warnings"] == []
    assert run([100.0, 300.0, -20.0, 10.0]).summary["warnings"] == []  # past the peak
    (early,) = run([-50.0, -60.0, 300.0, 10.0]).summary["warnings"]
    assert early.startswith("load: it was negative before the peak in 2 of 3 steps, first at step 1 (gauge 25")
    assert "down to -60.0 N" in early.replace("−", "-")
    (late,) = run([100.0, 200.0, -300.0, 10.0]).summary["warnings"]
    assert late.startswith("load: it was negative before the peak in 1 of 3 steps, first at step 3")
    (notice,) = negative_before_peak(np.array([-1.0]), np.array([1e-6]))
    assert notice.key == "load"
    assert notice.advice
