"""Calibration of large specimens: the compliance at full resolution from coarser discretizations."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

import fissura
from fissura.adaptivity import limits, load_error_bound, region_from_case
from fissura.adaptivity.extrapolation import _extrapolated, _window, bodies_of_calibration, coarser
from fissura.simulation.loop import Simulation
from fissura.specimen import domain_from_case

LEVELS = np.array([8.0, 4.0, 2.83, 2.0])


@pytest.fixture
def small_limits(monkeypatch):
    """Specimens of some hundred bodies are large."""
    monkeypatch.setattr(limits, "LARGEST_SOLVED", 100)
    monkeypatch.setattr(limits, "MOST_FINE", 1000)
    monkeypatch.setattr(limits, "MOST_OF_SEQUENCE", 1500)


def limit(values, change=0.0):
    return _extrapolated(LEVELS, values, change, 0.1, (1, 2, 3, 4), 0.01)


def test_errors_that_go_with_the_square():
    found = limit(3.0 - 0.01 * LEVELS**2)
    assert found.compliance == pytest.approx(3.0 - 0.01, rel=1e-12)
    straight = np.polynomial.Polynomial.fit(LEVELS[1:], (3.0 - 0.01 * LEVELS**2)[1:], 1)(1.0)
    assert found.error == pytest.approx(limits.FLOOR + (straight - 2.99) / 2.99, rel=1e-9)


def test_nothing_depends_on_the_spacing():
    found = limit(np.full(4, -2.0))
    assert found.compliance == pytest.approx(-2.0)
    assert found.error == pytest.approx(limits.FLOOR)


def test_what_the_radius_changed_is_an_error():
    assert limit(np.full(4, 2.0), 0.02).error == pytest.approx(limits.FLOOR + 0.01 * limits.SHARE_OF_RADIUS)


def test_a_gauge_that_does_not_move():
    assert limit(np.zeros(4)).compliance == limit(np.zeros(4)).error == 0.0


class FakeSequence:
    """Solutions with that many fine bodies at each radius; their value is the radius."""

    def __init__(self, fine):
        self.fine, self.bodies, self.asked = fine, 0, []

    def system(self, radius, spacing):
        self.asked.append(radius)
        fine = np.arange(1000) < self.fine(radius)
        return SimpleNamespace(tessellation=SimpleNamespace(fine=fine))

    def compliance(self, radius, spacing, system):
        self.bodies = len(system.tessellation.fine)
        return radius


@pytest.mark.parametrize(
    ("fine", "radius", "asked"),
    [
        (lambda r: r * r, 12.0, [0.0, 2.0, 4.0, 8.0, 12.0]),
        (lambda r: 5.0 * r, 16.0, [0.0, 2.0, 4.0, 8.0, 12.0, 16.0]),
        (lambda r: 150.0 + 300.0 * (r > 0.0), 0.0, [0.0, 2.0]),  # loads on whole faces
        (lambda r: 500.0, 0.0, [0.0, 2.0]),  # what the case asks for is too much already
    ],
)
def test_windows_are_as_large_as_they_may_be(monkeypatch, fine, radius, asked):
    monkeypatch.setattr(limits, "MOST_FINE", 200)
    monkeypatch.setattr("fissura.adaptivity.extrapolation.is_tabulated", lambda system: True)
    sequence = FakeSequence(fine)
    found = _window(sequence, 8.0)
    assert found.radius == found.value == radius
    assert sequence.asked == asked
    assert found.change == (0.0 if radius == 0.0 else asked[asked.index(radius)] - asked[asked.index(radius) - 1])


def test_members_that_scatter_make_the_error_larger():
    """An L-shaped panel of 1 m, whose corner no window holds, is 0.49 % off; beams lie on the line to 0.02 %."""
    spacings = np.array([4.0, 8.0**0.5, 2.0])
    panel = _extrapolated(spacings, np.array([1.6277, 1.6271, 1.6153]), 0.0, 0.04, (1, 2, 3), 0.01)
    assert panel.error > 0.0049
    line = 1.0 + 1e-4 * spacings**2
    beam = _extrapolated(spacings, line, 0.0, 0.04, (1, 2, 3), 0.01)
    assert beam.compliance == pytest.approx(1.0001)
    straight = np.polynomial.Polynomial.fit(spacings, line, 1)(1.0)
    assert beam.error == pytest.approx(limits.FLOOR + abs(1.0 - straight / 1.0001))


def test_regions_of_the_sequence(small_case):
    case = small_case()
    region = region_from_case(case, domain_from_case(case), full=False)
    places = np.array([[0.01, 0.0, 0.02]])
    found = coarser(region, places, 0.012, 0.04)
    tip = region.lines[0].mean(axis=0)
    up = np.array([0.0, 1.0, 0.0])
    x = np.array([places[0], places[0] + 0.011 * up, tip + 0.0159 * up, tip + 0.0161 * up])
    np.testing.assert_array_equal(found.spacing(x) == 0.0, [True, True, True, False])
    far = np.array([[1.0, 1.0, 1.0]])
    assert found.spacing(far) == 0.04
    grown = found.spacing(places + np.array([[0.0, 0.0, 0.012 + 3 * 0.008]])) - 0.008
    assert grown <= limits.GRADING * 3 * 0.008 + 1e-12


@pytest.mark.parametrize(
    "changes", [{}, {"adaptivity__r_f": 0.024}, {"field": {"length": 0.03}}, {"discretization__placement": "blocks"}]
)
def test_a_small_specimen_as_if_it_were_large(small_case, small_limits, changes, monkeypatch):
    """Twelve bodies over the depth, six over the ligament.

    Errors go with the size of bodies over that of the beam. They were 1.9 % at most in six such beams, and 0.14 % where
    40 to 160 bodies fit into the depth (`benchmarks/calibration_sequence.py`).
    """
    case = small_case(**{"discretization__l_f": 0.005, "discretization__l_c": 0.02, **changes})
    found = Simulation(case).start().start
    assert found.compliance_error is not None
    assert limits.FLOOR <= found.compliance_error < 0.05
    monkeypatch.setattr(limits, "LARGEST_SOLVED", 10_000)
    whole = Simulation(case).start().start
    assert whole.compliance_error is None
    assert found.compliance != whole.compliance
    assert found.compliance == pytest.approx(whole.compliance, rel=0.03)


def test_materials_outside_the_table_are_solved_for(small_case, small_limits):
    case = small_case(
        discretization={"l_f": 0.005, "l_c": 0.02},
        material={"E": 60e9, "alpha": 0.005, "f_t": 2.2e6, "G_t": 2000.0},
        control={"target": 1e-6},
    )
    assert Simulation(case).start().start.compliance_error is None


def test_full_resolution_needs_no_calibration(small_case, small_limits):
    assert Simulation(small_case(), full=True).start().start.compliance is None


def test_bodies_of_calibration():
    assert bodies_of_calibration(limits.LARGEST_SOLVED) == limits.LARGEST_SOLVED
    assert bodies_of_calibration(1e7) == limits.MOST_OF_SEQUENCE < limits.LARGEST_SOLVED


def test_the_error_is_part_of_the_bound():
    assert load_error_bound(0.5, 6.0, 0.002) == pytest.approx(load_error_bound(0.5, 6.0) + 0.002)


def test_a_run_tells_the_error_and_goes_on_with_it(small_case, small_limits, tmp_path):
    fine = {"discretization__l_f": 0.005, "discretization__l_c": 0.02, "adaptivity__r_f": 0.012, "output__vtk": 0}
    fine |= {"control__max_step": 4e-7, "control__first_step": 1e-7, "control__min_step": 1e-9}
    case = small_case(control__target=2e-5, **fine)
    fissura.run(case, output=tmp_path / "run")
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    error = summary["calibration_error"]
    assert error >= limits.FLOOR
    used = summary["max_elastic_utilisation"]
    assert summary["load_error_bound"] == pytest.approx(load_error_bound(used, 2.4) + error)
    longer = small_case(control__target=3e-5, **fine)
    again = fissura.run(longer, output=tmp_path / "run", resume=True)
    whole = fissura.run(longer)
    assert again.summary["calibration_error"] == error
    np.testing.assert_array_equal(again.curve["load_N"], whole.curve["load_N"])


def test_a_run_that_solves_at_full_resolution_tells_no_error(small_case):
    result = fissura.run(small_case(control__target=1e-5))
    assert result.summary["calibration_error"] is None
