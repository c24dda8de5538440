"""Parts thinner than bodies are refused or warned of, from case files; so are forces at edges."""

from __future__ import annotations

import pytest

from fissura.errors import InputError
from fissura.specimen import domain_from_case, edge_notices, thin_notices, thin_parts

#: Of the small beam, 120 x 60 x 40 mm with a notch of 30 mm.
L_F = 0.008


def warnings(case):
    domain = domain_from_case(case)
    found = thin_notices(thin_parts(case, domain), case.discretization.l_f)
    return [*found, *edge_notices(case, domain)]


TOP = {"face": "top", "position": 0.06}


def notches(top):
    """A second notch, opposite to that of the small beam."""
    return {"notch": [{"position": 0.06, "depth": 0.03}, TOP | {"depth": top}], "load__at": 0.07}


def near_end(position):
    gauge = {"a": {"face": "bottom", "at": position - 0.002}, "b": {"face": "bottom", "at": position + 0.002}}
    supports = [{"type": "pin", "face": "bottom", "at": 0.05}, {"type": "roller", "face": "bottom", "at": 0.11}]
    return {"notch__position": position, "gauge": gauge, "supports": supports, "load__at": 0.08}


REFUSED = {
    "thickness": ({"specimen__size": [0.12, 0.06, 0.0079]}, "specimen.size"),
    "depth": ({"specimen__size": [0.12, 0.0079, 0.06], "notch": None}, "specimen.size"),
    "spacing in m": ({"discretization": {"l_f": 10}}, "discretization.l_f"),
    "ligament": ({"notch__depth": 0.0521}, "notch.depth"),
    "1 mm of ligament": ({"notch__depth": 0.059}, "notch.depth"),
    "ligament below a saw cut": ({"notch__depth": 0.0521, "notch__width": 0.004}, "notch.depth"),
    "ligament between notches": (notches(0.0221), "notch[1].depth"),
    "notch at the end": (near_end(0.0079), "notch.position"),
    "saw cut at the end": (near_end(0.0089) | {"notch__width": 0.002}, "notch.position"),
    "notches side by side": (
        {"notch": [{"position": 0.06, "depth": 0.03}, {"position": 0.0679, "depth": 0.02}]},
        "notch[1].position",
    ),
}

WARNED = {
    "thickness": ({"specimen__size": [0.12, 0.06, L_F]}, ["specimen.size"]),
    "2.9 of thickness": ({"specimen__size": [0.12, 0.06, 2.9 * L_F]}, ["specimen.size"]),
    "3 of thickness": ({"specimen__size": [0.12, 0.06, 3 * L_F]}, []),
    "ligament": ({"notch__depth": 0.06 - L_F}, ["notch.depth"]),
    "2.9 of ligament": ({"notch__depth": 0.06 - 2.9 * L_F}, ["notch.depth"]),
    "3 of ligament": ({"notch__depth": 0.06 - 3 * L_F}, []),
    "ligament between notches": (notches(0.03 - 2.9 * L_F), ["notch[1].depth"]),
    "3 between notches": (notches(0.03 - 3 * L_F), []),
    "notch near the end": (near_end(2.9 * L_F), ["notch.position"]),
    "notch 3 from the end": (near_end(3 * L_F), []),
}


@pytest.mark.parametrize(("changes", "key"), REFUSED.values(), ids=REFUSED)
def test_thinner_than_a_body_is_refused(small_case, changes, key):
    with pytest.raises(InputError, match=r"less than one body|larger than the specimen") as caught:
        warnings(small_case(**changes))
    assert caught.value.key == key


@pytest.mark.parametrize(("changes", "keys"), WARNED.values(), ids=WARNED)
def test_thinner_than_three_bodies_is_warned_of(small_case, changes, keys):
    assert [notice.key for notice in warnings(small_case(**changes))] == keys


def test_what_is_said(small_case):
    (notice,) = warnings(small_case(notch__depth=0.045))
    assert str(notice) == (
        "notch.depth: the ligament is 15 mm thick, 1.9 l_f: so few bodies across it leave it too soft, by up to a half"
        " in twist and at notches (what to do: discretization.l_f of at most 5 mm)"
    )
    (notice,) = warnings(small_case(notch__depth=0.05))
    assert "single facets may span it, which are hinges" in notice.problem


INSIDE = {"type": "roller", "face": "bottom", "at": 0.11}
EDGES = {
    "support at the end": ({"supports__0__at": 0.0079}, ["supports[0].at"]),
    "support at the very end": ({"supports__1__at": 0.12}, ["supports[1].at"]),
    "one body inside": ({"supports__0__at": L_F}, []),
    "load beside the mouth of a notch": (
        {"load": {"face": "bottom", "at": 0.053, "direction": [0, 1, 0]}},
        ["load.at"],
    ),
    "load beside a saw cut": (
        {"load": {"face": "bottom", "at": 0.051, "direction": [0, 1, 0]}, "notch__width": 0.003},
        ["load.at"],
    ),
    "point near an edge": ({"load": {"face": "top", "point": [0.06, 0.06, 0.039]}}, ["load.point"]),
    "point inside": ({"load": {"face": "top", "point": [0.06, 0.06, 0.02]}}, []),
    "load over a notch on the other face": ({"load__at": 0.06}, []),
    "whole face": ({"supports": [{"type": "clamp", "face": "left"}]}, []),
    "gauge": ({"gauge__a__at": 0.059}, []),
}


@pytest.mark.parametrize(("changes", "keys"), EDGES.values(), ids=EDGES)
def test_forces_at_edges_are_warned_of(small_case, changes, keys):
    assert [notice.key for notice in warnings(small_case(**changes))] == keys


# --- other shapes ----------------------------------------------------------------------------------------------------

DISC = {"cylinder": {"diameter": 0.1, "length": 0.05}}
FIN = [[0, 0], [100, 0], [100, 50], [53, 50], [53, 100], [50, 100], [50, 50], [0, 50]]


def bore(x, diameter=0.02):
    return {"minus": {"cylinder": {"diameter": diameter, "through": [x, 0.0, 0.0]}, "name": "hole"}}


SHAPES = {
    "fin": ({"specimen": {"outline": FIN, "thickness": 50, "unit": "mm"}}, "specimen.outline", 0.003),
    "thin disc": ({"specimen": {"cylinder": {"diameter": 0.1, "length": 0.004}}}, "specimen.cylinder", 0.004),
    "thin bar": ({"specimen": {"cylinder": {"diameter": 0.006, "length": 0.1}}}, "specimen.cylinder", 0.006),
    "wall beside a hole": ({"specimen": DISC, **bore(0.036)}, "minus", 0.004),
    "tube": ({"specimen": DISC, **bore(0.0, 0.092)}, "minus", 0.004),
    "above a blind hole": (
        {"minus": {"cylinder": {"diameter": 0.03, "start": [0.06, -0.1, 0.02], "end": [0.06, 0.055, 0.02]}}},
        "minus",
        0.005,
    ),
}


@pytest.mark.parametrize(("changes", "key", "thickness"), SHAPES.values(), ids=SHAPES)
def test_thin_parts_of_any_shape(small_case, changes, key, thickness):
    case = small_case(**changes, notch=[])
    found = thin_parts(case, domain_from_case(case))
    thinnest = min(found, key=lambda part: part.value)
    assert thinnest.key == key
    assert thinnest.value == pytest.approx(thickness, abs=2 * 0.075 * L_F)  # round surfaces are polygons
    with pytest.raises(InputError, match="less than one body") as caught:
        thin_notices(found, L_F)
    assert caught.value.key == key


def test_corners_of_wedges_are_no_thin_parts(small_case):
    """Beside an inclined notch the material runs out to an edge; so do corners of a triangle."""
    inclined = {"on": "bottom", "at": [0.05, 0.0, 0.0], "direction": [1.0, 1.2, 0.0], "depth": 0.03}
    case = small_case(notch=inclined)
    assert all(part.value > 0.02 for part in thin_parts(case, domain_from_case(case)))
    case = small_case(specimen={"outline": [[0, 0], [0.1, 0], [0.05, 0.08]], "thickness": 0.05}, notch=[])
    assert {part.value for part in thin_parts(case, domain_from_case(case))} == {0.05}


def test_ligament_of_an_inclined_notch(small_case):
    inclined = {"on": "bottom", "at": [0.05, 0.0, 0.0], "direction": [0.6, 0.8, 0.0], "depth": 0.05}
    case = small_case(notch=inclined)
    (ligament,) = [part for part in thin_parts(case, domain_from_case(case)) if part.name == "the ligament"]
    assert ligament.key == "notch.depth"
    assert ligament.value == pytest.approx(0.06 / 0.8 - 0.05, rel=1e-9)


def test_notches_that_cross_leave_nothing_between_them(small_case):
    notches = [{"position": 0.06, "depth": 0.02}, {"normal": "z", "position": 0.02, "depth": 0.02}]
    for width in (0.0, 0.002):
        case = small_case(notch=[part | {"width": width} for part in notches])
        assert not any("between it and" in part.name for part in thin_parts(case, domain_from_case(case)))


def test_notch_beside_a_hole(small_case):
    hole = {"cylinder": {"diameter": 0.01, "through": [0.06, 0.04, 0.02]}, "name": "hole"}
    case = small_case(minus=hole, notch={"position": 0.06, "depth": 0.03})
    (ligament,) = [part for part in thin_parts(case, domain_from_case(case)) if part.name == "the ligament"]
    assert ligament.value == pytest.approx(0.005, abs=5e-4)


def test_surfaces_that_never_face_each_other_have_no_thickness():
    """As those of a single tetrahedron."""
    assert thin_notices([], L_F) == []
