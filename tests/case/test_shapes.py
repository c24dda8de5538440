"""Shapes, voids, notches and places in case files."""

from __future__ import annotations

import json

import pytest

from changes import replaced
from fissura.case import Notch, Patch, Specimen, case_from_dict
from fissura.errors import InputError

BASE = {
    "specimen": {"size": ["350 mm", "100 mm", "50 mm"]},
    "notch": {"face": "bottom", "position": "175 mm", "depth": "50 mm"},
    "supports": {"type": "clamp", "face": "left"},
    "load": {"face": "top", "at": "175 mm"},
    "material": {"E": "60 GPa", "alpha": 0.29, "f_t": "2.2 MPa", "G_t": "35 J/m^2"},
    "discretization": {"l_f": "10 mm"},
    "control": {"target": "0.1 mm", "type": "displacement"},
}
L_PANEL = [[0, 0], [250, 0], [250, 250], [500, 250], [500, 500], [0, 500]]
TRIANGLE = [[0, 0], [1, 0], [1, 1]]
BOX = {"lower": [0, 0, 0], "upper": [1, 1, 1]}
ENDS = {"start": [0, 0, 0], "end": [1, 0, 0]}
LINE = [[0, 0, 0], [1, 1, 1]]
HOLE = {"cylinder": {"diameter": "60 mm", "through": [0, 0, 0]}}


def case_with(**tables):
    return case_from_dict(replaced(BASE, tables))


def error_of(**tables):
    with pytest.raises(InputError) as caught:
        case_with(**tables)
    return caught.value


# --- units -----------------------------------------------------------------------------------------------------------


def test_units_once_per_table_or_per_value():
    """The same bits either way; texts keep their own unit."""
    once = Specimen(size=[350, "10 cm", 50], unit="mm")
    assert once == Specimen(size=["350 mm", "100 mm", "50 mm"])
    assert once.size == (0.35, 0.1, 0.05)
    outline = Specimen(outline=[[0, 0], [250, 0], {"to": [250, 35], "radius": -20}], thickness=100, unit="mm")
    assert outline.outline[2].to == (0.25, 0.035)
    assert outline.outline[2].radius == -0.02
    assert outline.thickness == 0.1
    notch = Notch(on="top", at=[200, 100, 50], depth=50, width="5 mm", along=[1, 0, -1], unit="mm")
    assert notch.at == (0.2, 0.1, 0.05)
    assert (notch.depth, notch.width) == (0.05, 0.005)
    assert notch.along == pytest.approx((0.5**0.5, 0, -(0.5**0.5)))
    place = Patch(face="top", at=35, width=10, unit="mm")
    assert (place.at, place.width) == (0.035, 0.01)
    assert Patch(on="top", box={"lower": [0, 0, 0], "upper": [1, 2, 3]}, unit="cm").box.upper == (0.01, 0.02, 0.03)
    void = case_with(minus={"cylinder": {"diameter": 60, "through": [1, 2, 3]}, "unit": "mm"}).minus[0]
    assert (void.cylinder.diameter, void.cylinder.through) == (0.06, (0.001, 0.002, 0.003))


@pytest.mark.parametrize("unit", ["kg", "", 1, "mm^2", True])
@pytest.mark.parametrize("table", ["specimen", "notch", "load"])
def test_units_that_are_none(table, unit):
    error = error_of(**{f"{table}__unit": unit})
    assert error.key == f"{table}.unit"
    assert "mm" in error.allowed


# --- shapes ----------------------------------------------------------------------------------------------------------


def test_shape_is_known_by_its_key():
    assert case_with().specimen.shape == "box"
    assert case_with(specimen={"outline": L_PANEL, "thickness": 100, "unit": "mm"}).specimen.shape == "outline"
    assert case_with(specimen={"cylinder": {"diameter": 1, "length": 2}}).specimen.shape == "cylinder"
    assert case_with(specimen__shape="box").specimen == case_with().specimen


@pytest.mark.parametrize(
    "tables",
    [
        {},
        {"specimen": {"outline": L_PANEL, "thickness": 100, "unit": "mm"}},
        {"specimen": {"outline": L_PANEL, "thickness": 100, "names": list("abcdef"), "unit": "mm"}},
        {"specimen": {"cylinder": {"diameter": "15 cm", "length": 0.3, "axis": "x"}}, "minus": HOLE},
        {"minus": [HOLE, {"box": {"lower": [0, 0, 0], "upper": [1, 1, 1]}, "name": "groove", "unit": "mm"}]},
        {"minus": {"outline": [[0, 0], [1, 0], {"to": [0, 1], "radius": 5}], "unit": "mm"}},
        {"minus": {"outline": {"corners": [[0, 0], [1, 0], [0, 1]], "axis": "y", "lower": 3}, "unit": "mm"}},
        {"notch": {"on": "top", "at": [200, 100, 50], "along": [1, 0, -1], "depth": 50, "width": 5, "unit": "mm"}},
        {"load": {"on": ["top", "right"], "toward": [0, 1, 0], "width": 10, "direction": [0, -1, 0], "unit": "mm"}},
        {"load": {"on": "top", "line": [[0, 0.1, 0], [0.1, 0.1, 0]]}},
        {"load": {"on": "top", "box": {"lower": [0, 0, 0], "upper": [0.1, 0.1, 0]}, "along": "z"}},
    ],
)
def test_cases_are_read_again_from_their_values(tables):
    case = case_with(**tables)
    assert case_from_dict(json.loads(json.dumps(case.model_dump(mode="json")))) == case
    assert case.model_copy(update={"seed": 2}).specimen == case.specimen


def arc(entry):
    return {"specimen": {"outline": [[0, 0], [1, 0], entry], "thickness": 1}}


WRONG = [
    ("specimen.size", {"specimen": {"shape": "box"}}, "outline and thickness"),
    ("specimen.outline", {"specimen__outline": L_PANEL}, "one of size, outline"),
    ("specimen.shape", {"specimen__shape": "sphere"}, "box, cylinder, mesh, outline"),
    ("specimen.shape", {"specimen__shape": "mesh"}, '"box"'),
    ("specimen.thickness", {"specimen": {"outline": L_PANEL}}, "100 mm"),
    ("specimen.thickness", {"specimen": {"outline": L_PANEL, "thickness": 0}}, "positive"),
    ("specimen.thickness", {"specimen__thickness": 1}, "only with outline"),
    ("specimen.names", {"specimen__names": ["a"]}, "only with outline"),
    ("specimen.names", {"specimen": {"outline": L_PANEL, "thickness": 1, "names": ["a"]}}, "one name for each side"),
    ("specimen.names[5]", {"specimen": {"outline": L_PANEL, "thickness": 1, "names": [*"abcde", "notch"]}}, "another"),
    ("specimen.names[0]", {"specimen": {"outline": L_PANEL, "thickness": 1, "names": ["", *"bcdef"]}}, "text of 1"),
    ("specimen.outline", {"specimen": {"outline": [[0, 0], [1, 0]], "thickness": 1}}, "three or more"),
    ("specimen.outline", {"specimen": {"outline": "L", "thickness": 1}}, "a list of corners"),
    ("specimen.outline[1]", {"specimen": {"outline": [[0, 0], [1], [1, 1]], "thickness": 1}}, "a corner [x, y]"),
    ("specimen.outline[1].to[0]", {"specimen": {"outline": [[0, 0], ["x", 1], [1, 1]], "thickness": 1}}, "a length"),
    ("specimen.outline[2].radius", arc({"to": [1, 1], "radius": 0}), "bulges"),
    ("specimen.outline[2].to", arc({"radius": 1}), "two lengths"),
    ("specimen.cylinder.diameter", {"specimen": {"cylinder": {"length": 1}}}, "150 mm"),
    ("specimen.cylinder.axis", {"specimen": {"cylinder": {"diameter": 1, "length": 1, "axis": "r"}}}, '"x"'),
    ("specimen.mesh", {"specimen": {"mesh": "nowhere.msh"}}, "path"),
    ("minus.box", {"minus": {"name": "hole"}}, "cylinder"),
    ("minus.cylinder", {"minus": HOLE | {"box": {"lower": [0, 0, 0], "upper": [1, 1, 1]}}}, "one of box"),
    ("minus.name", {"minus": HOLE | {"name": "notch"}}, "another"),
    ("minus.box.upper", {"minus": {"box": {"lower": [0, 0, 0], "upper": [1, 0, 1]}}}, "above"),
    ("minus.cylinder.through", {"minus": {"cylinder": {"diameter": 1}}}, "start and end"),
    ("minus.cylinder.end", {"minus": {"cylinder": {"diameter": 1, "start": [0, 0, 0]}}}, "three lengths"),
    ("minus.cylinder.end", {"minus": {"cylinder": {"diameter": 1, "start": [0, 0, 0], "end": [0, 0, 0]}}}, "another"),
    ("minus.cylinder.axis", {"minus": {"cylinder": {"diameter": 1, "axis": "x", **ENDS}}}, "through"),
    ("minus.outline.upper", {"minus": {"outline": {"corners": TRIANGLE, "lower": 1, "upper": 0}}}, "more than"),
    ("minus[1].cylinder.diameter", {"minus": [HOLE, {"cylinder": {"diameter": -1, "through": [0, 0, 0]}}]}, "positive"),
    ("notch.position", {"notch": {"depth": 0.05}}, "on and at"),
    ("notch.at", {"notch": {"on": "top", "depth": 0.05}}, "a point of the mouth"),
    ("notch.on", {"notch": {"at": [0, 0, 0], "depth": 0.05}}, "the name of a surface"),
    ("notch.on", {"notch": {"on": "top", "face": "top", "at": [0, 0, 0], "depth": 0.05}}, "either"),
    ("notch.position", {"notch": {"on": "top", "at": [0, 0, 0], "position": 0.1, "depth": 0.05}}, "or at"),
    ("notch.normal", {"notch": {"on": "top", "at": [0, 0, 0], "normal": "x", "depth": 0.05}}, "or at"),
    ("notch.direction", {"notch__direction": [0, 1, 0]}, "only with on and at"),
    ("notch.along", {"notch__along": [0, 0, 1]}, "only with on and at"),
    ("load.face", {"load": {"at": 0.1}}, "the name of a face"),
    ("load.on", {"load__on": "top"}, "either face or on"),
    ("load.on", {"load": {"on": []}}, "a list of names"),
    ("load.line", {"load__line": [[0, 0, 0], [1, 1, 1]]}, "one of at, point"),
    ("load.box", {"load": {"on": "top", "line": LINE, "box": BOX}}, "one of"),
    ("load.width", {"load": {"on": "top", "point": [0, 0, 0], "width": 1}}, "with toward alone"),
    ("load.width", {"load": {"on": "top", "box": BOX, "toward": [0, 1, 0], "width": 1}}, "with toward alone"),
    ("load.line", {"load": {"on": "top", "line": [[0, 0, 0]]}}, "two points"),
    ("load.box.upper", {"load": {"on": "top", "box": {"lower": [0, 0, 0], "upper": [1, -1, 1]}}}, "none below"),
]


@pytest.mark.parametrize(("key", "tables", "allowed"), WRONG, ids=[f"{k}-{i}" for i, (k, _, _) in enumerate(WRONG)])
def test_one_message_names_the_key(key, tables, allowed):
    error = error_of(**tables)
    assert error.key == key
    assert allowed in f"{error.problem} {error.allowed}"


def test_outlines_have_an_end():
    corners = [[0.001 * k, 0.001 * (k % 2)] for k in range(2001)]
    assert "2000" in error_of(specimen={"outline": corners, "thickness": 1}).allowed
