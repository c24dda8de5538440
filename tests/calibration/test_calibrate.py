"""Whole calibrations of a tiny beam: known constants come back, nothing is lost, and what is wrong is said."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import fissura
from fissura.calibration.request import problem_of, request_of, unknown_option
from fissura.case import Case, load_case
from fissura.cli import app
from fissura.errors import InputError

TRUE = {"material.f_t": 2e6, "material.G_t": 45.0}


def call(*arguments: Any) -> Any:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.mark.usefixtures("inline")
def test_known_constants_come_back_and_nothing_is_lost(beam_file: Path, measured: Path, tmp_path: Path) -> None:
    count = 0

    def interrupt(summary: dict[str, Any]) -> None:
        nonlocal count
        count += 1
        if count in (2, 8):
            raise KeyboardInterrupt

    folder, options = tmp_path / "out", {"seeds": 3, "runs": 19, "on_outcome": interrupt}
    for resume in (False, True):
        with pytest.raises(KeyboardInterrupt):
            fissura.calibrate(beam_file, measured, output=folder, resume=resume, **options)
    with pytest.raises(InputError, match="has no result"):
        fissura.Calibration.load(folder)
    found = fissura.calibrate(beam_file, measured, output=folder, resume=True, **options)
    assert count == found.runs <= 19  # no run was computed twice
    for key, value in TRUE.items():
        estimate = found.estimates[key]
        assert estimate.value == pytest.approx(
            value, rel=0.2
        )  # one specimen: its scatter; coverage is tested elsewhere
        assert estimate.low < estimate.value < estimate.high
        assert estimate.error**2 == pytest.approx(estimate.from_simulated**2 + estimate.from_measured**2)
        # One specimen, three seeds: the parts are as their roots.
        assert estimate.from_measured == pytest.approx(np.sqrt(3.0) * estimate.from_simulated)

    loaded = fissura.Calibration.load(folder)
    assert loaded.as_dict() == found.as_dict()
    assert repr(loaded) == repr(found)
    assert loaded.save(tmp_path / "saved").values == found.values
    with pytest.raises(InputError, match="is the folder of the calibration itself"):
        loaded.save(folder, overwrite=True)
    assert fissura.Calibration.load(folder).as_dict() == found.as_dict()
    assert {path.name for path in folder.iterdir()} >= {"calibrated.toml", "calibration.json", "calibration.html"}
    page = (folder / "calibration.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 1
    assert found.estimates["material.f_t"].text["value"] in page
    html = found._repr_html_()
    assert html.count("data:image/png;base64,") == 1
    assert found.plot().get_xlabel() == "gauge [µm]"
    frame = pytest.importorskip("pandas") and found.to_dataframe()
    assert frame["value"].tolist() == list(found.values.values())

    text = (folder / "calibrated.toml").read_text()
    assert text.startswith("# A tiny beam.")
    assert "# no farther" in text
    case = load_case(folder / "calibrated.toml")
    assert case.material.f_t == pytest.approx(found.values["material.f_t"], rel=1e-3)
    assert case.material.f_s == 3 * case.material.f_t
    assert fissura.run(case.with_({"control.target": "6 um", "control.max_step": "0.1 um"})).steps > 0

    # The folder goes on with the same only.
    with pytest.raises(InputError, match=r"unknowns\.material\.f_t\.start was 2500000"):
        fissura.calibrate(beam_file, measured, {"material.f_t": {"start": 3e6}}, output=folder, resume=True, seeds=3)


@pytest.mark.slow
@pytest.mark.usefixtures("inline")
def test_a_calibration_that_went_on_is_one_that_was_left_alone(beam_file: Path, measured: Path, tmp_path: Path) -> None:
    def stop(summary: dict[str, Any]) -> None:
        if summary["realisation"]["number"] == 3:
            raise KeyboardInterrupt

    options: dict[str, Any] = {"seeds": 4}
    with pytest.raises(KeyboardInterrupt):
        fissura.calibrate(beam_file, measured, output=tmp_path / "out", on_outcome=stop, **options)
    found = fissura.calibrate(beam_file, measured, output=tmp_path / "out", resume=True, **options)
    calm = fissura.calibrate(beam_file, measured, output=tmp_path / "calm", **options)
    assert calm.as_dict() == found.as_dict()


@pytest.mark.usefixtures("inline")
def test_the_command_and_several_tests(beam_file: Path, measured: Path, tmp_path: Path) -> None:
    request = tmp_path / "two.toml"
    request.write_text(
        f"""
seeds = 2
runs = 12
unknowns."material.f_t" = {{ lower = "1 MPa", upper = "4 MPa" }}
fixed."material.G_t" = "45 J/m^2"
[[test]]
name = "one"
case = "{beam_file}"
measured = "{measured}"
[[test]]
name = "other"
case = "{beam_file}"
measured = ["{measured}", "{measured}"]
until = "40 um"
weight = 2
"""
    )
    folder = tmp_path / "out"
    done = call("calibrate", request, "--output", folder)
    assert done.exit_code == 0, done.stderr
    assert "material.f_t" in done.stdout
    assert "round 1, 2 seeds each: f_t 2.5 MPa" in done.stderr
    found = fissura.Calibration.load(folder)
    assert [fit.name for fit in found.fits] == ["one", "other"]
    assert found.fits[1].x[-1] == pytest.approx(40e-6)
    assert (found.fits[0].specimens, found.fits[1].specimens) == (1, 2)
    assert {path.name for path in folder.glob("calibrated_*.toml")} == {"calibrated_one.toml", "calibrated_other.toml"}
    assert load_case(folder / "calibrated_one.toml").material.G_t == 45.0
    assert (folder / "round01" / "other" / "runs.csv").is_file()
    assert done.stdout.count("residual of") == 2
    again = call("calibrate", request, "--output", folder)
    assert again.exit_code == 2
    assert "--overwrite" in again.stderr


@pytest.mark.usefixtures("inline")
def test_a_case_without_text_and_constants_of_the_whole(beam: Case, measured: Path, tmp_path: Path) -> None:
    fixed = {"material.macro.nu": 0.15}
    found = fissura.calibrate(
        beam, measured, ["material.macro.E"], output=tmp_path / "out", fixed=fixed, seeds=2, runs=8
    )
    data = tomllib.loads((tmp_path / "out" / "calibrated.toml").read_text())
    assert data["material"]["f_t"] == 2.5e6
    case = load_case(tmp_path / "out" / "calibrated.toml")
    whole = case.material.whole
    assert whole is not None
    assert whole.nu == pytest.approx(0.15, rel=1e-6)
    assert pytest.approx(found.values["material.macro.E"], rel=1e-3) == whole.E


def test_an_unknown_that_does_nothing_is_told_after_the_first_rounds(
    beam_file: Path, measured: Path, tmp_path: Path, inline: None
) -> None:
    folder = tmp_path / "out"
    options = ("--unknown", "material.f_t", "--unknown", "material.n_c=1..4", "--seeds", 2, "--output", folder)
    done = call("calibrate", beam_file, measured, *options)
    assert done.exit_code in (2, 3)
    assert "material.n_c" in done.stderr
    assert "does not affect the curves" in done.stderr
    assert (folder / "round02").is_dir()


WRONG: list[tuple[dict[str, Any], str, str]] = [
    ({"unknowns": ["material.ft"]}, "unknown material.ft", "did you mean f_t"),
    ({"unknowns": {"material.f_t": {"lower": "3 mm"}}}, "unknown material.f_t", "not a stress"),
    ({"unknowns": {"material.f_t": {"lower": "3 MPa", "upper": "2 MPa"}}}, "unknown material.f_t", "not below"),
    ({"unknowns": {"material.f_t": {"start": "9 MPa", "upper": "3 MPa"}}}, "unknown material.f_t", "outside of"),
    ({"unknowns": ["specimen.size"]}, "unknown specimen.size", "not a list"),
    ({"unknowns": ["field.length"]}, "unknown field.length", "start from"),
    ({"unknowns": []}, "unknowns", "0 unknowns"),
    ({"fixed": {"material.mu": "3 mm"}}, "fixed material.mu", "3 mm"),
    ({"seeds": 1}, "seeds", "scatter"),
    ({"runs": 10}, "runs", "too few"),
    ({"units": ["mm"]}, "test[0].measured", "1 units"),
    ({"columns": ["x", "y"]}, "test[0].measured", 'no column "x"'),
    ({"measured": None}, "MEASURED", "missing"),
    ({"measured": []}, "test[0].measured", "empty"),
    ({"measured": "none.csv"}, "test[0].measured", "no such file"),
]


@pytest.mark.parametrize(("arguments", "key", "words"), WRONG)
def test_what_is_wrong_is_named_before_anything_runs(
    beam_file: Path, measured: Path, tmp_path: Path, arguments: dict[str, Any], key: str, words: str
) -> None:
    given = {"measured": measured, **arguments}
    with pytest.raises(InputError) as caught:
        fissura.calibrate(beam_file, output=tmp_path / "out", **given)
    assert caught.value.key == key
    assert words in str(caught.value)
    assert not (tmp_path / "out").exists()


def test_files_without_units_and_without_an_overlap(beam_file: Path, tmp_path: Path) -> None:
    path = tmp_path / "curve.csv"
    for text, words in (
        ("0.01,5\n0.02,8\n0.03,7\n", "has no units"),
        ("CMOD,load\n0.01,5\n0.02,8\n", "has no unit"),
        ("CMOD [mm],load [kN]\n1,5\n2,8\n3,7\n", "nothing to be compared with"),
        ("CMOD [mm];load [kN]\n0,01;5\n0,03;8\n0,01;7\n", "turns back"),
        ("CMOD [mm],load [kN]\n0,01,5,0\n0,02,8,0\n", "decimal commas need semicolons"),
        ("load [kN],moment [kN]\n1,5\n", "0 columns of lengths"),
    ):
        path.write_text(text)
        done = call("calibrate", beam_file, path, "--output", tmp_path / "out")
        assert done.exit_code == 2
        assert words in done.stderr
        assert "Traceback" not in done.stderr
    path.write_text("0.01,5\n0.02,8\n0.03,7\n")
    request = request_of({"test": [{"case": str(beam_file), "measured": str(path), "units": ["mm", "N"]}]})
    (test,) = problem_of(request).tests
    np.testing.assert_allclose(test.measured[0].gauge, [1e-5, 2e-5, 3e-5])


def test_bounds_on_the_command_line() -> None:
    assert unknown_option("material.mu") == ("material.mu", {})
    assert unknown_option("material.f_t=1 MPa..6 MPa") == ("material.f_t", {"lower": "1 MPa", "upper": "6 MPa"})
    assert unknown_option("material.mu = 0.1..0.2..0.5")[1] == {"lower": 0.1, "start": 0.2, "upper": 0.5}
    for wrong in ("", "material.mu=3", "material.mu=", "=1..2", "a=1.."):
        with pytest.raises(InputError, match="--unknown"):
            unknown_option(wrong)


def test_results_are_read_with_care(tmp_path: Path) -> None:
    (tmp_path / "calibration.json").write_text(json.dumps({"result": {"fits": 3}}))
    with pytest.raises(InputError, match="is broken"):
        fissura.Calibration.load(tmp_path)
