import matplotlib as mpl
import matplotlib.image
import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from fissura.errors import InputError
from fissura.pictures.comparison_files import save_bodies
from fissura.pictures.moments import moments, plot_moments
from fissura.pictures.side_view import COARSE, FINE, HEAT, SideView, look_of
from fissura.pictures.support_symbols import symbols
from fissura.results import Result, compare
from fissura.results.history import read_history
from results.pictured import LOADS, record, share
from results.synthetic import case

mpl.use("Agg")


@pytest.fixture(autouse=True)
def small(monkeypatch):
    monkeypatch.setattr("fissura.pictures.moments.DPI", 60)


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    root = tmp_path_factory.mktemp("runs")
    record(root / "adaptive")
    record(root / "full", full=True)
    return root


def test_moments_of_an_adaptive_run(folders):
    shown = moments(read_history(folders / "adaptive"))
    assert [m.letter for m in shown] == list("abcd")
    assert [m.name for m in shown] == ["before refinement", "first refinement", "peak", "end"]
    assert [m.frame.number for m in shown] == [1, 2, 3, 6]


def test_moments_without_refinement(folders):
    frames = read_history(folders / "full")
    assert [m.name for m in moments(frames)] == ["elastic", "peak", "end"]
    shown = moments(frames[:1] + frames[2:])
    assert [m.frame.number for m in shown] == [2, 3, 6]


@pytest.mark.parametrize(("steps", "numbers"), [(1, [0, 1]), (2, [0, 1, 2]), (3, [1, 2, 3])])
def test_moments_of_short_runs(tmp_path, steps, numbers):
    record(tmp_path, LOADS[:steps])
    shown = moments(read_history(tmp_path))
    assert [m.frame.number for m in shown] == sorted({m.frame.number for m in shown})
    assert [m.frame.number for m in shown][-1] == numbers[-1]
    plot_moments(tmp_path, tmp_path / "moments.png")


def drawn(result, frame, look):
    figure = Figure(figsize=(6, 3))
    canvas = FigureCanvasAgg(figure)
    SideView(figure.add_axes((0, 0, 1, 1)), result.case, look).show(frame)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3] / 255


def test_what_a_stage_shows_changes(folders):
    result, frames = Result.load(folders / "adaptive"), read_history(folders / "adaptive")
    look = look_of(result.case, frames)
    before, torn, coarse_again = (drawn(result, frames[k], look) for k in (0, 5, 6))
    assert share(before, COARSE) > 0.2
    assert share(before, FINE) == 0.0
    assert share(torn, FINE) > 0.2
    assert share(torn, COARSE) == 0.0
    assert share(coarse_again, FINE) == 0.0
    red = ["#" + "".join(f"{round(255 * c):02x}" for c in HEAT(part)[:3]) for part in (0.79, 0.8, 0.81)]
    assert sum(share(before, colour) for colour in red) == 0.0
    assert sum(share(torn, colour) for colour in red) > 1e-3


def test_cracks_are_as_wide_as_the_gap(folders):
    result, frames = Result.load(folders / "adaptive"), read_history(folders / "adaptive")
    look = look_of(result.case, frames, magnify=40.0)
    figure = Figure()
    stage = SideView(figure.add_subplot(), result.case, look)
    stage.show(frames[4])
    quads = np.array([path.vertices[:4] for path in stage._cracks.get_paths()])
    motion = 18e-6 + 1e-7
    assert (quads[:, 3] - quads[:, 0])[:, 1] == pytest.approx(0.0, abs=1e-6)
    assert np.abs(quads[:, 3] - quads[:, 0])[:, 0] == pytest.approx(1e3 * 40.0 * motion, rel=1e-4)


def test_magnification_is_round_and_bounded(folders):
    frames = read_history(folders / "adaptive")
    look = look_of(Result.load(folders / "adaptive").case, frames)
    assert look.magnify in (1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
    assert look.magnify * 50.1e-6 <= 0.045 * 0.02
    assert look_of(Result.load(folders / "adaptive").case, frames[:1]).magnify == 1.0


def test_pictures_of_one_and_of_two_runs(folders, tmp_path):
    plot_moments(folders / "adaptive", tmp_path / "m.png")
    plot_moments(folders / "adaptive", tmp_path / "s.png", stress=True)
    save_bodies(compare(folders / "adaptive", folders / "full"), tmp_path / "b.png")
    sizes, stress, both = (matplotlib.image.imread(tmp_path / f"{name}.png") for name in "msb")
    assert share(sizes, FINE) > 0.05
    assert share(sizes, COARSE) > 0.05
    assert share(stress, FINE) < 0.01 < share(both[:, : both.shape[1] // 2], COARSE)
    assert share(both[: both.shape[0] // 2, both.shape[1] // 2 :], COARSE) < 0.002


def test_runs_in_memory_have_their_section_too(folders, tmp_path):
    result, same = record(None), Result.load(folders / "adaptive")
    assert [frame.number for frame in result.frames] == [frame.number for frame in same.frames]
    for mine, other in zip(result.frames, same.frames, strict=True):
        np.testing.assert_array_equal(mine.motion, other.motion)
        np.testing.assert_array_equal(mine.opening, other.opening)
    save_bodies(compare(result, folders / "full"), tmp_path / "x.png")
    assert share(matplotlib.image.imread(tmp_path / "x.png"), FINE) > 0.05


def test_bodies_at_any_step(folders):
    result = Result.load(folders / "adaptive")
    ax = result.plot_bodies()
    assert ax.get_title(loc="left") == "little beam"
    assert [text.get_text().split(",")[0] for text in ax.texts] == ["step 6"]
    colours = [other.get_ylabel() for other in ax.figure.axes[1:]]
    assert colours == ["crack opening [µm]"]
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["coarse bodies"]
    stress = result.plot_bodies(3, stress=True)
    assert [other.get_ylabel() for other in stress.figure.axes[1:]] == ["largest principal stress [MPa]", colours[0]]
    unloaded = result.plot_bodies(0, ax=pyplot.subplots()[1], magnify=1.0)
    assert (unloaded.get_title(loc="left"), unloaded.figure.axes) == ("", [unloaded])
    with pytest.raises(InputError, match="a whole number from 0 to 6"):
        result.plot_bodies(7)
    with pytest.raises(InputError, match="has no sections"):
        Result(result.case, False, result.curve, result.summary, {}).plot_bodies()
    pyplot.close("all")


def test_symbols_follow_the_case():
    found = symbols(case())
    assert len(found) == 4  # pin, load, two of the gauge
    assert found[0].anchor == pytest.approx([0.002, 0.0])
    assert max(shape[:, 1].max() for shape in found[0].filled) <= 1e-12  # below the bottom
    assert found[1].anchor == pytest.approx([0.01, 0.01])
    assert min(shape[:, 1].min() for shape in found[1].filled) >= 0.01 - 1e-12


@pytest.mark.parametrize(
    ("support", "load", "count"),
    [
        ({"type": "clamp", "face": "left"}, {"face": "right", "direction": [1, 0, 0]}, 4),
        ({"type": "roller", "face": "left", "at": 0.005, "width": 0.002}, {"face": "right"}, 4),
        ({"type": "clamp", "face": "back"}, {"face": "front", "direction": [0, -1, 0]}, 3),
        ({"type": "clamp", "face": "back"}, {"face": "front"}, 2),
    ],
)
def test_symbols_on_other_faces(support, load, count):
    data = case().model_dump(exclude={"source"})
    from fissura.case import case_from_dict

    changed = case_from_dict(data | {"supports": [support], "load": load})
    found = symbols(changed)
    assert len(found) == count
    assert all(np.isfinite(shape).all() for symbol in found for shape in (*symbol.filled, *symbol.lines))
    if load.get("direction") == [1, 0, 0]:  # pulled: arrows point away from the face
        assert max(shape[:, 0].max() for shape in found[1].filled) > 0.02
