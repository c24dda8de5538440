"""Loading programmes of case files: what is refused, by which key, and what steps are left to a stage itself."""

import pytest

from conftest import small_beam
from fissura.api.stages import stages_in_words
from fissura.case.plausible import case_notices
from fissura.errors import InputError
from fissura.simulation.loop import Simulation

A, B = {"face": "top", "at": 0.04}, {"face": "top", "at": 0.07}
TWO = {"load": None, "loads": {"left": A, "right": B}}
ENDS = {"a": {"face": "bottom", "at": 0.055}, "b": {"face": "bottom", "at": 0.065}}
OTHER = {"a": {"face": "bottom", "at": 0.05}, "b": {"face": "bottom", "at": 0.07}}
BACKWARD = {"a": ENDS["b"], "b": ENDS["a"], "direction": [1.0, 0.0, 0.0]}


HALVES = {"left": 0.5, "right": 0.5}


def programme(*tables, **changes):
    return small_beam(**{"control": None, "stage": list(tables)} | changes)


def stage(**keys):
    return {"to": "20 um"} | keys


#: Key, what the tables say, and words of the message.
WRONG = [
    ("stage[0].load", (stage(load="lefft"),), TWO, "one of left, right"),
    ("stage[0].load", (stage(load={"left": 0.5, "rihgt": 0.5}),), TWO, '"rihgt" is no load'),
    ("stage[0].load", (stage(),), TWO, "there are several loads"),
    ("stage[0].load", (stage(load=["left", "right"]),), TWO, "neither a name nor a table"),
    ("stage[0].load.left", (stage(load={"left": 0, "right": 1}),), TWO, "0 is no ratio"),
    ("stage[0].load.left", (stage(load={"left": "5 kN"}),), TWO, "not a plain number"),
    ("stage[0].load", (stage(load="gravity"),), {}, r"no \[gravity\]"),
    ("stage[0].gauge", (stage(),), {"gauge": None}, "missing"),
    ("stage[0].gauge", (stage(gauge="cmood"),), {}, '"cmood" is no gauge'),
    ("stage[0].gauge", (stage(),), {"gauge": None, "gauges": {"a": ENDS, "b": OTHER}}, "one of a, b"),
    ("stage[0].control", (stage(control="cmod"),), {}, '"force"'),
    ("stage[0].to", (stage(to="20 kN"),), {}, "not a length"),
    ("stage[0].to", (stage(control="force"),), {}, "not a force"),
    ("stage[0].to", (stage(to=[]),), {}, "the list is empty"),
    ("stage[0].to", ({"control": "gauge"},), {}, "missing"),
    ("stage[0].to", (stage(to="5 % of load"),), {}, "a value first"),
    ("stage[1].to", (stage(load="left"), {"load": "right", "to": "5 % of load"}), TWO, "zero there"),
    ("stage[1].to", (stage(load="left"), {"load": HALVES, "to": "5 % of load"}), TWO, "in these ratios"),
    ("stage[0].to", (stage(to="0 um"),), {}, "already"),
    ("stage[0].to[1]", (stage(to=["20 um", "5 %"]),), {}, '"5 % of load"'),
    ("stage[0].to[1]", (stage(to=["20 um", "20 um"]),), {}, "the target before it"),
    ("stage[0].target", ({"target": "20 um"},), {}, r"did you mean stage\[0\].to\?"),
    ("stage[0].type", (stage(type="force"),), {}, r"did you mean stage\[0\].control\?"),
    ("stage[0].max_step", (stage(max_step="1 mm"),), {}, "longest way"),
    ("stage[0].max_step", (stage(max_step="10 N"),), {}, "not a length"),
    ("stage[1].max_step", (stage(), {"to": "5 % of load", "max_step": "1 um"}), {}, "no target is a value"),
    ("control", (stage(),), {"control": {"target": 2e-5}}, "together with"),
    ("control", (), {}, r"tables \[\[stage\]\]"),
    ("stages", (), {"stages": [stage()]}, "did you mean stage?"),
    ("load", (stage(),), {"load": None}, r"\[loads.NAME\]"),
    ("loads", (stage(),), {"load": None, "loads": A}, "tables with names"),
    ("loads", (stage(),), {"load": None, "loads": [A, B]}, r"\[loads.left\]"),
    ("gauges", (stage(),), {"gauge": None, "gauges": "top"}, r"one without a name is \[gauge\]"),
    ("loads.gravity", (stage(),), {"loads": {"gravity": A}}, "own weight"),
    ('loads."my load"', (stage(),), {"loads": {"my load": A}}, "letters, digits"),
    ("loads.load", (stage(),), {"loads": {"load": A}}, "another name"),
    ("loads", (), TWO | {"control": {"target": 2e-5}}, "which one it applies"),
    ("gravity.density", (stage(),), {"gravity": {}}, "2400 kg/m"),
    ("gravity.density", (stage(),), {"gravity": {"density": "24 kN/m^3"}}, "measures something else"),
    ("gravity", (stage(),), {"gravity": True}, "not a table"),
]


@pytest.mark.parametrize(("key", "tables", "changes", "words"), WRONG, ids=[f"{k} {w[0]}" for k, w in enumerate(WRONG)])
def test_one_message_names_the_key(key, tables, changes, words):
    with pytest.raises(InputError, match=words) as caught:
        programme(*tables, **changes)
    assert caught.value.key == key
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "tables",
    [
        (stage(load=HALVES), {"load": "right", "to": "5 % of load"}),
        (stage(load=HALVES), {"load": {"right": 1, "left": 1}, "to": "5 % of load"}),
        (stage(load="left"), stage(load="right"), {"load": "left", "to": "50 % of peak"}),
    ],
)
def test_shares_of_loads_that_are_there(tables):
    assert len(programme(*tables, **TWO).stages) == len(tables)


def test_a_density_without_its_unit_looks_wrong():
    (notice,) = case_notices(programme(stage(), gravity={"density": 2.4}))
    assert notice.key == "gravity.density"
    assert not case_notices(programme(stage(), gravity={"density": 2400.0}))


@pytest.mark.parametrize(
    ("to", "keys", "steps"),
    [
        ("0 um", {}, "50 or more, each at most a fiftieth of its way"),
        ("0 um", {"max_step": "5 um"}, "4 or more, each at most 5 µm"),
        ("5 % of load", {}, "10 or more, each at most a tenth of its way"),
        (["5 % of load", "30 um"], {}, "11 or more, each at most 0.6 µm"),
    ],
)
def test_ways_that_are_known_when_they_begin(to, keys, steps):
    """Unloading in a stage of its own."""
    case = programme(stage(), {"to": to} | keys)
    assert stages_in_words(case, 1.0)[1][1] == steps


def test_unloading_in_a_stage_of_its_own():
    steps = list(Simulation(programme(stage(), {"to": "0 um"}, stage(to="10 um"))).steps())
    down = [s for s in steps if s.stage == 2]
    assert 50 <= len(down) <= 60
    assert down[-1].gauge == 0.0
    assert steps[-1].gauge == 10e-6
    assert max(s.dissipated for s in down) == pytest.approx(down[0].dissipated, rel=1e-6)


@pytest.mark.parametrize(
    ("tables", "key"),
    [
        ((stage(gauge="back"),), "gauges.back.direction"),
        ((stage(gauge="back"), stage(gauge="gauge")), "stage[0].gauge"),
    ],
)
def test_a_gauge_that_gets_smaller_does_not_grow(tables, key):
    case = programme(*tables, gauges={"back": BACKWARD})
    with pytest.raises(InputError, match="under a negative load") as caught:
        Simulation(case).start()
    assert caught.value.key == key
