import numpy as np
import pytest
from matplotlib.image import imread

from fissura.study.definition import Study
from fissura.study.indicators import INDICATORS
from fissura.study.measures import Measures
from fissura.study.pictures import draw, few
from fissura.study.report import markdown
from fissura.study.result import StudyResult

PLAN = Study.model_validate(
    {
        "name": "synthetic",
        "specimens": [
            {"name": name, "case": "x.toml", "type": name[:-1]} for name in ("notched1", "notched2", "free1")
        ],
        "variations": [{"name": name} for name in ("default", "cheap", "dear")],
    }
)


def outcome(seeds=6):
    """Errors and savings of three variations: the dear one is right and slow, the cheap one wrong and fast."""
    rng = np.random.default_rng(1)
    found = []
    for variation, size, ratio in (("default", 0.004, 3.0), ("cheap", 0.03, 8.0), ("dear", 0.0005, 1.2)):
        for entry in PLAN.specimens:
            for seed in range(seeds):
                error = size * rng.uniform(0.5, 2.0)
                x = rng.uniform(0.1, 0.25)
                values = {name: error * rng.uniform(10.0, 30.0) for name in INDICATORS}
                found.append(
                    Measures(
                        entry.name,
                        seed,
                        variation,
                        "target",
                        "target",
                        "",
                        "gauge",
                        error,
                        0.9,
                        0.3 * error,
                        -0.5 * error,
                        0.0,
                        0.99,
                        0.995,
                        0.97,
                        x + 0.0002 if seed else 0.2,
                        x,
                        40,
                        500,
                        1500,
                        3,
                        2.0,
                        2.0 * ratio,
                        ratio * rng.uniform(0.9, 1.1),
                        ratio,
                        0.05,
                        0.1,
                        2.0 * error,
                        values | {"balance": 0.0},
                    )
                )
    return StudyResult(PLAN, tuple(found), {entry.name: (seeds, 0) for entry in PLAN.specimens}, ("free1",), 4)


def test_every_picture_is_drawn(tmp_path):
    paths = draw(outcome(), tmp_path)
    assert [path.name for path in paths] == ["tradeoff.png", "errors.png", "indicators.png", "places.png"]
    for path in paths:
        picture = imread(path)[..., :3]
        assert min(picture.shape[:2]) > 300
        assert 0.001 < (picture < 0.9).any(axis=2).mean() < 0.5  # neither empty nor black


def test_nothing_is_drawn_of_nothing(tmp_path):
    assert draw(StudyResult(PLAN, (), {}, (), 0), tmp_path) == []


def test_markdown_has_every_table():
    text = markdown(outcome())
    assert text.startswith("# synthetic\n\n54 adaptive runs, 0 of which did not finish, against 18 runs")
    assert "4 runs are still to be done" in text
    for head in ("## default", "## cheap", "## dear", "## Runs beyond", "### notched: 36 runs", "## Places of cracks"):
        assert head in text
    rows = [line for line in text.splitlines() if line.startswith("| cheap | notched1 |")]
    assert len(rows) == sum("load" in line for line in rows) > 0
    assert "nan" not in text


@pytest.mark.parametrize(("low", "high"), [(0.9, 1.1), (1.0, 8.0), (0.02, 900.0), (4.0, 4.0)])
def test_ticks_of_a_logarithmic_axis(low, high):
    ticks = few(low, high)
    assert 1 <= len(ticks) <= 10
    assert ticks == sorted(ticks)
    assert all(low / 1.2 < tick < 1.2 * high for tick in ticks)
