"""Shapes, voids and notches in them, and what is wrong with them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fissura.errors import InputError
from fissura.specimen import domain_from_case
from fissura.specimen.shapes.prism import AXES

from .complexes import check, volume
from .test_build import SIZE
from .test_solid import areas

L_PANEL = [[0, 0], [250, 0], [250, 250], [500, 250], [500, 500], [0, 500]]
C = 40 * np.sin(np.pi / 3)
#: Width 100 mm at the ends, 60 mm at the neck, fillets of radius 40 mm, given as round arcs.
DOG_BONE = [
    *([-50, 0], [50, 0], [50, 60], {"to": [30, 60 + C], "radius": -40}, [30, 140 - C]),
    *({"to": [50, 140], "radius": -40}, [50, 200], [-50, 200], [-50, 140]),
    *({"to": [-30, 140 - C], "radius": -40}, [-30, 60 + C], {"to": [-50, 60], "radius": -40}),
]


@pytest.fixture
def built(small_case):
    """The specimen of the small beam with another shape; its complex has all identities."""

    def build(l_f=0.008, notch=None, minus=None, **specimen):
        case = small_case(specimen=specimen, notch=notch or [], minus=minus or [], discretization={"l_f": l_f})
        found = domain_from_case(case)
        check(found.complex)
        assert_allclose(volume(found.complex), found.volume, rtol=1e-12)
        return found

    return build


def test_l_panel(built):
    names = ["foot", "inner", "under", "right", "top", "left"]
    found = built(outline=L_PANEL, names=names, thickness=100, unit="mm")
    assert len(found.complex.low) == 2
    assert found.surfaces == (*names, "front", "back")
    assert_allclose(found.volume, (0.5**2 - 0.25**2) * 0.1, rtol=1e-12)
    lengths = dict(zip(names, [0.25, 0.25, 0.25, 0.25, 0.5, 0.5], strict=True))
    expected = {name: 0.1 * length for name, length in lengths.items()} | {"front": 0.1875, "back": 0.1875}
    assert areas(found) == pytest.approx(expected, rel=1e-12)
    assert_allclose(found.faces("under")[0].normal, [0, -1.0, 0], atol=0)
    assert found.smallest_section == pytest.approx(0.025, rel=1e-12)
    clockwise = built(outline=L_PANEL[::-1], names=["a", "b", "c", "d", "e", "f"], thickness=100, unit="mm")
    assert areas(clockwise)["a"] == pytest.approx(0.05)  # from (0, 500) to (500, 500)
    assert_allclose(clockwise.faces("a")[0].normal, [0, 1.0, 0], atol=0)


def test_default_names_of_sides(built):
    found = built(outline=L_PANEL, thickness=100, unit="mm")
    assert found.surfaces == ("bottom", "side 2", "side 3", "right", "top", "left", "front", "back")


@pytest.mark.parametrize("l_f", [0.02, 0.004, 0.001])
def test_dog_bone(built, l_f):
    """Its volume is that of the round outline at every fineness of the arcs."""
    found = built(l_f, outline=DOG_BONE, thickness=100, unit="mm")
    segment = 0.5 * 40**2 * (np.pi / 3 - np.sin(np.pi / 3))  # between an arc and its chord
    area = 2 * 100 * 60 + 60 * (80 - 2 * C) + 2 * C * 0.5 * (100 + 60) - 4 * segment
    assert_allclose(found.volume, area * 1e-6 * 0.1, rtol=1e-12)
    assert len(found.complex.low) <= 2 + 2 * sum(len(found.faces(f"side {k}")) for k in (3, 5, 9, 11))
    assert found.smallest_section == pytest.approx(0.06 * 0.1, rel=2e-3)


def test_arcs_are_flat_beside_bodies(built):
    """No farther from the circle than a tenth of l_f."""
    for l_f in (0.008, 0.002):
        found = built(l_f, cylinder={"diameter": "150 mm", "length": "60 mm"})
        corners = np.concatenate([part.polygon for part in found.faces("lateral")])[:, :2]
        inner = min(part.normal @ part.polygon[0] for part in found.faces("lateral"))
        assert np.linalg.norm(corners, axis=1).max() - 0.075 < 0.1 * l_f
        assert 0.075 - inner < 0.1 * l_f


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_cylinder(built, axis):
    found = built(cylinder={"diameter": "150 mm", "length": "60 mm", "axis": axis})
    assert len(found.complex.low) == 1
    assert_allclose(found.volume, np.pi * 0.075**2 * 0.06, rtol=1e-12)
    assert found.surfaces == ("lateral", "bottom", "top")
    assert_allclose(found.faces("top")[0].normal, np.eye(3)[AXES[axis]], atol=0)
    assert_allclose(found.bounds[:, AXES[axis]], [0.0, 0.06], atol=0)


def test_sides_of_one_plane_with_different_names(built):
    """A table on two legs: both feet, and both ends under the top, lie in one plane each."""
    outline = [[0, 0], [1, 0], [1, 4], [3, 4], [3, 0], [4, 0], [4, 4], [6, 4], [6, 5], [-2, 5], [-2, 4], [0, 4]]
    names = ["foot a", "in a", "between", "in b", "foot b", "out b", "end b", "right", "top", "left", "end a", "out a"]
    found = built(outline=[[p[0] * 10, p[1] * 10] for p in outline], names=names, thickness=10, unit="mm")
    length = [1, 4, 2, 4, 1, 4, 2, 1, 8, 1, 2, 4]
    expected = {name: 1e-4 * n for name, n in zip(names, length, strict=True)}
    found_areas = areas(found)
    assert {name: found_areas[name] for name in names} == pytest.approx(expected, rel=1e-9)


def test_hole_through_a_disc(built):
    minus = [{"cylinder": {"diameter": "60 mm", "through": [0, 0, 0]}, "name": "hole"}]
    found = built(cylinder={"diameter": "150 mm", "length": "60 mm"}, minus=minus)
    assert_allclose(found.volume, np.pi * (0.075**2 - 0.03**2) * 0.06, rtol=1e-12)
    assert found.surfaces == ("lateral", "bottom", "top", "hole")


@pytest.mark.parametrize(
    "bore",
    [
        {"through": [0.06, 0.03, 0.02], "axis": "y"},
        {"through": [0.06, 0.03, 0.02], "axis": "x"},
        {"start": [0.06, -0.01, 0.02], "end": [0.06, 0.05, 0.02]},
        {"start": [0.05, -0.03, 0.02], "end": [0.07, 0.09, 0.02]},
    ],
)
def test_bores(built, bore):
    found = built(0.004, size=list(SIZE), minus={"cylinder": {"diameter": 0.02, **bore}, "name": "bore"})
    area = np.pi * 0.01**2
    length = {"x": 0.12, "y": 0.06}.get(bore.get("axis"), 0.05 if bore.get("end", [0])[0] == 0.06 else None)
    if length is None:  # across the whole depth, inclined
        length = 0.06 * np.hypot(0.02, 0.12) / 0.12
    assert_allclose(found.volume, np.prod(SIZE) - area * length, rtol=1e-9)
    assert "bore" in found.surfaces


def test_outlines_taken_away(built):
    """A slot of the shape of an L through everything along each axis, and a blind one."""
    outline = [[10, 10], [30, 10], [30, 15], [15, 15], [15, 30], [10, 30]]
    area = (20 * 5 + 5 * 15) * 1e-6
    found = built(size=list(SIZE), minus={"outline": outline, "unit": "mm", "name": "slot"})
    assert_allclose(found.volume, np.prod(SIZE) - area * 0.04, rtol=1e-12)
    assert areas(found)["slot"] == pytest.approx(0.04 * 0.08, rel=1e-9)
    corner = np.array([[0.012, 0.012, 0.02], [0.012, 0.028, 0.02], [0.028, 0.028, 0.02]])
    assert list(found.contains(corner)) == [False, False, True]
    turned = {"corners": outline, "axis": "y", "lower": 40}
    found = built(size=list(SIZE), minus={"outline": turned, "unit": "mm", "name": "slot"})
    assert_allclose(found.volume, np.prod(SIZE) - area * 0.02, rtol=1e-12)
    corner = np.array([[0.012, 0.05, 0.012], [0.012, 0.05, 0.028], [0.028, 0.05, 0.012], [0.012, 0.03, 0.012]])
    assert list(found.contains(corner)) == [False, False, False, True]
    turned = {"corners": [[y, z] for y, z in outline], "axis": "x", "upper": 20}
    found = built(size=list(SIZE), minus={"outline": turned, "unit": "mm", "name": "slot"})
    assert list(found.contains(np.array([[0.01, 0.012, 0.028], [0.03, 0.012, 0.028]]))) == [False, True]


def test_notches_on_other_shapes(built):
    """Starter notch of wedge splitting, inclined saw cut of torsion, round bar, hole, neck of a dog-bone."""
    groove = {"box": {"lower": [85, 170, -1], "upper": [115, 201, 101]}, "unit": "mm", "name": "groove"}
    starter = {"on": "groove", "at": [100, 170, 0], "direction": [0, -1, 0], "depth": 50, "unit": "mm"}
    found = built(size=[0.2, 0.2, 0.1], minus=groove, notch=starter)
    assert areas(found)["notch"] == pytest.approx(2 * 0.05 * 0.1, rel=1e-12)
    cut = {"on": "top", "at": [0.2, 0.1, 0.05], "along": [1, 0, -1], "depth": "50 mm", "width": "5 mm"}
    found = built(size=[0.4, 0.1, 0.1], notch=cut)
    assert_allclose(found.volume, 0.004 - 0.05 * 0.005 * 0.1 * np.sqrt(2), rtol=1e-12)
    assert_allclose(np.linalg.norm(np.diff(found.notches[0].front, axis=0)), 0.1 * np.sqrt(2), rtol=1e-12)
    bar = {"on": "lateral", "at": [0, 75, 150], "along": [1, 0, 0], "depth": 30, "width": 2, "unit": "mm"}
    found = built(cylinder={"diameter": 0.15, "length": 0.3}, notch=bar)
    half = np.arccos((75 - 30) / 75)
    lost = 75**2 * (half - np.sin(half) * np.cos(half)) * 2e-9
    assert_allclose(np.pi * 0.075**2 * 0.3 - found.volume, lost, rtol=0.02)
    neck = {"on": "side 4", "at": [30, 100, 0], "depth": 10, "width": 2, "unit": "mm"}
    whole = built(outline=DOG_BONE, thickness=100, unit="mm")
    found = built(outline=DOG_BONE, thickness=100, unit="mm", notch=neck)
    assert_allclose(whole.volume - found.volume, 10 * 2 * 100e-9, rtol=1e-9)


# --- what is wrong ---------------------------------------------------------------------------------------------------

BOX = {"size": [0.3, 0.1, 0.1]}
BAD = {
    "bow tie": (
        {"outline": [[0, 0], [1, 1], [1, 0], [0, 1]], "thickness": 1},
        {},
        "specimen.outline",
        "crosses itself",
    ),
    "crossing": ({"outline": [[0, 0], [2, 0], [2, 1], [0.5, -1]], "thickness": 1}, {}, "specimen.outline", "crosses"),
    "touching": (
        {"outline": [[0, 0], [2, 0], [1, 1], [2, 2], [0, 2], [1, 1]], "thickness": 1},
        {},
        "specimen.outline",
        "touches itself",
    ),
    "a line": ({"outline": [[0, 0], [1, 0], [2, 0]], "thickness": 1}, {}, "specimen.outline", "no area"),
    "a corner twice": (
        {"outline": [[0, 0], [1, 0], [1, 0], [0, 1]], "thickness": 1},
        {},
        "specimen.outline[2]",
        "same corner",
    ),
    "arc": (
        {"outline": [[0, 0], [1, 0], {"to": [1, 1], "radius": 0.4}], "thickness": 1},
        {},
        "specimen.outline[2].radius",
        "does not reach",
    ),
    "arcs that cross": (
        {
            "outline": [[0, 0], [1, 0], {"to": [1, 0.2], "radius": -0.1}, {"to": [0, 0.2], "radius": -0.5}],
            "thickness": 1,
        },
        {},
        "specimen.outline",
        "crosses itself",
    ),
    "two parts": (BOX, {"box": {"lower": [0.1, -1, -1], "upper": [0.2, 1, 1]}}, "minus", "2 parts, of 0.001, 0.001"),
    "nothing left": (BOX, {"box": {"lower": [-1, -1, -1], "upper": [1, 1, 1]}}, "minus", "whole specimen"),
    "nothing taken": (BOX, {"box": {"lower": [0.4, -1, -1], "upper": [1, 1, 1]}}, "minus", "does not meet"),
    "void crossing": (BOX, {"outline": [[0, 0], [0.2, 0], [0.2, 0.1], [0.05, -0.1]]}, "minus.outline", "crosses"),
}


@pytest.mark.parametrize(("specimen", "minus", "key", "problem"), BAD.values(), ids=BAD)
def test_shapes_that_cannot_be(small_case, specimen, minus, key, problem):
    with pytest.raises(InputError, match=problem) as caught:
        domain_from_case(small_case(specimen=specimen, minus=minus or [], notch=[]))
    assert caught.value.key == key
    assert caught.value.allowed
    if minus:
        first = {"box": {"lower": [0, 0, 0], "upper": [0.01, 0.01, 0.01]}}
        with pytest.raises(InputError) as caught:
            domain_from_case(small_case(specimen=specimen, minus=[first, minus], notch=[]))
        assert caught.value.key in (key.replace("minus", "minus[1]"), "minus")


def test_bodies_larger_than_the_specimen(small_case):
    with pytest.raises(InputError) as caught:
        domain_from_case(small_case(discretization={"l_f": 0.2}))
    assert caught.value.key == "discretization.l_f"
