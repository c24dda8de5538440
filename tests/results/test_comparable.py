"""Over what runs are compared, and what is said where they are not of the same specimen."""

import logging
from dataclasses import replace

import numpy as np
import pytest

from fissura.case import Case, case_from_dict
from fissura.errors import InputError
from fissura.results import compare, compare_results
from fissura.results.comparable import SPECIMEN, common_quantity, comparison_notices
from fissura.running.recorder import Recorder

from .synthetic import case, simulation, step

OTHER_GAUGE = {"a": {"face": "bottom", "at": "8 mm"}, "b": {"face": "bottom", "at": "12 mm"}}
OTHER_LOAD = {"face": "top", "at": "12 mm"}


def changed(leads="gauge", **tables):
    """The small case with other tables or keys; gauge=None takes it out."""
    data = case({"type": leads}).model_dump(mode="json", exclude={"output", "field", "source"})
    for name, table in tables.items():
        data[name] = {**data[name], **table} if isinstance(table, dict) and isinstance(data.get(name), dict) else table
    data = {name: table for name, table in data.items() if table is not None}
    return case_from_dict(data, files_exist=False)


def run(of, factor=1.0, folder=None):
    """Loads 100, 200, 150 N at gauges 1, 2, 3 (times a factor), displacements half of these."""
    recorder = Recorder(simulation(vtk=0), folder)
    for k, load in enumerate([100.0, 200.0, 150.0], 1):
        gauge = 1e-5 * k * factor
        recorder.add(step(k, gauge, load, load_displacement=0.5e-5 * k, dissipated=1e-3 * k))
    return replace(recorder.finish("finished"), case=of)


def keys(a, b):
    return [notice.key for notice in comparison_notices(a, b, common_quantity(a, b, "A"))]


def test_the_same_specimen_says_nothing_whatever_it_is_run_with():
    a = case()
    finer = changed(
        discretization={"l_c": 0.004}, adaptivity={"gamma": 0.7, "r_f": 0.02, "r_c": 0.03},
        control={"max_step": 1e-6, "first_step": 1e-7}, solver={"linear": "direct"}, name="another name",
    )  # fmt: skip
    assert keys(a, a) == keys(a, finer) == keys(finer, a) == []
    assert compare_results(run(a), run(finer)).notices == ()


def test_every_part_of_a_case_is_of_the_specimen_or_of_how_it_is_run():
    run = {"name", "adaptivity", "control", "stage", "gauge", "gauges", "output", "solver", "ensemble"}
    assert set(Case.model_fields) == {*SPECIMEN, *run}


@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        ({"seed": 8}, "seed", "seed 7 and 8"),
        ({"specimen": {"size": [0.02, 0.01, 0.02]}}, "specimen.size", "specimen.size [0.02, 0.01, 0.01] and [0.02, 0."),
        ({"material": {"G_t": 40.0}}, "material.G_t", "material.G_t 35 and 40"),
        ({"notch": {"position": 0.01, "depth": 0.004}}, "notch", "notch none and given"),
        ({"minus": {"box": {"lower": [0, 0, 0], "upper": [0.002, 0.002, 0.01]}}}, "minus", "minus none and given"),
        (
            {"materials": {"region": {"type": "ball", "center": [0, 0, 0], "radius": 0.004}, "f_t": 1e6}},
            "materials",
            "materials none and given",
        ),
        ({"discretization": {"l_f": 0.001}}, "discretization.l_f", "discretization.l_f 0.002 and 0.001"),
        ({"field": {"length": 0.01}}, "field", "field none and given"),
        ({"load": {"at": 0.011}}, "load.at", "load.at 0.01 and 0.011"),
    ],
)
def test_different_specimens_are_a_warning_that_says_in_what(change, key, words):
    a, b = case(), changed(**change)
    (notice,) = comparison_notices(a, b, "gauge")
    assert notice.key == key
    assert f"A and B broke different specimens: {words}" in notice.problem
    assert len(comparison_notices(b, a, "gauge")) == 1
    assert notice.problem.count(" and ") <= 2 + 4 + 1  # four differences at most, and how many more


def test_gauges_matter_where_loads_are_compared_over_them():
    a, b = case(), changed(gauge=OTHER_GAUGE)
    assert keys(a, b) == ["gauge.a.at"]
    assert "gauge.a.at 0.009 and 0.008, gauge.b.at 0.011 and 0.012" in comparison_notices(a, b, "gauge")[0].problem
    assert keys(changed("displacement"), changed("displacement", gauge=OTHER_GAUGE)) == []


def test_the_same_length_in_another_unit_is_the_same():
    assert keys(changed(load={"width": "0.2 cm"}), changed(load={"width": 0.002 * (1 + 1e-15)})) == []


def test_gauge_and_displacement_are_compared_over_what_both_have():
    by_gauge = case()
    assert common_quantity(by_gauge, changed("displacement"), "A") == "gauge"
    assert common_quantity(changed("displacement", gauge=None), by_gauge, "A") == "displacement"
    assert common_quantity(by_gauge, changed("displacement", gauge=OTHER_GAUGE), "A") == "displacement"
    assert common_quantity(changed("displacement"), changed("displacement", gauge=None), "A") == "displacement"
    assert keys(by_gauge, changed("displacement")) == ["control.type"]


def test_nothing_in_common_is_refused():
    other = changed("displacement", gauge=None, load=OTHER_LOAD)
    with pytest.raises(InputError, match="nothing can be compared") as caught:
        compare_results(run(case()), run(other))
    assert caught.value.key == "little beam"
    both = changed("displacement", gauge=OTHER_GAUGE, load=OTHER_LOAD)
    with pytest.raises(InputError, match="nothing can be compared"):
        common_quantity(both, case(), "A")


def test_values_are_those_of_the_common_quantity():
    """Gauges differ by a factor of 2, displacements not at all."""
    a, b = run(case()), run(changed("displacement", gauge=None), 2.0)
    found = compare_results(a, b)
    assert (found.over, found.quantity) == ("displacement of the load", "displacement")
    assert found.max_load_difference == found.peak_difference == found.gauge_at_peak_difference == 0.0
    assert found.abscissa[-1] == pytest.approx(1.5e-5)
    assert np.isnan(found.stiffness_difference)  # over the gauge here, over the displacement there
    table = dict(found.table())
    assert table["common displacement of the load range"] == "0 to 15.0 µm"
    assert table["displacement of the load at peak"].startswith("10.0 µm against 10.0 µm")
    assert table["initial stiffness"].endswith("(-)")
    assert compare_results(a, run(case(), 2.0)).max_load_difference == pytest.approx(100 / 150)


def test_pictures_are_over_the_common_quantity(tmp_path, monkeypatch):
    from fissura.pictures import curves as pictures

    figures = []
    monkeypatch.setattr(pictures.Figure, "savefig", lambda figure, *_, **__: figures.append(figure))
    compare_results(run(case()), run(changed("displacement", gauge=None), 2.0)).save(tmp_path / "x.png")
    upper, lower = figures[0].axes
    assert lower.get_xlabel() == "displacement of the load [µm]"
    np.testing.assert_allclose(upper.get_lines()[0].get_xdata(), [0.0, 5.0, 10.0, 15.0])


def test_folders_warn(tmp_path, caplog):
    for name, seed in (("a", 7), ("b", 8)):
        recording = simulation(vtk=0)
        recording.case = changed(seed=seed)
        recorder = Recorder(recording, tmp_path / name)
        for k, load in enumerate([100.0, 200.0], 1):
            recorder.add(step(k, 1e-5 * k, load))
        recorder.finish("finished")
    with caplog.at_level(logging.WARNING):
        found = compare(tmp_path / "a", tmp_path / "b")
    assert [notice.key for notice in found.notices] == ["seed"]
    assert any("broke different specimens: seed 7 and 8" in message for message in caplog.messages)
