"""Levels of spacing, and the blocks in which nuclei of each level are placed.

Level ``m`` is saturated with spacing ``2^m l_f``, given the nuclei of all coarser levels. Its blocks have a fixed width
in that spacing and begin at the specimen's lower corner, so that a block of one level is divided into eight of the
next. They have eight colours by the parity of their indices: blocks of one colour are too far apart to matter to each
other, and a block comes after its neighbours of lower colours. Along x it depends on one block at most to either side,
along y on two, along z on three: specimens are long along x and thin along z more often than not.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.specimen.complex import Complex
from fissura.tessellation.limits import BELOW, CELLS, LEVELS, MOST_IN_BLOCK, RIM, WIDTH

#: Least wanted spacing within a radius [m] around points (n, 3) [m]: shape (n,) [m], 0 where something is fine there.
LeastSpacing = Callable[[FloatArray, float], FloatArray]

_AROUND = [step for step in itertools.product((-1, 0, 1), repeat=3) if any(step)]


def needed_spacing(l_f: float, spacing: float) -> float:
    """Spacing of the finest level that is needed for a wanted spacing [m]."""
    level = math.floor(math.log2(spacing / (l_f * (1.0 - BELOW))))
    return l_f * 2.0 ** min(level, LEVELS - 1)


@dataclass(frozen=True)
class Levels:
    """The blocks of a specimen. Their numbers count from the coarsest level on.

    Attributes
    ----------
    l_f : float
        Spacing of level 0 [m].
    origin : (3,) array
        Lower corner of the specimen [m].
    shape : (L, 3) array
        Number of blocks of each level along each axis; level 0 first.
    base : (L + 1,) array
        Number of the first block of each level, and in the end the number of all blocks.
    """

    l_f: float
    origin: FloatArray
    shape: IntArray
    base: IntArray

    @classmethod
    def of(cls, complex_: Complex, l_f: float) -> Levels:
        """Divide the bounds of a specimen."""
        origin = complex_.low.min(axis=0)
        size = complex_.high.max(axis=0) - origin
        shape = [np.maximum(np.ceil(size / (WIDTH * l_f) * (1.0 - BELOW)), 1.0).astype(np.int64)]
        for _ in range(1, LEVELS):
            shape.append((shape[-1] + 1) // 2)
        counts = np.array([counts.prod() for counts in shape])
        after = np.cumsum(counts[::-1])[::-1]  # a coarser level comes first
        return cls(l_f, origin, np.stack(shape), np.append(after - counts, after[0]))

    def level_of(self, identity: IntArray) -> IntArray:
        """Level of nuclei; (n,) -> (n,)."""
        return LEVELS - np.searchsorted(self.base[LEVELS - 1 :: -1], identity // MOST_IN_BLOCK, side="right")

    def widest(self, level: IntArray) -> FloatArray:
        """Wanted spacing below which nuclei of a level may be used [m]; (n,) -> (n,).

        It is twice the spacing of the level, so that a selection with a spacing from `2^m l_f` on needs no nuclei finer
        than level `m`. There is nothing coarser than the last level.
        """
        spacing = 2.0 ** (level + 1) * self.l_f * (1.0 - BELOW)
        return np.where(level == LEVELS - 1, np.inf, spacing)

    def _numbers(self, level: int, index: IntArray) -> IntArray:
        """Numbers of blocks; (b, 3) -> (b,)."""
        size = self.shape[level]
        return np.asarray(self.base[level] + (index[:, 0] * size[1] + index[:, 1]) * size[2] + index[:, 2])

    def asked(self, least: LeastSpacing) -> list[IntArray]:
        """Blocks, by their indices (b, 3), that may hold nuclei for a wanted spacing; of each level, level 0 first."""
        index = np.argwhere(np.ones(self.shape[-1], np.bool_))
        found: list[IntArray] = []
        for level in reversed(range(LEVELS)):
            if level < LEVELS - 1:
                parts = [2 * index + np.array(part) for part in itertools.product((0, 1), repeat=3)]
                index = np.concatenate(parts)
                index = index[(index < self.shape[level]).all(axis=1)]
            width = WIDTH * 2.0**level * self.l_f
            radius = 0.5 * np.sqrt(3.0) * width * (1.0 + 2.0 * RIM / CELLS) * (1.0 + BELOW)
            limit = float(self.widest(np.array(level)))
            index = index[least(self.origin + (index + 0.5) * width, radius) < limit]
            found.append(index)
        return found[::-1]

    def missing(self, asked: list[IntArray], known: IntArray) -> IntArray:
        """Blocks that must be placed for those that are asked for, each after those on which it depends.

        Parameters
        ----------
        asked : list of (b, 3) arrays
            Indices of blocks, for each level.
        known : (k,) array
            Numbers of blocks that are placed, with all on which they depend.

        Returns
        -------
        (q,) array
            Their numbers.
        """
        there = np.zeros(self.base[-1], np.bool_)
        there[known] = True
        found: list[IntArray] = []
        coarser = np.empty((0, 3), np.int64)
        for level in range(LEVELS):
            size = self.shape[level]
            first = int(self.base[level])
            rim = np.ones(size + 2, np.bool_)  # blocks that are there, or are no blocks
            rim[1:-1, 1:-1, 1:-1] = there[first : first + int(size.prod())].reshape(size)
            wanted = np.zeros(size + 2, np.bool_)
            for index in (asked[level], coarser):
                wanted[tuple(index.T + 1)] = True
            by_colour = _with_neighbours(wanted, rim)
            coarser = _above(np.concatenate(by_colour))
            found.append(np.concatenate([np.sort(self._numbers(level, index)) for index in by_colour]))
        return np.concatenate(found[::-1])


def _with_neighbours(wanted: BoolArray, there: BoolArray) -> list[IntArray]:
    """Indices of wanted blocks of each colour, and of those before them, but for those that are there.

    Masks have a rim of one block.
    """
    found = []
    for colour in reversed(range(8)):
        corner = [colour >> 2 - a & 1 for a in range(3)]
        view = tuple(slice(1 + c, -1, 2) for c in corner)
        index = 2 * np.argwhere(wanted[view] & ~there[view]) + corner
        found.append(index)
        for step in _AROUND:
            if colour ^ sum(4 >> a for a in range(3) if step[a]) < colour:
                wanted[tuple(index.T + 1 + np.array(step)[:, None])] = True
    return found[::-1]


def _above(index: IntArray) -> IntArray:
    """Blocks of the next coarser level within a spacing of blocks; (b, 3) -> (8 b, 3)."""
    ends = ((index - 1) >> 1, (index + 1) >> 1)
    choices = itertools.product((0, 1), repeat=3)
    return np.concatenate([np.stack([ends[c][:, a] for a, c in enumerate(choice)], axis=1) for choice in choices])
