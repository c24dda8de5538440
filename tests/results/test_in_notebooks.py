"""What a result offers to Python and notebooks: plots, tables, meshes, a page."""

from __future__ import annotations

import base64
import io
import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from PIL import Image

from fissura.api.check import CheckReport
from fissura.errors import InputError
from fissura.results import Result, compare, dataframe
from fissura.results.names import column_named
from fissura.running.recorder import Recorder
from fissura.text.units import split_unit

from .synthetic import simulation, steps

mpl.use("Agg")


@pytest.fixture
def result() -> Any:
    recorder = Recorder(simulation(), None)
    for step in steps([100.0, 300.0, 1234.0, 50.0]):
        recorder.add(step)
    return recorder.finish("finished")


@pytest.fixture(autouse=True)
def _no_figures_left() -> Any:
    yield
    from matplotlib import pyplot

    pyplot.close("all")


def test_plot_in_the_units_of_the_axes(result: Result) -> None:
    ax = result.plot()
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("gauge opening [µm]", "load [kN]")
    x, y = ax.lines[0].get_data()
    assert x == pytest.approx(1e6 * result.gauge)
    assert y == pytest.approx(1e-3 * result.load_values)
    assert ax.lines[0].get_label() == "little beam"


def test_plot_of_any_columns(result: Result) -> None:
    ax = result.plot(x="step", y="dissipated", color="red", label="energy")
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("step", "dissipated [mJ]")
    assert ax.lines[0].get_ydata() == pytest.approx([1.0, 2.0, 3.0, 4.0])
    assert (ax.lines[0].get_color(), ax.lines[0].get_label()) == ("red", "energy")
    assert result.plot("load_displacement", "support_0_moment_x_Nm").get_ylabel() == "support 0 moment x [N m]"


def test_curves_of_two_results_share_the_units(result: Result) -> None:
    """A second one, a hundred times as large, is drawn in the units that the axes name."""
    ax = result.plot()
    curve = result.curve | {name: 100 * result.curve[name] for name in ("gauge_m", "load_N")}
    other = Result(result.case, True, curve, result.summary, {})
    assert other.plot(ax=ax) is ax
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("gauge opening [µm]", "load [kN]")
    assert ax.lines[1].get_xdata() == pytest.approx(1e8 * result.gauge)
    assert ax.lines[1].get_label() == "little beam at full resolution"
    assert other.plot().get_xlabel() == "gauge opening [mm]"
    ax = result.plot()
    ax.set_xlabel("CMOD [mm]")
    assert result.plot(ax=ax).get_xlabel() == "CMOD [mm]"
    assert ax.lines[1].get_xdata() == pytest.approx(1e3 * result.gauge)


@pytest.mark.parametrize(
    ("columns", "key", "told"),
    [
        ({"x": "gauge_mm"}, "x", "did you mean gauge_m?"),
        ({"y": "loads"}, "y", "did you mean load?"),
        ({"y": "control"}, "y", "holds words"),
        ({"y": "xyzzy"}, "y", "is no column of the curve (allowed: step, gauge_m"),
    ],
)
def test_columns_that_are_none(result: Result, columns: Any, key: str, told: str) -> None:
    with pytest.raises(InputError) as caught:
        result.plot(**columns)
    assert caught.value.key == key
    assert told in str(caught.value)


def test_units_in_names() -> None:
    assert split_unit("max_elastic_utilisation") == ("max_elastic_utilisation", "")
    assert split_unit("dissipated_at_places_J") == ("dissipated_at_places", "J")
    assert split_unit("m") == ("m", "")
    assert column_named(["gauge_m", "gauge"], "gauge_m", "x") == "gauge_m"


def test_plot_of_the_crack(result: Result) -> None:
    from matplotlib import pyplot

    ax = result.plot_crack()
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x [mm]", "y [mm]")
    assert ax.get_title(loc="left") == "little beam"
    assert [other.get_ylabel() for other in ax.figure.axes[1:]] == ["crack opening [µm]"]
    mine = pyplot.subplots()[1]
    assert result.plot_crack(ax=mine) is mine
    assert mine.get_title(loc="left") == ""
    with pytest.raises(InputError, match="no state"):
        Recorder(simulation(), None).finish("stopped").plot_crack()


def test_dataframe(result: Result) -> None:
    pytest.importorskip("pandas")
    frame = result.to_dataframe()
    assert list(frame.index) == [1, 2, 3, 4]
    assert set(frame.columns) == {*result.curve} - {"step"}
    for name in ("load_N", "control"):
        np.testing.assert_array_equal(frame[name].to_numpy(), result.curve[name])


def test_dataframe_without_pandas(result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> Any:
        raise ImportError(name)

    monkeypatch.setattr(dataframe, "import_module", missing)
    with pytest.raises(InputError, match="pip install pandas"):
        result.to_dataframe()


class Page(HTMLParser):
    """Collects what a browser would show."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.words: list[str] = []
        self.images: list[dict[str, str | None]] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if tag == "img":
            self.images.append(dict(attrs))

    def handle_data(self, data: str) -> None:
        self.words.append(data)


def test_page(result: Result) -> None:
    page = Page(result._repr_html_())
    for name, value in result.table():
        assert name in page.words
        assert value in page.words
    (image,) = page.images
    data = re.sub("^data:image/png;base64,", "", image["src"] or "")
    with Image.open(io.BytesIO(base64.b64decode(data, validate=True))) as picture:
        assert min(picture.size) > 300


def test_what_users_wrote_is_only_text(result: Result) -> None:
    evil = '"><script>alert(1)</script>&amp;'
    case = result.case.model_copy()
    object.__setattr__(case, "name", evil)
    summary = result.summary | {"case": evil, "message": evil, "warnings": [evil]}
    page = Page(Result(case, False, result.curve, summary, {})._repr_html_())
    assert "script" not in page.tags
    assert page.images[0]["alt"] == f"curve of {evil}"
    assert evil in page.words  # the warning
    assert sum(evil in word for word in page.words) == 3


def test_comparison_in_a_notebook(result: Result, tmp_path: Path) -> None:
    """What ``fissura compare`` prints, draws and warns of, from results in memory or their folders."""
    curve = result.curve | {"load_N": 1.1 * result.curve["load_N"]}
    case = result.case.with_({"seed": 8})
    higher = Result(case, True, curve, result.summary, result.snapshots)
    both = compare(higher, result.save(tmp_path / "run"))
    assert both.numbers()["peak_load_N"] == pytest.approx((1.1 * 1234.0, 1234.0, 0.1))
    assert both.numbers()["load_N"] == pytest.approx((1.1 * 1234.0, 1234.0, 0.1))
    assert both.numbers()["dissipated_energy_J"][2] == 0.0
    page = Page(both._repr_html_())
    for name, value in both.table():
        assert name in page.words
        assert value in page.words
    assert len(page.images) == 1
    assert any("broke different specimens: seed" in word for word in page.words)
    upper, lower = both.plot()
    assert (upper.get_ylabel(), lower.get_ylabel()) == ("load [kN]", "A − B\n[% of peak]")
    assert upper.lines[1].get_ydata()[1:] == pytest.approx(1e-3 * higher.load_values)


def test_comparison_as_a_table_and_as_files(result: Result, tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    both = compare(result, result)
    frame = both.to_dataframe()
    assert list(frame.columns) == ["a", "b", "difference"]
    assert frame.loc["peak_load_N"].tolist() == [1234.0, 1234.0, 0.0]
    pandas.testing.assert_frame_equal(pandas.read_csv(both.save(tmp_path / "c.csv"), index_col="quantity"), frame)
    read = json.loads(both.save(tmp_path / "c.json").read_text())
    assert read["peak_load_N"] == {"a": 1234.0, "b": 1234.0, "difference": 0.0}
    with Image.open(both.save(tmp_path / "c.png")) as picture:
        assert min(picture.size) > 300
    for name in ("c.xyz", "c"):
        with pytest.raises(InputError, match=r"csv, \.json, "):
            both.save(tmp_path / name)
    assert {path.name for path in tmp_path.iterdir()} == {"c.csv", "c.json", "c.png"}


def test_what_is_checked_in_a_notebook() -> None:
    report = CheckReport("<b>", "law", "none", 1, 2, 3, 4, 6.0, 7.0, {}, 8.0, (("gauge", "50"),))
    words = Page(report._repr_html_()).words
    assert "<b>" in words
    assert "b" not in Page(report._repr_html_()).tags
    assert repr(report).startswith("case ")


def test_page_without_steps_or_with_a_picture_that_fails(result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    assert "img" not in Page(Recorder(simulation(), None).finish("stopped")._repr_html_()).tags

    def fails(result: Result) -> Any:
        raise InputError("output.measured", "is missing")

    monkeypatch.setattr("fissura.pictures.html.curve_figure", fails)
    assert "img" not in Page(result._repr_html_()).tags
