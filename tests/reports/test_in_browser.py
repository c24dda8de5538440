"""Pages in a real browser, without a network."""

import hashlib

import numpy as np
import pytest

from fissura.results import Result

from .browsing import WITHOUT_WEBGL, launcher, needs_browser, opened
from .made import NASTY, made
from .unpacking import data_of, dequantised

pytestmark = [pytest.mark.slow, needs_browser]

STEPS = [2, 3, 4, 6]


@pytest.fixture(scope="module")
def run_path(tmp_path_factory):
    place = tmp_path_factory.mktemp("run")
    return made(place / "results").report(place / "report.html")


@pytest.fixture(scope="module")
def browsers():
    with launcher() as found:
        yield found


@pytest.fixture(scope="module")
def started(browsers):
    with browsers() as found:
        yield found


@pytest.fixture
def page(started, run_path):
    with opened(started, run_path) as found:
        yield found


def shown(page, at):
    """Move the slider, and wait until the bodies follow."""
    page.locator("#step").fill(str(at))
    page.wait_for_selector(f'#view[data-step="{STEPS[at]}"]')


def pixels(page):
    """What the 3D view looks like."""
    page.wait_for_timeout(300)
    return hashlib.sha256(page.locator("#view").screenshot()).hexdigest()


def marker(page):
    """Where the marker on the curve stands."""
    return page.evaluate(
        "(() => { const t = document.getElementById('curve').data.at(-1); return [t.x[0], t.y[0]]; })()"
    )


def corners(page, name):
    """Corners that the 3D view draws [mm]."""
    script = f"Array.from(fissura.parts.view.k3d.getWorld().ObjectsListJson[fissura.parts.view.objects.{name}.id]"
    return np.array(page.evaluate(script + ".vertices.data)")).reshape(-1, 3)


def test_the_page_opens_at_the_last_step(page, run_path):
    assert page.title() == "little beam"
    assert page.locator("#step").input_value() == "3"
    assert page.locator("#view").get_attribute("data-step") == "6"
    assert (
        page.locator("#step-told")
        .inner_text()
        .startswith("6 of 6, gauge opening 100 µm, load 434 N, dissipated 6.00 mJ")
    )
    result = Result.load(run_path.parent / "results")
    np.testing.assert_allclose(marker(page), [1e6 * result.gauge[-1], result.load_values[-1]])


def test_the_slider_moves_marker_and_bodies(page, run_path):
    curve = data_of(run_path.read_text())["curve"]
    x, y = (next(c["values"] for c in curve["columns"] if c["name"] == curve[axis]) for axis in ("x", "y"))
    looks = set()
    for at, step in enumerate(STEPS):
        shown(page, at)
        np.testing.assert_allclose(marker(page), [x[step], y[step]])
        assert page.locator("#step-told").inner_text().startswith(f"{step} of 6,")
        looks.add(pixels(page))
    assert len(looks) == len(STEPS)


def test_a_click_on_the_curve_moves_the_slider(page):
    dots = page.locator("#curve .scatterlayer .trace").nth(1).locator(".point")
    assert dots.count() == len(STEPS)
    dots.nth(1).click(force=True)
    page.wait_for_selector('#view[data-step="3"]')
    assert page.locator("#step").input_value() == "1"
    # A step that is not recorded leads to the nearest one that is.
    page.locator("#curve .scatterlayer .trace").nth(0).locator(".point").nth(1).click(force=True)
    page.wait_for_selector('#view[data-step="2"]')
    assert page.locator("#step").input_value() == "0"


def test_any_column_over_any_other(page, run_path):
    columns = data_of(run_path.read_text())["curve"]["columns"]
    options = page.locator("#curve-y option").all_inner_texts()
    assert options == [column["title"] for column in columns]
    page.select_option("#curve-x", "step")
    page.select_option("#curve-y", "dissipated_J")
    assert page.locator("#curve .xtitle").text_content() == "step"
    assert page.locator("#curve .ytitle").text_content() == "dissipated [mJ]"
    np.testing.assert_allclose(marker(page), [6, 6.0])
    shown(page, 0)
    np.testing.assert_allclose(marker(page), [2, 2.0])


@pytest.mark.parametrize("share", [0.0, 1.0, 2.5])
def test_the_scale_of_displacements(page, run_path, share):
    scene = data_of(run_path.read_text())["scene"]
    skin = scene["states"][-1]["skin"]
    at, by = (np.stack([dequantised(axis) for axis in skin[name]], axis=1) for name in ("points", "moved"))
    page.locator("#view-magnify").fill(str(share))
    told = page.locator("#view-magnify-told").inner_text()
    assert float(told.removeprefix("× ")) == share * scene["magnify"]
    expected = at + share * scene["magnify"] * by
    page.wait_for_function("fissura.parts.view.turn.then(() => true)")
    np.testing.assert_allclose(corners(page, "skin"), expected, atol=1e-4)
    np.testing.assert_allclose(corners(page, "edges"), expected, atol=1e-4)


def test_cracks_narrower_than_wanted_are_hidden(page, run_path):
    cracks = data_of(run_path.read_text())["scene"]["states"][0]["cracks"]
    shown(page, 0)
    assert len(corners(page, "cracks")) == cracks["sizes"].sum()
    page.locator("#view-wide").fill("0.9")  # 81 % of 12 µm, and all are 4 µm wide
    page.wait_for_function("fissura.parts.view.turn.then(() => true)")
    assert page.evaluate("fissura.parts.view.k3d.getObjectById(fissura.parts.view.objects.cracks.id)") is None


@pytest.mark.parametrize(
    ("selector", "value", "legend"),
    [
        ("#view-bodies", "stress", "largest principal stress: 0"),
        ("#view-cracks", "damage", "damage: 0"),
        ("#view-cut", "0", None),
        ("#view-cut", "2", None),
    ],
)
def test_colours_and_cuts(page, selector, value, legend):
    before = pixels(page)
    page.select_option(selector, value)
    page.wait_for_function("fissura.parts.view.turn.then(() => true)")
    after = pixels(page)
    assert after != before
    if legend is not None:
        assert legend in page.locator("#view-colours").inner_text()
        return
    page.locator("#view-at").fill("0.25")
    assert page.locator("#view-at-told").inner_text() == {"0": "x = 5.00 mm", "2": "z = 2.50 mm"}[value]
    nearer = pixels(page)
    page.locator("#view-other").check()
    assert len({after, nearer, pixels(page)}) == 3
    page.select_option(selector, "")
    assert pixels(page) == before


def test_opacity_signs_scales_and_first_view(page):
    camera = "fissura.parts.view.k3d.getWorld().camera.position.toArray()"
    looks, first = [pixels(page)], page.evaluate(camera)
    page.locator("#view-opacity").fill("1")
    looks.append(pixels(page))
    page.locator("#view-signs").uncheck()
    looks.append(pixels(page))
    page.locator("#view-grid").check()
    looks.append(pixels(page))
    box = page.locator("#view").bounding_box()
    page.mouse.move(box["x"] + 200, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 300, box["y"] + 230, steps=5)
    page.mouse.up()
    looks.append(pixels(page))
    assert len(set(looks)) == 5
    assert not np.allclose(page.evaluate(camera), first, rtol=1e-2)
    page.locator("#view-reset").click()
    np.testing.assert_allclose(page.evaluate(camera), first, rtol=1e-6)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 400])
def test_widths_and_schemes(started, run_path, width, scheme):
    with opened(started, run_path, width=width, scheme=scheme) as page:
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        back = page.evaluate("getComputedStyle(document.body).backgroundColor")
        assert back == {"light": "rgb(255, 255, 255)", "dark": "rgb(22, 25, 29)"}[scheme]
        assert page.evaluate("getComputedStyle(document.querySelector('#view')).backgroundColor") == back
        other = {"light": "dark", "dark": "light"}[scheme]
        page.emulate_media(color_scheme=other)
        # The 3D view follows, too.
        colour = "getComputedStyle(document.querySelector('#view')).backgroundColor"
        page.wait_for_function(f"{colour} !== {back!r}", timeout=30_000)
        assert page.evaluate(colour) == page.evaluate("getComputedStyle(document.body).backgroundColor")


def test_signs_of_html_in_text_do_no_harm(started, tmp_path):
    result = made(None, name=NASTY)
    result.summary["warnings"] = [f"material.E: {NASTY}"]
    for name in ("gauge_<img src=x onerror=alert(2)>_m", "force_</script><script>alert(3)</script>_N"):
        result.curve[name] = result.curve["gauge_m"]
    with opened(started, result.report(tmp_path / "a.html")) as page:
        assert page.title() == NASTY
        assert page.locator("h1").inner_text() == NASTY
        assert NASTY in page.locator(".warnings li").inner_text()
        page.select_option("#curve-y", "gauge_<img src=x onerror=alert(2)>_m")
        page.wait_for_timeout(300)
        assert page.locator("#curve .ytitle").text_content() == "gauge <img src=x onerror=alert(2)> [µm]"
        assert page.locator("img").count() == 0


def test_a_browser_without_webgl_still_shows_the_curve(browsers, run_path):
    with browsers(*WITHOUT_WEBGL) as found, opened(found, run_path) as page:
        assert "3D view cannot be shown" in page.locator("#view").inner_text()
        page.locator("#step").fill("0")
        assert page.locator("#step-told").inner_text().startswith("2 of 6,")
        page.problems[:] = [text for text in page.problems if "WebGL" not in text]


def test_a_run_without_states(started, tmp_path):
    made(tmp_path, vtk=0)
    (tmp_path / "state_last.npz").unlink()
    for path in tmp_path.glob("*.vtu"):
        path.unlink()
    with opened(started, Result.load(tmp_path).report()) as page:
        assert page.locator("#step").get_attribute("max") == "5"
        page.locator("#step").fill("2")
        assert page.locator("#step-told").inner_text().startswith("3 of 6,")
        before = pixels(page)
        page.select_option("#view-cut", "0")
        assert pixels(page) != before


def test_a_run_without_steps(started, tmp_path):
    made(tmp_path, count=0, status="stopped")
    path = Result.load(tmp_path).report()
    context = started.new_context(offline=True)
    page = context.new_page()
    page.goto(path.as_uri())
    assert "The run has no steps." in page.inner_text("main")
    context.close()
