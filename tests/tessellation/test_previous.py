"""A tessellation made from an earlier one is the same as one from scratch, bit for bit, and takes less work."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fissura.specimen import Domain, Solid
from fissura.specimen.assemble import complex_of
from fissura.specimen.shapes.prism import box
from fissura.tessellation import Nuclei, Tessellation, clipped, discretize
from fissura.tessellation.discretize import tessellate

from .build import L_F, box_with, nuclei_in, region, shape
from .test_voronoi import IRREGULAR
from .test_voronoi import SIZE as UNIT

NAMES = ("none", "cut", "saw", "double edge", "close together", "L-panel", "disc with hole", "wedge", "blocks", "ball")
PLACES = {name: (shape(name), nuclei_in(shape(name), 5)) for name in NAMES}


def arrays(part: Any, name: str = "") -> Iterator[tuple[str, np.ndarray]]:
    for field in fields(part):
        value = getattr(part, field.name)
        if is_dataclass(value):
            yield from arrays(value, f"{name}.{field.name}")
        elif isinstance(value, np.ndarray):
            yield f"{name}.{field.name}", value


def check_identical(one: Tessellation, other: Tessellation) -> None:
    for (name, a), (_, b) in zip(arrays(one), arrays(other), strict=True):
        assert a.dtype == b.dtype, name
        assert a.tobytes() == b.tobytes(), name


@given(st.sampled_from(NAMES), st.lists(st.lists(st.floats(0.0, 1.0), max_size=3), min_size=2, max_size=5))
def test_regions_that_grow_and_shrink(name, regions):
    domain, nuclei = PLACES[name]
    previous = None
    for chosen in regions:
        centers = nuclei.x[[int(share * (len(nuclei) - 1)) for share in chosen]]
        spacing = region(domain, centers).spacing(nuclei.x)
        previous = discretize(nuclei, domain, spacing, previous)
        check_identical(previous, discretize(nuclei, domain, spacing))


def split_box() -> Domain:
    """A box of many convex cells; lattices have their bisectors in open faces."""
    solid: Solid = box(UNIT)
    for normal, offset in (((1, 0, 0), 0.5), ((0, 1, 0), 0.4), ((1, 1, 1), 1.2)):
        solid.split(solid.planes.find(np.array(normal, float), offset))
    return Domain(*complex_of(solid))


BOXES = {"whole": Domain(*complex_of(box(UNIT))), "split": split_box()}


@given(st.sampled_from(list(BOXES)), st.sampled_from(list(IRREGULAR)), st.integers(0, 2**32 - 1), st.floats(0.0, 0.3))
def test_any_nuclei_come_and_go(name, nuclei, seed, share):
    """Also of lattices and clusters, where the order of cuts could tell."""
    rng = np.random.default_rng(seed)
    domain, x = BOXES[name], np.array(IRREGULAR[nuclei], float)
    home = domain.cell_of(x)
    previous = None
    for _ in range(3):
        nucleus = np.flatnonzero(rng.random(len(x)) >= share)
        if not len(nucleus):
            continue
        given = (x[nucleus], home[nucleus], domain.complex, domain.surfaces, np.full(len(nucleus), 0.05), nucleus)
        now = tessellate(*given, None, previous)
        check_identical(now, tessellate(*given))
        previous = now


def test_exclusions_do_not_depend_on_history():
    """Round the inner corner of an L: a nucleus that comes takes away what another one was excluded from."""
    domain = shape("L-panel")
    x = np.array([[0.0499, 0.02, 0.01], [0.03, 0.06, 0.01], [0.095, 0.099, 0.01], [0.08, 0.06, 0.01]])
    home = domain.cell_of(x)

    def of(nucleus: list[int], previous: Tessellation | None = None) -> Tessellation:
        rows = np.array(nucleus)
        given = (x[rows], home[rows], domain.complex, domain.surfaces, np.full(len(rows), 0.05), rows)
        return tessellate(*given, None, previous)

    few = of([0, 1, 2])
    assert few.cells.bodies is not few.cells.first  # something is excluded
    for nucleus in ([0, 1, 2, 3], [0, 2], [0, 1], [1, 2, 3]):
        then = of(nucleus, few)
        check_identical(then, of(nucleus))
        check_identical(of([0, 1, 2], then), few)


def counted(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Numbers of bodies that were clipped, call by call."""
    done, clip = [], clipped.clip_bodies

    def watched(todo: Any, *rest: Any) -> Any:
        done.append(len(todo))
        return clip(todo, *rest)

    monkeypatch.setattr(clipped, "clip_bodies", watched)
    return done


def fine_but_for_a_ball(nuclei: Nuclei, center: tuple[float, float, float], count: int) -> np.ndarray:
    nearest = np.argsort(np.linalg.norm(nuclei.x - center, axis=1))[:count]
    spacing = np.zeros(len(nuclei))
    spacing[nearest] = 3.0 * L_F
    return spacing


def test_work_is_in_proportion_to_the_change(monkeypatch):
    done = counted(monkeypatch)
    for size in ((0.16, 0.1, 0.1), (0.24, 0.16, 0.16)):
        domain = box_with(size=size)
        nuclei = nuclei_in(domain, 0)
        previous = discretize(nuclei, domain, fine_but_for_a_ball(nuclei, (0.08, 0.05, 0.05), 20))
        check_identical(
            discretize(nuclei, domain, np.zeros(len(nuclei)), previous),
            discretize(nuclei, domain, np.zeros(len(nuclei))),
        )
    small, large = done[1], done[4]
    assert 20 <= small < 250
    assert abs(large - small) < 100


def test_nothing_changed(monkeypatch):
    domain, nuclei = PLACES["cut"]
    spacing = region(domain).spacing(nuclei.x)
    first = discretize(nuclei, domain, spacing)
    done = counted(monkeypatch)
    check_identical(discretize(nuclei, domain, spacing, first), first)
    assert done[0] == 0


def test_everything_changed():
    domain, nuclei = PLACES["none"]

    def of(nucleus: np.ndarray, previous: Tessellation | None = None) -> Tessellation:
        given = (nuclei.x[nucleus], nuclei.home[nucleus], domain.complex, domain.surfaces)
        return tessellate(*given, np.full(len(nucleus), L_F), nucleus, None, previous)

    even, odd = np.arange(0, len(nuclei), 2), np.arange(1, len(nuclei), 2)
    check_identical(of(odd, of(even)), of(odd))


def test_previous_without_cells():
    """As it comes from a file."""
    from dataclasses import replace

    domain, nuclei = PLACES["cut"]
    spacing = region(domain).spacing(nuclei.x)
    first = discretize(nuclei, domain, spacing)
    check_identical(discretize(nuclei, domain, spacing, replace(first, cells=None)), first)
