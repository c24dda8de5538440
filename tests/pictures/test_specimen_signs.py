"""Signs of what holds, loads and measures a specimen, and platens as plates."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fissura.case import Case
from fissura.pictures.specimen_signs import THICKNESS, Plate, signs_of
from fissura.specimen import domain_from_case
from fissura.specimen.convex import area_vector

STRIP = {"face": "top", "at": 0.05, "width": 0.02}
TWO_LOADS: dict[str, Any] = {
    "load": None,
    "loads": {"left": {"face": "top", "at": 0.04}, "right": {"face": "top", "at": 0.08, "direction": [0, 1, 0]}},
    "gauge": None,
    "gauges": {
        "cmod": {"a": {"face": "bottom", "at": 0.055}, "b": {"face": "bottom", "at": 0.065}},
        "dip": {"a": {"face": "bottom", "at": 0.01}, "b": {"face": "top", "at": 0.03}, "direction": [0, 1, 0]},
    },
    "gravity": {"density": "2400 kg/m^3", "direction": [0, 0, -2]},
    "control": None,
    "stage": [{"load": {"left": 0.5, "right": 0.5}, "gauge": "cmod", "to": "0.1 mm"}],
}


def signs(case: Case) -> Any:
    return signs_of(case, domain_from_case(case))


def volume(plate: Plate, lower: float) -> float:
    """Volume above the plane of a height, on which the plate has no face."""
    origin = np.array([0.0, lower, 0.0])
    return float(sum(area_vector(face) @ (face[0] - origin) for face in plate.faces)) / 3.0


@pytest.mark.parametrize("face", ["top", "bottom"])
def test_a_plate_is_a_closed_prism_on_what_it_covers(small_case: Any, face: str) -> None:
    """The bottom strip reaches across the notch, so that it lies on several convex cells."""
    at = 0.05 if face == "top" else 0.06
    case = small_case(load={**STRIP, "face": face, "at": at, "platen": "glued"}, notch__width=0.004)
    plate = signs(case).plates[0]
    way = np.array([0.0, 1.0 if face == "top" else -1.0, 0.0])
    width = 0.02 if face == "top" else 0.016
    assert sum(area_vector(f) for f in plate.faces) == pytest.approx(width * 0.04 * way, abs=1e-12)
    lower, thickness = 0.06 if face == "top" else 0.0, THICKNESS * 0.12
    assert volume(plate, lower) == pytest.approx(width * 0.04 * thickness, rel=1e-9)
    normals = np.array([area_vector(f) / np.linalg.norm(area_vector(f)) for f in plate.faces])
    assert normals == pytest.approx(plate.normals, abs=1e-9)


def test_no_walls_inside_a_plate(small_case: Any) -> None:
    """An end of a notched beam consists of two parts; together they have the walls of one."""
    case = small_case(load={"face": "left", "platen": "glued"}, control={"type": "displacement", "target": 1e-4})
    plate = signs(case).plates[0]
    assert np.sum(plate.normals[:, 0] < -0.5) == 2
    inside = [f for f in plate.faces if 1e-6 < f[:, 1].mean() < 0.06 - 1e-6 and np.ptp(f[:, 1]) < 1e-9]
    assert not inside


def test_signs_stand_on_platens_and_arrows_end_where_they_press(small_case: Any) -> None:
    for platen, height in ((None, 0.06), ("frictionless", 0.06 + THICKNESS * 0.12)):
        (load,) = signs(small_case(load={**STRIP, "platen": platen})).loads
        assert load.spots.points[:, 1] == pytest.approx(height, abs=1e-12)
        begin, end = load.arrows(0.01)
        assert end[:, 1] == pytest.approx(height, abs=1e-12)
        assert begin - end == pytest.approx(np.tile([0.0, 0.01, 0.0], (len(end), 1)), abs=1e-15)
    (load,) = signs(small_case(load={**STRIP, "direction": [0, 1, 0]})).loads
    begin, end = load.arrows(0.01)
    assert begin[:, 1] == pytest.approx(0.06, abs=1e-12)
    assert end[:, 1] == pytest.approx(0.07, abs=1e-12)


def test_names_where_there_are_several(small_case: Any) -> None:
    one, several = signs(small_case()), signs(small_case(**TWO_LOADS))
    assert [load.label for load in one.loads] == ["load"]
    assert [gauge.label for gauge in one.gauges] == ["gauge, from a to b"]
    assert one.weight is None
    assert [load.label for load in several.loads] == ["load left", "load right"]
    assert [gauge.label for gauge in several.gauges] == ["gauge cmod, from a to b", "gauge dip, from a to b"]
    assert len({sign.colour for sign in (*several.loads, *several.gauges)}) == 4
    assert several.weight == pytest.approx([0.0, 0.0, -1.0])


def test_plates_say_what_they_are(small_case: Any) -> None:
    held = {"contact": "frictionless", "turning": "held"}
    labels = [
        signs(small_case(load={**STRIP, "platen": platen})).plates[0].label
        for platen in ("glued", "frictionless", held)
    ]
    assert labels == ["platen, glued", "platen, frictionless", "platen, frictionless, held"]


def test_a_support_on_all_of_a_round_surface_has_a_plate_all_around(small_case: Any) -> None:
    case = small_case(
        specimen={"cylinder": {"diameter": 0.05, "length": 0.1}},
        notch=[],
        supports=[{"type": "clamp", "on": "lateral", "platen": "glued"}],
        load={"on": "top"},
        gauge=None,
        control={"type": "displacement", "target": 1e-4},
    )
    (plate,) = signs(case).plates
    assert np.linalg.norm(plate.outward) < 1e-9
    assert all(np.isfinite(face).all() for face in plate.faces)
