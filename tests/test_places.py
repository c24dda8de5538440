"""Places of supports, loads and gauges in whole runs, from case files to peaks and messages."""

from __future__ import annotations

import pytest

import fissura
from fissura.api.check import check
from fissura.errors import InputError
from fissura.simulation.loop import Simulation

#: Thinner than platens are wide.
THIN_BEAM = {
    "specimen__size": [0.12, 0.04, 0.012],
    "notch__depth": 0.016,
    "discretization": {"l_f": 0.006, "l_c": 0.012},
    "control__target": 6e-5,
}


def test_the_peak_does_not_depend_on_the_width_of_a_platen(small_case):
    """A pin turns about the line across the beam, on platens narrower than the beam is thick, as wide, and wider."""
    peaks = []
    for width in (0.0, 0.010, 0.012, 0.013, 0.020):
        case = small_case(supports__0__width=width, **THIN_BEAM)
        peaks.append(max(step.load for step in Simulation(case, full=True).steps()))
    assert 200.0 < peaks[0] < 450.0
    assert peaks == pytest.approx([peaks[0]] * 5, rel=1e-4)


@pytest.mark.parametrize("end", ["a", "b"])
def test_a_gauge_that_ends_in_the_plane_of_an_ideal_cut_is_refused(small_case, end):
    with pytest.raises(InputError, match="ideal cut") as caught:
        check(small_case(**{f"gauge__{end}__at": 0.06}))
    assert caught.value.key == f"gauge.{end}.at"


# Messages that name the key at fault, the same from `check` and from a run

GAUGE = {"a": {"face": "bottom", "point": [0.0595, 0, 0.02]}, "b": {"face": "bottom", "point": [0.0605, 0, 0.02]}}
UNNOTCHED = {"notch": None, "discretization": {"l_f": 0.012, "l_c": 0.024}}
APART = {
    "a": {"face": "bottom", "point": [0.053, 0, 0.02]},
    "b": {"face": "bottom", "point": [0.067, 0, 0.02]},
}

WRONG = {
    "gauge on one body": (UNNOTCHED | {"gauge": GAUGE}, "gauge", "one rigid body"),
    "turned gauge on one body": (UNNOTCHED | {"gauge": GAUGE | {"direction": [0, 1, 1]}}, "gauge", "one rigid body"),
    "recorded gauge on one body": (UNNOTCHED | {"gauge": GAUGE, "control__type": "displacement"}, "gauge", "one rigid"),
    "gauge on supports": (
        {"gauge": {"a": {"face": "bottom", "at": 0.01}, "b": {"face": "bottom", "at": 0.11}, "direction": [0, 1, 0]}},
        "gauge",
        "supports hold both",
    ),
    "load on a pin": ({"load": {"face": "bottom", "at": 0.01}}, "load", "bodies that the supports hold"),
    "load on a roller": ({"load": {"face": "bottom", "at": 0.11}}, "load", "bodies that the supports hold"),
    "load on a clamped face": (
        {"supports": [{"type": "clamp", "face": "left"}], "load": {"face": "left"}, "gauge": None}
        | {"control__type": "displacement"},
        "load",
        "bodies that the supports hold",
    ),
    "E in MPa without its unit": ({"material__E": 6e4}, "material.E", "60 kPa is very soft"),
    "E of the concrete in MPa without its unit": (
        {"material": {"macro": {"E": 38e3, "nu": 0.18}, "f_t": 2.2e6, "G_t": 35.0}},
        "material.macro.E",
        "very soft",
    ),
    "G_t in N/mm": ({"material__G_t": 0.035}, "material.G_t", "very brittle"),
    "f_t too large": ({"material__f_t": 2.2e9}, "material.f_t", "very strong"),
    "a brittle material": ({"material__G_t": 0.2}, "discretization.l_f", "contacts of this material soften"),
}


@pytest.mark.parametrize("full", [True, False])
@pytest.mark.parametrize(("changes", "key", "problem"), WRONG.values(), ids=WRONG)
def test_the_key_at_fault_is_named(small_case, changes, key, problem, full):
    case = small_case(**changes)
    with pytest.raises(InputError, match=problem) as caught:
        check(case)
    assert caught.value.key == key
    with pytest.raises(InputError, match=problem) as caught:
        list(Simulation(case, full=full).steps())
    assert caught.value.key == key


def test_a_specimen_without_its_unit_is_named_where_it_does_not_fit(small_case):
    case = small_case(specimen__size=[120, 60, 40])
    for refuse in (check, fissura.run):
        with pytest.raises(InputError, match="120 m is very large") as caught:
            refuse(case)
        assert caught.value.key == "specimen.size"


def test_a_gauge_on_one_body_of_the_start_alone(small_case):
    """At full resolution its ends are on two bodies: what helps is said, and helps."""
    changes = {"notch": None, "discretization": {"l_f": 0.006, "l_c": 0.04}, "gauge": APART, "adaptivity": None}
    with pytest.raises(InputError, match=r"one rigid body at the start.*adaptivity\.regions") as caught:
        check(small_case(**changes))
    assert caught.value.key == "gauge"
    there = {"type": "ball", "center": [0.06, 0.0, 0.02], "radius": 0.02}
    check(small_case(**(changes | {"adaptivity": {"regions": there, "r_f": 0.012}})))
    step = next(Simulation(small_case(**changes), full=True).steps())
    assert step.load > 0.0


def test_a_start_of_one_body(small_case, tmp_path):
    """It is the spacing that is wrong then, neither gauge nor supports."""
    cube = {
        "specimen__size": [0.02, 0.02, 0.02],
        "notch": None,
        "supports": [{"type": "clamp", "face": "bottom"}],
        "load": {"face": "top"},
        "gauge": None,
        "control__type": "displacement",
        "adaptivity": None,
    }
    (tmp_path / "middle.txt").write_text("0.01 0.01 0.01")
    middle = {"l_f": 0.02, "nuclei": str(tmp_path / "middle.txt")}
    for spacing, key, problem in (
        ({"l_f": 0.01}, "discretization.l_c", "the start has 1 body without any contact"),
        (middle, "discretization.l_f", "single rigid body"),
    ):
        with pytest.raises(InputError, match=problem) as caught:
            check(small_case(**cube, discretization=spacing))
        assert caught.value.key == key
    assert check(small_case(**cube, discretization={"l_f": 0.01, "l_c": 0.012})).bodies_start > 1


def test_a_gauge_that_the_load_does_not_move(small_case):
    """Far beyond the load a cantilever turns, but does not stretch."""
    changes = {
        "specimen__size": [0.3, 0.024, 0.024],
        "notch": None,
        "gauge": {"a": {"face": "top", "at": 0.25}, "b": {"face": "top", "at": 0.28}},
        "supports": [{"type": "clamp", "face": "left"}],
        "load": {"face": "top", "at": 0.09},
    }
    for full in (True, False):
        with pytest.raises(InputError, match="does not move") as caught:
            list(Simulation(small_case(**changes), full=full).steps())
        assert caught.value.key == "gauge"
