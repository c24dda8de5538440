"""A tessellation made from an earlier one is the same as one from scratch, bit for bit, and takes less work."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fissura.specimen import Box
from fissura.tessellation import Nuclei, Tessellation, discretize, tessellate, voronoi

from .build import L_F, NOTCHES, SIZE, box_with, nuclei_in, region
from .test_voronoi import IRREGULAR
from .test_voronoi import SIZE as UNIT

PLACES = {name: (box := box_with(*NOTCHES[name]), nuclei_in(box, 5)) for name in ("none", "cut", "saw", "double edge")}


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


points = st.tuples(*(st.floats(0.0, side) for side in SIZE))


@given(st.sampled_from(list(PLACES)), st.lists(st.lists(points, max_size=3), min_size=2, max_size=5))
def test_regions_that_grow_and_shrink(name, regions):
    box, nuclei = PLACES[name]
    previous = None
    for centers in regions:
        spacing = region(box, centers).spacing(nuclei.x)
        previous = discretize(nuclei, box, spacing, previous)
        check_identical(previous, discretize(nuclei, box, spacing))


@given(st.sampled_from(list(IRREGULAR)), st.integers(0, 2**32 - 1), st.floats(0.0, 0.3))
def test_any_nuclei_come_and_go(name, seed, share):
    """Also of lattices and clusters, where the order of cuts could tell."""
    rng = np.random.default_rng(seed)
    x, box = np.array(IRREGULAR[name], float), Box(UNIT)
    previous = None
    for _ in range(3):
        nucleus = np.flatnonzero(rng.random(len(x)) >= share)
        if not len(nucleus):
            continue
        spacing = np.full(len(nucleus), 0.05)
        now = tessellate(x[nucleus], box, spacing, nucleus, None, previous)
        check_identical(now, tessellate(x[nucleus], box, spacing, nucleus))
        previous = now


def counted(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Numbers of cells that were clipped, call by call."""
    done, clip = [], voronoi.clip_cells

    def watched(todo: Any, *rest: Any) -> Any:
        done.append(len(todo))
        return clip(todo, *rest)

    monkeypatch.setattr(voronoi, "clip_cells", watched)
    return done


def fine_but_for_a_ball(nuclei: Nuclei, center: tuple[float, float, float], count: int) -> np.ndarray:
    nearest = np.argsort(np.linalg.norm(nuclei.x - center, axis=1))[:count]
    spacing = np.zeros(len(nuclei))
    spacing[nearest] = 3.0 * L_F
    return spacing


def test_work_is_in_proportion_to_the_change(monkeypatch):
    done = counted(monkeypatch)
    for size in ((0.16, 0.1, 0.1), (0.24, 0.16, 0.16)):
        box = box_with(size=size)
        nuclei = nuclei_in(box, 0)
        previous = discretize(nuclei, box, fine_but_for_a_ball(nuclei, (0.08, 0.05, 0.05), 20))
        check_identical(
            discretize(nuclei, box, np.zeros(len(nuclei)), previous), discretize(nuclei, box, np.zeros(len(nuclei)))
        )
    small, large = done[1], done[4]
    assert 20 <= small < 250
    assert abs(large - small) < 100


def test_nothing_changed(monkeypatch):
    box, nuclei = PLACES["saw"]
    spacing = region(box).spacing(nuclei.x)
    first = discretize(nuclei, box, spacing)
    done = counted(monkeypatch)
    check_identical(discretize(nuclei, box, spacing, first), first)
    assert done == [0]


def test_everything_changed():
    box, nuclei = PLACES["none"]
    left = tessellate(nuclei.x[::2], box, np.full(len(nuclei.x[::2]), L_F), np.arange(0, len(nuclei), 2))
    spacing, odd = np.full(len(nuclei.x[1::2]), L_F), np.arange(1, len(nuclei), 2)
    check_identical(
        tessellate(nuclei.x[odd], box, spacing, odd, None, left), tessellate(nuclei.x[odd], box, spacing, odd)
    )


def test_previous_without_cells():
    """As it comes from a file."""
    from dataclasses import replace

    box, nuclei = PLACES["cut"]
    spacing = region(box).spacing(nuclei.x)
    first = discretize(nuclei, box, spacing)
    check_identical(discretize(nuclei, box, spacing, replace(first, cells=None)), first)
