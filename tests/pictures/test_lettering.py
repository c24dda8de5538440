import pytest
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fissura.pictures.crack import plot_crack
from fissura.pictures.curves import headline, plot_curve
from fissura.pictures.lettering import GAP, SMALLEST, fit, legend_below, literal, may_shrink, rendered, save
from fissura.results import compare_results
from fissura.running.recorder import Recorder
from results.synthetic import case, simulation, steps

AWKWARD = [
    "run_$SEED",
    "$x^2",
    "a $ b $ c",
    r"\alpha \$ $\frac{1}$",
    "100 % #1 & {x} ~ ^ _",
    "$$",
    "<b>&amp;</b>",
    "日本",
]


@pytest.mark.parametrize("name", AWKWARD)
def test_text_of_users_is_drawn_letter_by_letter(name):
    figure = Figure()
    text = figure.text(0.0, 0.5, literal(name))
    assert text._preprocess_math(text.get_text()) == (name, False)
    rendered(figure, form="svg", dpi=50)


def test_control_characters_and_halves_of_letters_are_blanks_and_marks():
    assert literal("a\nb\x1b[1m\udcff") == "a b [1m?"


@pytest.mark.parametrize("latex", [False, True])
def test_every_picture_of_a_run_takes_every_name(tmp_path, latex):
    run = simulation()
    run.case = case().model_copy(update={"name": "run_$SEED, $x^2 and 100 % #1"})
    recorder = Recorder(run, None)
    for taken in steps([1.0, 2.0]):
        recorder.add(taken)
    result = recorder.finish("finished")
    with rc_context({"text.usetex": latex}):
        plot_curve(result, tmp_path / "curve.png")
        plot_crack(result, tmp_path / "crack.png")
        compare_results(result, result).save(tmp_path / "compare.png")
    assert len(list(tmp_path.iterdir())) == 3


def test_a_long_name_ends_at_the_edge_and_keeps_its_ends():
    figure = Figure(figsize=(7.2, 4.6), layout="constrained")
    axes = figure.add_subplot()
    name = "first_" + 40 * "long_" + "last"
    headline(axes, name, "note")
    fit(figure)
    title = axes._left_title
    assert title.get_window_extent().x1 <= figure.bbox.x1
    assert title.get_fontsize() == SMALLEST
    head, tail = title.get_text().split("…")
    assert name.startswith(head)
    assert name.endswith(tail)
    assert len(head + tail) > 70


def test_a_name_that_fits_stays_as_it_is():
    figure = Figure(figsize=(7.2, 4.6), layout="constrained")
    axes = figure.add_subplot()
    headline(axes, "beam", "note")
    fit(figure)
    assert (axes._left_title.get_text(), axes._left_title.get_fontsize()) == ("beam", 11.0)


def test_names_side_by_side_do_not_meet():
    figure = Figure(figsize=(8.0, 4.0), layout="constrained")
    panels = figure.subplots(1, 2)
    for axes in panels:
        headline(axes, 12 * "$specimen$ ", "note")
    fit(figure)
    first, second = (axes._left_title.get_window_extent() for axes in panels)
    assert first.x1 + 0.9 * GAP * figure.dpi / 72 <= second.x0
    assert second.x1 <= figure.bbox.x1
    # The layout is that of short names.
    assert panels[0].get_position().width == pytest.approx(panels[1].get_position().width, rel=0.05)
    assert panels[0].get_position().width > 0.35


def test_a_line_of_several_rows_is_fitted_row_by_row():
    figure = Figure(figsize=(4.0, 4.0))
    text = may_shrink(figure.suptitle("short\n" + 40 * "wide ", x=0.01, ha="left"))
    fit(figure)
    rows = text.get_text().split("\n")
    assert rows[0] == "short"
    assert "…" in rows[1]
    assert text.get_window_extent().x1 <= figure.bbox.x1


def test_a_legend_has_as_many_columns_as_fit_and_every_name():
    for length, columns in ((4, 4), (60, 1)):
        figure = Figure(figsize=(8.0, 6.0), layout="constrained")
        figure.add_subplot()
        names = [f"_{k}" + (length - 2) * "m" for k in range(5)]
        legend = legend_below(figure, [(Line2D([], []), name) for name in names], colour="black")
        figure.draw_without_rendering()
        assert legend._ncols == columns
        assert [text.get_text() for text in legend.get_texts()] == names
        assert legend.get_window_extent().x0 >= 0
        assert legend.get_window_extent().x1 <= figure.bbox.x1


def test_an_ending_that_is_not_known_leaves_no_file(tmp_path):
    with pytest.raises(ValueError, match="abc"):
        save(Figure(), tmp_path / "x.abc", 50)
    assert list(tmp_path.iterdir()) == []
    save(Figure(), tmp_path / "x.PNG", 50)
    assert (tmp_path / "x.PNG").read_bytes().startswith(b"\x89PNG")
