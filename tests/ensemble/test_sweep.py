"""Parameter studies: their points, runs, tables, groups and pictures, and what is refused before anything runs."""

from __future__ import annotations

import csv
import gc
import json
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

import fissura
from fissura.case import Case
from fissura.case.points import points_of
from fissura.cli import app
from fissura.cli.values import varied
from fissura.ensemble.outcome import compute
from fissura.ensemble.plan import Plan
from fissura.ensemble.planning import planned
from fissura.ensemble.result import EnsembleResult
from fissura.ensemble.runner import run_ensemble
from fissura.ensemble.table import read_table
from fissura.errors import InputError

Build = Callable[..., Case]

VARY: dict[str, Any] = {"material.f_t": ["2 MPa", "2.5 MPa"], "material.G_t": [30.0, "35 J/m^2"]}


def call(*arguments: Any) -> Any:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def test_a_grid_has_every_combination_and_lists_may_go_together(tiny: Build) -> None:
    vary = {key: tuple(values) for key, values in VARY.items()}
    grid = points_of(tiny(), vary)
    assert [tuple(point.values.values()) for point in grid] == list(product((2e6, 2.5e6), (30.0, 35.0)))
    assert all((p.case.material.f_t, p.case.material.G_t) == tuple(p.values.values()) for p in grid)
    assert [point.case.material.f_s for point in grid] == [6e6, 6e6, 7.5e6, 7.5e6]  # defaults follow
    assert grid[1].label == "f_t = 2 MPa, G_t = 35 J/m^2"
    together = points_of(tiny(), vary, "together")
    assert [tuple(point.values.values()) for point in together] == [(2e6, 30.0), (2.5e6, 35.0)]
    (alone,) = points_of(tiny(), {})
    assert alone.case == tiny()


def test_constants_of_the_material_as_a_whole_are_varied_one_by_one(tiny: Build) -> None:
    case = tiny(material={"macro": {"E": "38 GPa", "nu": 0.18}, "f_t": "2 MPa", "G_t": 35})
    first, second = points_of(case, {"material.macro.E": ("38 GPa", "19 GPa")})
    assert (first.values, second.values) == ({"material.macro.E": 38e9}, {"material.macro.E": 19e9})
    assert pytest.approx(case.material.E, rel=1e-12) == first.case.material.E
    assert pytest.approx(case.material.E / 2, rel=1e-12) == second.case.material.E
    assert second.case.material.alpha == pytest.approx(case.material.alpha, rel=1e-9)


@given(runs=st.integers(1, 5), first=st.integers(1, 4), second=st.integers(1, 3), more=st.integers(0, 3))
def test_every_point_has_the_same_realisations_and_more_go_on_from_there(
    tiny: Build, runs: int, first: int, second: int, more: int
) -> None:
    vary = {"material.f_t": tuple(1e6 + k for k in range(first)), "material.G_t": tuple(30 + k for k in range(second))}
    plan, longer = (Plan(tiny(), n, "both", master=4, companions="each", vary=vary) for n in (runs, runs + more))
    tasks = list(plan.tasks())
    assert len({task.key for task in tasks}) == len(tasks) == 2 * runs * first * second
    alone = Plan(tiny(), runs, "both", master=4)
    for task in tasks:
        assert plan.task(task.key) == task == longer.task(task.key)
        assert task.case.seed == alone.seeds(task.realisation)[0]
        assert task.values == plan.points[task.point].values
        assert task.case.material.f_t == task.values["material.f_t"]
        assert (task.case.field is None) == (task.kind == "companion")


def test_the_seed_of_the_case_stands_for_the_case_as_it_is(tiny: Build) -> None:
    case = tiny(seed=5, field__seed=9)
    plan = planned(case, vary={"material.f_t": ["2 MPa"]})
    assert (plan.runs, plan.chosen, plan.companions, plan.mode) == (1, (5,), "none", "both")
    task = plan.run(1)
    assert (task.case.seed, task.case.field.seed) == (5, 9)  # type: ignore[union-attr]
    assert planned(case, seeds=[7], mode="both").seeds(1) == (7, 7)
    assert planned(case, 2, vary=VARY).seeds(2) == Plan(case, 2, "both", master=5).seeds(2)


WRONG: list[tuple[dict[str, Any], str, str]] = [
    ({"vary": {"material.ft": ["2 MPa"]}}, "vary material.ft", "did you mean f_t"),
    ({"vary": {"material.f_t": ["2 mm"]}}, "vary material.f_t", "not a stress"),
    ({"vary": {"material.f_t": ["2 MPa", "3"]}}, "vary material.f_t", "has no unit"),
    ({"vary": {"material.f_t": "2 MPa"}}, "vary.material.f_t", "not a list"),
    ({"vary": {"material.f_t": []}}, "vary.material.f_t", "empty"),
    ({"vary": {"material.f_t": ["2 MPa"], "material": {"f_t": ["3 MPa"]}}}, "vary", "twice"),
    ({"vary": {"material.f_t": ["2 MPa", 2e6]}}, "vary", "twice"),
    ({"vary": {"discretization.l_f": ["5 mm", "50 mm"]}}, "vary discretization.l_f", "larger than l_c"),
    ({"vary": {"seed": [1, 2]}}, "vary seed", "ensemble"),
    ({"vary": {"output.vtk": [1, 2]}}, "vary output.vtk", "no result"),
    ({"vary": {"material.f_t": list(range(1000, 12000))}}, "vary", "too many"),
    ({"vary": {**VARY, "material.G_t": [30]}, "combine": "together"}, "vary", "differ in length"),
    ({"vary": VARY, "combine": "zip"}, "combine", "'zip'"),
    ({"vary": {"field.length": ["2 cm"]}, "mode": "geometry"}, "--mode", "varied"),
    ({"vary": VARY, "runs": 30_000}, "--runs", "at 4 points"),
    ({}, "--runs", "missing"),
    ({"seeds": [1, 1]}, "seeds", "twice"),
    ({"seeds": [-1]}, "seeds", "-1"),
    ({"seeds": []}, "seeds", "empty"),
    ({"seeds": [1], "seed": 2}, "--seed", "together"),
    ({"seeds": [1], "runs": 2}, "--runs", "together"),
]


@pytest.mark.parametrize(("arguments", "key", "words"), WRONG)
def test_what_is_wrong_is_named_before_anything_runs(
    tiny: Build, tmp_path: Path, arguments: dict[str, Any], key: str, words: str
) -> None:
    with pytest.raises(InputError) as caught:
        run_ensemble(tiny(), output=tmp_path / "out", **arguments)
    assert caught.value.key == key
    assert words in str(caught.value)
    assert caught.value.allowed
    assert not (tmp_path / "out").exists()


@pytest.mark.usefixtures("inline")
def test_a_study_as_its_runs_alone(tiny: Build, tmp_path: Path) -> None:
    case = tiny(field=None, control__stop_load=0.6)
    study = fissura.sweep(case, VARY, seeds=2, output=tmp_path / "out")
    assert study.complete
    assert len(study.groups) == 4
    for point, group in zip(study.plan.points, study.groups, strict=True):
        alone = Plan(point.case, 2, master=case.seed, companions="none")
        peaks = [abs(compute(task).summary["peak_load_N"]) for task in alone.tasks()]
        np.testing.assert_allclose(group.peaks, peaks, rtol=1e-11)
        assert group.values == point.values
        assert group.statistics.rows["peak_load_N"]["mean"] == pytest.approx(np.mean(peaks))
    loaded = EnsembleResult.load(tmp_path / "out")
    np.testing.assert_array_equal(loaded.peaks, study.peaks)
    assert [group.values for group in loaded.groups] == [group.values for group in study.groups]
    for suffix in ("csv", "parquet"):
        rows = read_table(tmp_path / "out" / f"runs.{suffix}")
        assert list(rows)[:6] == ["kind", "number", "point", "realisation", "material.f_t", "material.G_t"]
        np.testing.assert_array_equal(rows["material.f_t"], np.tile([2e6, 2e6, 2.5e6, 2.5e6], 2))
        np.testing.assert_array_equal(rows["realisation"], np.repeat([1, 2], 4))
    with (tmp_path / "out" / "groups.csv").open(encoding="utf-8") as file:
        groups = list(csv.DictReader(file))
    assert [float(row["mean_peak_load_N"]) for row in groups] == pytest.approx([g.peaks.mean() for g in study.groups])
    statistics = json.loads((tmp_path / "out" / "statistics.json").read_text())
    assert [group["values"]["material.G_t"] for group in statistics["groups"]] == [30, 35, 30, 35]
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 2
    assert "2.5 MPa" in page


@pytest.mark.usefixtures("inline", "few_pictures")
def test_results_in_notebooks(tiny: Build, tmp_path: Path) -> None:
    case = tiny(field=None, control__stop_load=0.8, name="a & b")
    study = fissura.sweep(case, {"material": {"f_t": ["2 MPa", "3 MPa"]}})
    folder = study.folder
    assert study.plan.chosen == (case.seed,)
    assert study.result(2).case.material.f_t == 3e6
    html = study._repr_html_()
    assert "a &amp; b" in html
    assert html.count("data:image/png;base64,") == 1
    ax = study.plot()
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["f_t = 2 MPa", "f_t = 3 MPa"]
    over = study.plot(x="f_t", y="peak_load")
    np.testing.assert_allclose(over.lines[0].get_xdata(), [2.0, 3.0])
    assert over.get_xlabel() == "material.f_t [MPa]"
    assert len(study.groups[0].plot().lines) >= 1
    with pytest.raises(InputError, match="no column of the table of runs"):
        study.plot(y="peak_lod")
    frame = pytest.importorskip("pandas") and study.to_dataframe()
    assert frame["material.f_t"].tolist() == [2e6, 3e6]
    assert study.to_dataframe(groups=True)["runs"].tolist() == [1, 1]
    saved = study.save(tmp_path / "kept")
    with pytest.raises(InputError, match="not empty"):
        study.save(tmp_path / "kept")
    del study, ax, over
    gc.collect()
    assert not folder.exists()  # without an output folder it lasts as long as the result
    np.testing.assert_array_equal(EnsembleResult.load(tmp_path / "kept").peaks, saved.peaks)


@pytest.mark.usefixtures("inline", "few_pictures")
def test_studies_in_case_files_and_on_the_command_line(tiny_file: Path, tmp_path: Path) -> None:
    text = tiny_file.read_text() + '[ensemble]\nseeds = [3, 4]\nvary.material.f_t = ["2 MPa", "3 MPa"]\n'
    tiny_file.write_text(text)
    folder, options = tmp_path / "out", ("--mode", "geometry")
    checked = call("check", tiny_file)
    assert "2 realisations at 2 points of material.f_t" in checked.stdout
    done = call("ensemble", tiny_file, *options, "--output", folder)
    assert done.exit_code == 0
    assert "4 of 4 finished" in done.stdout
    assert "seeds 3, 4" in done.stdout
    assert read_table(folder)["seed"].tolist() == [3, 3, 4, 4]
    # Further seeds go on from there, other values do not.
    more = call("ensemble", tiny_file, *options, "--output", folder, "--resume", "--seeds", "3, 4 5")
    assert "6 of 6 finished" in more.stdout
    other = call("ensemble", tiny_file, *options, "--output", folder, "--resume", "--vary", "material.f_t=2 MPa")
    assert other.exit_code == 2
    assert "vary.material.f_t was" in other.stderr
    wrong = call("ensemble", tiny_file, "--vary", "material.f_t = 2 mm", "--output", tmp_path / "none")
    assert wrong.exit_code == 2
    assert "vary material.f_t" in wrong.stderr
    assert not (tmp_path / "none").exists()


def test_values_on_the_command_line() -> None:
    assert varied(["material.f_t=2.5 MPa, 3 MPa", "material.mu=0.2,0.3"]) == {
        "material.f_t": ["2.5 MPa", "3 MPa"],
        "material.mu": [0.2, 0.3],
    }
    assert varied(['specimen.size=["8 cm", 0.02, 0.01], ["9 cm", 0.02, 0.01]'])["specimen.size"][1][0] == "9 cm"
    for wrong in (["material.f_t"], ["=3"], ["material.f_t="], ["a=1", "a=2"]):
        with pytest.raises(InputError, match="--vary"):
            varied(wrong)
