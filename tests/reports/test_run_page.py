"""What the page of a run says, and what it is made of, without a browser."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

import fissura
from fissura.errors import InputError
from fissura.reports import libraries, page
from fissura.reports.bodies import MOST_BYTES as MOST_OF_BODIES
from fissura.reports.page import MOST_BYTES
from fissura.reports.run import run_page
from fissura.results import Result

from .made import NASTY, made
from .unpacking import data_of, dequantised


class Reader(HTMLParser):
    """Collects the tags of a page, and its text outside of scripts and styles."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.tags, self.words, self._inside = [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        if tag in ("script", "style", "title"):
            self._inside.append(tag)

    def handle_endtag(self, tag):
        if self._inside and self._inside[-1] == tag:
            self._inside.pop()

    def handle_data(self, data):
        if not self._inside:
            self.words.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("run")
    made(place)
    return place


def test_a_page_needs_nothing_else(folder):
    text = run_page(Result.load(folder))
    for tag, attributes in Reader(text).tags:
        for name in ("src", "href", "data", "action", "poster"):
            assert attributes.get(name, "data:,") == "data:,", (tag, attributes)
    style = re.search("<style>(.*?)</style>", text, re.DOTALL)[1]
    assert "url(" not in style
    assert "@import" not in style


def test_the_curve_in_a_page(folder):
    result = Result.load(folder)
    data = data_of(run_page(result))["curve"]
    columns = {column["name"]: column for column in data["columns"]}
    assert set(columns) == set(result.curve) - {"control"}
    assert data["steps"].tolist() == [0, *result.curve["step"].tolist()]
    np.testing.assert_allclose(columns["gauge_m"]["values"], [0.0, *1e6 * result.gauge])
    assert columns["gauge_m"]["title"] == "gauge opening [µm]"
    np.testing.assert_allclose(columns["load_N"]["values"], [0.0, *result.load_values])
    assert columns["load_N"]["title"] == "load [N]"
    assert np.isnan(columns["bodies"]["values"][0])
    assert (data["x"], data["y"]) == ("gauge_m", "load_N")


def test_the_states_in_a_page(folder):
    scene = data_of(run_page(Result.load(folder)))["scene"]
    assert [state["number"] for state in scene["states"]] == [2, 3, 4, 6]
    assert scene["bounds"] == [[0, 0, 0], [20, 10, 10]]
    assert scene["widest"] == pytest.approx(12.0)
    for state in scene["states"]:
        np.testing.assert_allclose(dequantised(state["cracks"]["opening"]), 2.0 * state["number"], rtol=1e-4)
    # 6 µm in 20 mm: as large as a few per cent, in round numbers.
    assert scene["magnify"] == 100.0


def test_what_a_page_says(folder):
    result = Result.load(folder)
    result.summary["load_error_bound"] = 0.0123
    result.summary["commit"] = "0123abc-dirty"
    text = Reader(run_page(result)).text
    for words in (
        "little beam", "seed 7", "1.23 %", "9 of 10 runs", "fifth of the bound", "0123abc, with changes",
        "4 steps of 6, those whose states were recorded", "@misc{fissura", "processors", "UTC", "Eliáš",
        "Three.js Authors", "Plotly Technologies", "K3D authors", "THE SOFTWARE IS PROVIDED",
    ):  # fmt: skip
        assert words in text, words
    assert "Warnings" not in text


def test_a_run_at_full_resolution_has_no_bound(folder):
    assert "adaptivity adds no error" in run_page(replace(Result.load(folder), full=True))


def test_what_is_not_recorded(folder):
    result = Result.load(folder)
    for key in ("commit", "machine", "date", "load_error_bound", "versions"):
        result.summary.pop(key, None)
    text = Reader(run_page(result)).text
    assert "commit not recorded" in text
    assert "machine not recorded" in text
    assert "No bound is known" in text


def test_text_of_users_stands_letter_by_letter(tmp_path):
    result = made(None, name=NASTY, source=f'name = "x" # {NASTY}')
    result.summary["warnings"] = [f"material.E: {NASTY}"]
    result.summary["message"] = NASTY
    result.summary["status"] = "stopped"
    page = run_page(result)
    plain = Reader(run_page(made(None)))
    assert [tag for tag, _ in Reader(page).tags if tag == "script"] == [t for t, _ in plain.tags if t == "script"]
    assert not [tag for tag, _ in Reader(page).tags if tag in ("b", "i") and _ == {}]
    assert Reader(page).text.count(NASTY) >= 4  # headline, warning, message, case
    assert "49" not in Reader(page).text.split("Key numbers")[0]


@pytest.mark.parametrize(
    ("status", "words"),
    [
        ("running", "goes on, or was killed"),
        ("stopped", "stopped early. said <i>stop</i>"),
        ("interrupted", "was interrupted"),
        ("refused", "refused"),
        ("failed", "failed"),
        ("strange", "The status of the run is strange"),
    ],
)
def test_a_run_that_did_not_finish(status, words):
    assert words in Reader(run_page(made(None, status=status))).text


def test_a_killed_run(tmp_path):
    made(tmp_path, status="running")
    (tmp_path / "state_last.npz").unlink()
    for path in tmp_path.glob("*.vtu"):
        path.unlink()
    page = run_page(Result.load(tmp_path))
    assert "which left no states" in Reader(page).text
    scene = data_of(page)["scene"]
    assert scene["states"] == []
    assert len(scene["plot"]) > 100


def test_a_run_without_steps(tmp_path):
    made(tmp_path, count=0, status="stopped")
    page = run_page(Result.load(tmp_path))
    assert "The run has no steps." in Reader(page).text
    assert data_of(page) is None


def test_a_specimen_whose_file_is_gone(folder, monkeypatch):
    def gone(case):
        raise InputError("specimen.mesh", "part.msh is missing", "a file")

    monkeypatch.setattr("fissura.reports.run.domain_from_case", gone)
    page = run_page(Result.load(folder))
    assert "cannot be drawn: specimen.mesh: part.msh is missing" in Reader(page).text
    assert data_of(page)["scene"] is None


def test_measured_loads(tmp_path):
    measured = tmp_path / "measured.csv"
    measured.write_text("cmod_mm,min_N,max_N\n0,0,0\n0.05,400,600\n")
    result = made(None)
    case = result.case.model_copy(update={"output": result.case.output.model_copy(update={"measured": measured})})
    found = data_of(run_page(replace(result, case=case)))["measured"]
    np.testing.assert_allclose(found["x"], [0, 50])
    np.testing.assert_allclose(found["upper"], [0, 600])
    measured.unlink()
    assert data_of(run_page(replace(result, case=case)))["measured"] is None


def test_steps_that_are_left_out_are_told(folder, monkeypatch):
    monkeypatch.setattr("fissura.reports.run.shown_steps", lambda result: [2, 6])
    assert "2 more recorded steps were left out" in Reader(run_page(Result.load(folder))).text


def test_cracks_that_are_left_out_are_told(folder, monkeypatch):
    real = fissura.reports.run.states_of

    def fewer(result, steps):
        states = real(result, steps)
        states[0]["cracks"]["left_out"] = 12345
        return states

    monkeypatch.setattr("fissura.reports.run.states_of", fewer)
    assert "12 345 of the facets with damage" in Reader(run_page(Result.load(folder))).text


def test_bodies_that_do_not_fit(folder, monkeypatch):
    monkeypatch.setattr("fissura.reports.run.states_of", lambda result, steps: [])
    assert "do not fit into a page of 15 MB" in Reader(run_page(Result.load(folder))).text


def test_there_is_room_for_libraries_and_bodies():
    code = sum(len(library.code) + len(library.licence) for library in (libraries.plotly(), libraries.k3d()))
    assert code + MOST_OF_BODIES < 0.9 * MOST_BYTES


# The function, and files


def test_a_report_of_a_folder(folder):
    path = fissura.report(folder)
    assert path == folder / "report.html"
    assert "report.html" in (folder / ".fissura").read_text()
    first = path.read_text()
    assert fissura.Result.load(folder).report() == path
    assert path.read_text() == first


def test_a_report_elsewhere(folder, tmp_path):
    assert fissura.report(str(folder), tmp_path / "a.HTM").read_bytes()[:15] == b"<!DOCTYPE html>"
    assert made(None).report(tmp_path / "b.html").exists()


def test_a_file_of_somebody_else_is_left_alone(tmp_path):
    made(tmp_path)
    (tmp_path / "report.html").write_text("mine")
    with pytest.raises(InputError, match="Fissura did not write it"):
        fissura.report(tmp_path)
    assert (tmp_path / "report.html").read_text() == "mine"


def test_no_report(tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        fissura.report(tmp_path / "none")
    with pytest.raises(InputError, match="holds no results of a run"):
        fissura.report(tmp_path)
    with pytest.raises(InputError, match="kept in memory only"):
        fissura.report(made(None))
    made(tmp_path / "run")
    with pytest.raises(InputError, match=r"a\.pdf: reports are written as \.html only"):
        fissura.report(tmp_path / "run", tmp_path / "a.pdf")
    with pytest.raises(OSError, match="none"):
        fissura.report(tmp_path / "run", tmp_path / "none" / "a.html")


def test_a_page_that_would_be_too_large(folder, tmp_path, monkeypatch):
    monkeypatch.setattr(page, "MOST_BYTES", 1000)
    with pytest.raises(InputError, match="the page would have"):
        fissura.report(folder, tmp_path / "a.html")
    assert not (tmp_path / "a.html").exists()


@pytest.mark.parametrize("missing", [("k3d",), ("plotly", "k3d")])
def test_without_the_extra(folder, monkeypatch, missing):
    monkeypatch.setattr(libraries, "find_spec", lambda name: None if name in missing else object())
    with pytest.raises(InputError, match=rf"{', '.join(missing)}.*not installed.*fissura\[report\]"):
        fissura.report(folder)
