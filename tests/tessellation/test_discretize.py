"""Tessellations keep every exact identity, for all shapes, notches and resolutions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from fissura.errors import InputError
from fissura.specimen import Domain
from fissura.specimen.assemble import complex_of
from fissura.specimen.shapes.prism import box
from fissura.tessellation import discretize, owners
from fissura.tessellation.discretize import tessellate

from .build import L_F, NOTCHES, SHAPES, SIZE, box_with, discretized, nuclei_in, region, shape
from .exact import check_all, check_closed, check_contacts, check_notch, check_patch, check_surface, check_volumes


def of_nuclei(x, domain: Domain, spacing, *rest):
    x = np.asarray(x, float)
    return tessellate(x, domain.cell_of(x), domain.complex, domain.surfaces, spacing, *rest)


@pytest.mark.parametrize("name", SHAPES)
def test_full_resolution(name):
    domain = shape(name)
    nuclei = nuclei_in(domain, 0)
    t = discretized(nuclei, domain, region(domain, everywhere=True))
    assert_array_equal(t.nucleus, np.arange(len(nuclei)))
    assert t.fine.all()
    assert t.contacts.fine.all()
    check_all(t, domain, L_F)


@pytest.mark.parametrize("name", SHAPES)
def test_graded(name):
    domain = shape(name)
    nuclei = nuclei_in(domain, 2)
    t = discretized(nuclei, domain, region(domain, nuclei.x[:1]))
    assert len(t) < len(nuclei)
    assert_array_equal(t.x, nuclei.x[t.nucleus])
    assert t.fine.any()
    check_all(t, domain, L_F)


@pytest.mark.slow
@pytest.mark.parametrize("name", SHAPES)
def test_ten_seeds(name):
    domain = shape(name)
    for seed in range(10):
        nuclei = nuclei_in(domain, seed)
        check_all(discretized(nuclei, domain, region(domain, everywhere=True)), domain, L_F)
        check_all(discretized(nuclei, domain, region(domain, nuclei.x[:1])), domain, L_F)


@pytest.mark.parametrize("name", [name for name, parts in NOTCHES.items() if len(parts) == 1])
@pytest.mark.parametrize("everywhere", [True, False], ids=["full", "graded"])
def test_notch(name, everywhere):
    domain = shape(name)
    check_notch(discretized(nuclei_in(domain, 1), domain, region(domain, everywhere=everywhere)), domain)


seeds = st.integers(0, 2**32 - 1)
depths = st.floats(0.002, 0.055)
widths = st.one_of(st.just(0.0), st.floats(1e-6, 0.03))
positions = st.floats(0.02, 0.1)
points = st.tuples(*(st.floats(0.0, side) for side in SIZE))


@given(seeds, depths, widths, positions, st.lists(points, max_size=3))
def test_any_bottom_notch(seed, depth, width, position, centers):
    domain = box_with({"position": position, "depth": depth, "width": width})
    t = discretized(nuclei_in(domain, seed), domain, region(domain, centers))
    check_all(t, domain, L_F)
    check_notch(t, domain)


@given(seeds, st.sampled_from(["none", "L-panel", "disc with hole"]), st.floats(0.0, 3.0), st.booleans())
def test_any_spacing(seed, name, coarse, ball):
    """Also where spacing jumps without a ramp, and where a few bodies fill the specimen."""
    domain = shape(name)
    nuclei = nuclei_in(domain, seed)
    spacing = np.full(len(nuclei), L_F * (1.0 + 5.0 * coarse))
    if ball:
        spacing[np.linalg.norm(nuclei.x - nuclei.x[0], axis=1) < 0.02] = 0.0
    check_all(discretize(nuclei, domain, spacing), domain, spacing[spacing > 0.0].max())


@pytest.mark.parametrize("coarse", [1.0, 8.0])
def test_a_coarse_notch_is_as_exact(coarse):
    """No limit on the size of bodies at a notch."""
    for name in ("cut", "saw"):
        domain = shape(name)
        nuclei = nuclei_in(domain, 3)
        t = discretize(nuclei, domain, np.full(len(nuclei), coarse * L_F))
        check_all(t, domain, coarse * L_F)
        check_notch(t, domain)


def test_no_notch_in_the_limit():
    """What a notch changes goes to zero with its depth: bodies that do not touch it are the same."""
    plain, nuclei = shape("none"), nuclei_in(shape("none"), 0)
    whole = discretize(nuclei, plain, np.zeros(len(nuclei)))
    changes = []
    for depth in (1e-3, 1e-5, 1e-7):
        domain = box_with({"position": 0.06, "depth": depth})
        t = of_nuclei(nuclei.x, domain, np.full(len(nuclei), L_F))
        changes.append(np.abs(t.volume - whole.volume).max() / whole.volume.mean())
        assert len(t.contacts) >= len(whole.contacts) - 3
        pairs = {tuple(pair): k for k, pair in enumerate(t.contacts.bodies.tolist())}
        area = np.array([t.contacts.area[pairs[p]] if (p := tuple(q)) in pairs else 0.0 for q in whole.contacts.bodies])
        assert np.abs(area - whole.contacts.area).max() < 2.0 * depth * L_F + 1e-9 * L_F**2
    assert changes[1] < 0.02 * changes[0]
    assert changes[2] < 0.02 * changes[1]


def test_one_body_is_the_box():
    domain = shape("none")
    t = of_nuclei([[0.01, 0.05, 0.03]], domain, np.array([0.2]))
    assert len(t.contacts) == 0
    assert_allclose(t.volume, [np.prod(SIZE)], rtol=1e-14)
    areas = np.bincount(t.surface.surface, t.surface.area)
    assert_allclose(areas, [0.0024, 0.0024, 0.0048, 0.0048, 0.0072, 0.0072], rtol=1e-12)


def test_two_bodies_by_hand():
    t = of_nuclei([[0.02, 0.03, 0.02], [0.06, 0.03, 0.02]], shape("none"), np.full(2, 0.1))
    assert_allclose(t.volume, [0.04 * 0.0024, 0.08 * 0.0024], rtol=1e-12)
    c = t.contacts
    assert_array_equal(c.bodies, [[0, 1]])
    assert_allclose(c.area, [0.0024], rtol=1e-12)
    assert_allclose(c.centroid, [[0.04, 0.03, 0.02]], rtol=1e-12)
    assert_allclose(c.length, [0.04], rtol=1e-12)
    assert_allclose(c.normal, [[1.0, 0.0, 0.0]], atol=1e-12)


@pytest.mark.parametrize("width", [0.0, 0.004])
def test_mirrored_pair_at_a_notch(width):
    """Their contact is the ligament; walls are below it, and there are no ledges."""
    domain = box_with({"position": 0.06, "depth": 0.02, "width": width})
    t = of_nuclei([[0.03, 0.03, 0.02], [0.09, 0.03, 0.02]], domain, np.full(2, 0.1))
    assert_allclose(t.contacts.area, [0.04 * 0.04], rtol=1e-12)
    assert_allclose(t.contacts.centroid, [[0.06, 0.04, 0.02]], rtol=1e-12)
    assert_allclose(t.volume, [0.5 * domain.volume] * 2, rtol=1e-12)
    walls = t.surface.surface == t.surface.names.index("notch")
    assert_allclose(t.surface.area[walls].sum(), 0.04 * (0.04 + width), rtol=1e-12)
    assert t.surface.names == domain.surfaces


def test_pair_beside_a_notch_by_hand():
    """The bisector lies 10 mm beside the cut: ahead of the tip it is the contact, behind it the cut is between them."""
    domain = box_with({"position": 0.06, "depth": 0.02})
    t = of_nuclei([[0.03, 0.03, 0.02], [0.11, 0.03, 0.02]], domain, np.full(2, 0.1))
    assert_allclose(t.contacts.area, [0.04 * 0.04], rtol=1e-12)
    assert_allclose(t.contacts.centroid, [[0.07, 0.04, 0.02]], rtol=1e-12)
    assert_allclose(t.volume, [0.04 * (0.07 * 0.04 + 0.06 * 0.02), 0.04 * (0.05 * 0.04 + 0.06 * 0.02)], rtol=1e-12)
    s = t.surface
    ledge = s.surface == s.names.index("ledge")
    assert_array_equal(s.body[ledge], [0, 1])
    assert_allclose(s.area[ledge], [0.01 * 0.04] * 2, rtol=1e-12)
    assert_allclose(s.normal[ledge], [[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]], atol=1e-15)
    check_all(t, domain, 0.1)
    check_notch(t, domain)


def test_round_a_corner():
    """What is nearest to a nucleus behind the inner corner of an L, with another body in between, is not its own."""
    domain = shape("L-panel")  # arms 50 mm wide, the inner corner at (0.05, 0.05)
    x = np.array([[0.0499, 0.02, 0.01], [0.03, 0.06, 0.01], [0.095, 0.099, 0.01]])
    t = of_nuclei(x, domain, np.full(3, 0.05))
    corner, place = [0.05, 0.0501, 0.01], [0.08, 0.0501, 0.01]
    assert [np.linalg.norm(x - p, axis=1).argmin() for p in (corner, place)] == [1, 0]
    points = np.array([corner, place])
    assert_array_equal(owners(t, points, domain.cell_of(points)), [1, 1])
    check_all(t, domain, 0.05)


@pytest.mark.parametrize("guess", [1e-4, 1.0])
def test_spacing_is_only_a_guess(guess):
    domain = shape("cut")
    nuclei = nuclei_in(domain, 4)
    t = of_nuclei(nuclei.x, domain, np.full(len(nuclei), L_F))
    again = of_nuclei(nuclei.x, domain, np.full(len(nuclei), guess * L_F))
    assert_array_equal(again.volume, t.volume)
    assert_array_equal(again.contacts.polygons.points, t.contacts.polygons.points)


@pytest.mark.parametrize("name", ["none", "cut", "saw", "double edge", "L-panel", "blocks"])
@pytest.mark.parametrize("jitter", [0.0, 1e-15, 1e-13, 1e-9, 1e-5])
def test_lattices_of_nuclei(name, jitter):
    """Regular nuclei make every corner degenerate, and bisectors lie in open faces."""
    domain = shape(name)
    step = 0.01 if name != "L-panel" else 0.0125
    axes = [np.arange(0.5 * step, side, step) for side in domain.size]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    x = x[domain.contains(x)]
    x = x + jitter * np.random.default_rng(0).uniform(-1, 1, x.shape)
    t = of_nuclei(x, domain, np.full(len(x), step))
    check_volumes(t, domain, 1e-9)
    check_contacts(t)
    check_surface(t, domain)
    if jitter not in (1e-13, 1e-9):  # planes nearly parallel meet in places that round-off decides
        check_closed(t, step)
        check_patch(t, step)


def test_a_part_without_nuclei_is_refused():
    """Between two notches closer than the nuclei, with rules on either side."""
    domain = box_with({"position": 0.055, "depth": 0.03}, {"position": 0.065, "depth": 0.03})
    with pytest.raises(InputError, match=r"fill 0\.9") as caught:
        of_nuclei([[0.02, 0.03, 0.02], [0.1, 0.03, 0.02]], domain, np.full(2, 0.03))
    assert caught.value.key == "discretization"


def test_renumbering_the_nuclei_changes_nothing_but_numbers():
    domain = shape("saw")
    nuclei = nuclei_in(domain, 3)
    order = np.random.default_rng(0).permutation(len(nuclei))
    spacing = np.full(len(nuclei), L_F)
    a, b = of_nuclei(nuclei.x, domain, spacing), of_nuclei(nuclei.x[order], domain, spacing)
    assert_allclose(a.volume[order], b.volume, rtol=1e-9)
    pairs_a, pairs_b = np.sort(a.contacts.bodies, axis=1), np.sort(order[b.contacts.bodies], axis=1)
    sort_a, sort_b = np.lexsort(pairs_a.T), np.lexsort(pairs_b.T)
    large = a.contacts.area[sort_a] > 1e-9 * L_F**2
    large_b = b.contacts.area[sort_b] > 1e-9 * L_F**2
    assert_array_equal(pairs_a[sort_a][large], pairs_b[sort_b][large_b])
    assert_allclose(a.contacts.area[sort_a][large], b.contacts.area[sort_b][large_b], rtol=1e-6)


def test_convex_cells_do_not_matter():
    """A box cut into many cells by open planes has the same bodies."""
    plain = shape("none")
    solid = box(SIZE)
    for normal, offset in (((1, 0, 0), 0.05), ((0.3, 1, 0), 0.04), ((1, -1, 2), 0.03)):
        face = solid.planes.find(np.array(normal, float), offset)
        solid.split(face)
    domain = Domain(*complex_of(solid))
    assert len(domain.complex.low) > 6
    nuclei = nuclei_in(domain, 6)
    spacing = np.full(len(nuclei), L_F)
    whole, parts = of_nuclei(nuclei.x, plain, spacing), of_nuclei(nuclei.x, domain, spacing)
    assert_array_equal(whole.contacts.bodies, parts.contacts.bodies)
    assert_allclose(parts.contacts.area, whole.contacts.area, atol=1e-12 * L_F**2)
    assert_allclose(parts.contacts.centroid, whole.contacts.centroid, atol=1e-6 * L_F)
    assert_allclose(parts.volume, whole.volume, rtol=1e-10)
    assert_array_equal(whole.surface.body, parts.surface.body)
    assert_allclose(parts.surface.area, whole.surface.area, rtol=1e-9)


def test_bulk_statistics():
    """About 15 contacts per inner body at saturation (theory section 1)."""
    domain = box_with(size=(0.1, 0.1, 0.1))
    t = discretized(nuclei_in(domain, 5), domain, region(domain, everywhere=True))
    inner = np.ones(len(t), bool)
    inner[t.surface.body] = False
    neighbours = np.bincount(t.contacts.bodies.ravel(), minlength=len(t))
    assert 14.3 < neighbours[inner].mean() < 15.7
    between = inner[t.contacts.bodies].all(axis=1)
    weighted = np.average(t.contacts.length[between], weights=t.contacts.area[between]) / L_F
    assert 1.15 < weighted < 1.3
