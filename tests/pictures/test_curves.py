import matplotlib.image
import numpy as np
import pytest
from matplotlib.colors import to_rgb

from fissura.errors import InputError
from fissura.pictures import curves as pictures
from fissura.pictures.curves import plot_curve
from fissura.results import compare_results
from fissura.running.recorder import Recorder
from results.synthetic import simulation, snapping, step


def run(loads, refinements=0, **output):
    recorder = Recorder(simulation(**output), None)
    for k, load in enumerate(loads, 1):
        recorder.add(step(k, 1e-5 * k, load, refinements=refinements))
    return recorder.finish("finished")


def shares(path):
    """Part of the picture that each colour of the palette covers."""
    pixels = matplotlib.image.imread(path)[..., :3]
    return {
        name: np.mean(np.abs(pixels - to_rgb(getattr(pictures, name))).max(axis=-1) < 0.02)
        for name in ("BLUE", "LIGHT", "ORANGE")
    } | {"grey": np.mean(np.ptp(pixels, axis=-1) < 0.04) - np.mean(pixels.min(axis=-1) > 0.99)}


def test_curve_and_refinements_are_drawn(tmp_path):
    for name, refinements in (("plain", 0), ("refined", 1)):
        plot_curve(run([100.0, 200.0, 150.0], refinements), tmp_path / f"{name}.png")
    plain, refined = shares(tmp_path / "plain.png"), shares(tmp_path / "refined.png")
    assert plain["BLUE"] > 1e-3
    assert plain["ORANGE"] == plain["LIGHT"] == 0
    assert refined["ORANGE"] > 1e-4


def test_measured_band_is_drawn(tmp_path):
    band = tmp_path / "band.csv"
    band.write_text("0.0,0,0\n0.01,50,180\n0.04,20,150\n")
    plot_curve(run([100.0, 200.0, 150.0]), tmp_path / "without.png")
    plot_curve(run([100.0, 200.0, 150.0], measured=str(band)), tmp_path / "with.png")
    assert shares(tmp_path / "with.png")["grey"] > shares(tmp_path / "without.png")["grey"] + 0.1


def test_missing_band_is_an_error(tmp_path):
    band = tmp_path / "band.csv"
    band.write_text("0.01,1,2\n")
    result = run([1.0], measured=str(band))
    band.unlink()
    with pytest.raises(InputError, match=r"output\.measured"):
        plot_curve(result, tmp_path / "curve.png")


@pytest.mark.parametrize("loads", [[1.0], [-3.0, -5.0], [0.0], [2e6, 1e6]])
def test_unusual_curves(tmp_path, loads):
    plot_curve(run(loads), tmp_path / "curve.png")
    assert matplotlib.image.imread(tmp_path / "curve.png").shape == (736, 1152, 4)


def drawn(monkeypatch, draw):
    """Axes of the picture that a function draws."""
    figures = []
    monkeypatch.setattr(pictures.Figure, "savefig", lambda figure, *_, **__: figures.append(figure))
    draw()
    return figures[0].axes


def snapped(control=None):
    recorder = Recorder(simulation(control, vtk=0), None)
    for taken in snapping():
        recorder.add(taken)
    return recorder.finish("finished")


def test_a_curve_that_turns_back_is_seen_as_a_whole(tmp_path, monkeypatch):
    plot_curve(snapped(), tmp_path / "curve.png")
    assert shares(tmp_path / "curve.png")["LIGHT"] > 1e-5
    (axes,) = drawn(monkeypatch, lambda: plot_curve(snapped(), tmp_path / "curve.png"))
    assert axes.get_xlim() == pytest.approx((0.0, 1.02 * 30))
    assert axes.get_xlabel() == "gauge opening [µm]"
    assert [entry.get_text() for entry in axes.get_legend().get_texts()] == ["computed steps", "dissipation control"]


def test_the_axis_names_the_quantity(tmp_path, monkeypatch):
    for control, name in (("displacement", "displacement of the load"), ("dissipation", "gauge opening")):
        result = snapped({"type": control})
        (axes,) = drawn(monkeypatch, lambda result=result: plot_curve(result, tmp_path / "curve.png"))
        assert axes.get_xlabel() == f"{name} [µm]"
        monkeypatch.undo()


def test_measured_loads_are_drawn_over_the_gauge(tmp_path, monkeypatch):
    """The columns of gauge and displacement differ by a factor of two here."""
    (tmp_path / "band.csv").write_text("0.001,50,100\n0.03,100,200\n")
    for more, name, end in (({}, "displacement of the load", 15), ({"measured": tmp_path / "band.csv"}, "gauge", 30)):
        recorder = Recorder(simulation({"type": "displacement"}, vtk=0, **more), None)
        for taken in snapping():
            recorder.add(taken)
        result = recorder.finish("finished")
        (axes,) = drawn(monkeypatch, lambda result=result: plot_curve(result, tmp_path / "curve.png"))
        assert axes.get_xlabel().startswith(name)
        assert axes.get_xlim() == pytest.approx((0.0, 1.02 * end))
        monkeypatch.undo()


def test_comparison_over_energy(tmp_path, monkeypatch):
    comparison = compare_results(snapped(), snapped())
    upper, lower = drawn(monkeypatch, lambda: comparison.save(tmp_path / "compare.png"))
    assert upper.get_xlabel() == "gauge opening [µm]"
    assert lower.get_xlabel() == "dissipated energy [mJ]"
    assert upper.get_xlim()[1] > 30 > 6 > lower.get_xlim()[1]


def test_comparison(tmp_path):
    a, b = run([100.0, 190.0, 150.0]), run([100.0, 200.0, 150.0, 140.0])
    compare_results(a, b).save(tmp_path / "compare.png")
    assert shares(tmp_path / "compare.png")["BLUE"] > 1e-3
