"""The fine nuclei of a specimen: its identity at every resolution (theory section 5)."""

from __future__ import annotations

import io
import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.case import Case
from fissura.errors import InputError
from fissura.files.text import check_file, read_text
from fissura.specimen import Domain
from fissura.specimen.complex import Complex
from fissura.tessellation.blocks import filled
from fissura.tessellation.levels import LeastSpacing, Levels
from fissura.tessellation.limits import LEVELS, MOST_BYTES, MOST_BYTES_OF_TEXT, ON_SURFACE
from fissura.tessellation.placement import place
from fissura.tessellation.random import random_of

_KEY = "discretization.nuclei"


@dataclass(frozen=True)
class Blocks:
    """Which blocks of a specimen have their nuclei, and what the others follow from.

    Attributes
    ----------
    levels : Levels
        The blocks.
    key : int
        Of their random numbers, 64 bits.
    known : (b,) array
        Numbers of the blocks that have their nuclei, ascending.
    identity : (n,) array
        Identities of these nuclei, ascending: number of the block and number within it.
    """

    levels: Levels
    key: int
    known: IntArray
    identity: IntArray


@dataclass(frozen=True)
class Nuclei:
    """Fine nuclei of a specimen: all of them, placed once, or those that were asked for so far.

    Attributes
    ----------
    x : (n, 3) array
        Positions [m].
    home : (n,) array
        The convex cell of the specimen that holds each of them.
    priority : (n,) array
        Fixed random rank, smallest first.
    spacing : float
        Smallest distance ``l_f`` [m].
    complex : Complex
        The specimen.
    given : int
        How many of them a file gave; the others were added.
    blocks : Blocks, optional
        What further nuclei come from; None where all are there.
    """

    x: FloatArray
    home: IntArray
    priority: IntArray
    spacing: float
    complex: Complex
    given: int = 0
    blocks: Blocks | None = None

    @property
    def identity(self) -> IntArray:
        """Identities for life, ascending, shape (n,): indices where all nuclei are there from the beginning."""
        return np.arange(len(self.x)) if self.blocks is None else self.blocks.identity

    def used(self, spacing: FloatArray) -> IntArray:
        """Nuclei that may be used with a wanted spacing at them [m], all but those too fine for it; (n,) -> (k,)."""
        if self.blocks is None:
            return np.arange(len(self.x))
        levels = self.blocks.levels
        return np.flatnonzero(spacing < levels.widest(levels.level_of(self.blocks.identity)))

    def inside(self, cell: int) -> IntArray | None:
        """Nuclei that are admitted in a convex cell of the specimen; None where all are."""
        c = self.complex
        rules = slice(c.rule_start[cell], c.rule_start[cell + 1])
        if rules.start == rules.stop:
            return None
        return np.flatnonzero(np.all(self.x @ c.rule_normal[rules].T > c.rule_offset[rules], axis=1))

    def __len__(self) -> int:
        return len(self.x)

    @classmethod
    def placed(cls, complex_: Complex, l_f: float, rng: np.random.Generator, given: FloatArray | None = None) -> Nuclei:
        """Saturate a complex with nuclei and give each a random priority; arguments as for :func:`place`."""
        x, home = place(complex_, l_f, rng, given)
        return cls(x, home, rng.permutation(len(x)), l_f, complex_)

    @classmethod
    def in_blocks(cls, complex_: Complex, l_f: float, key: int) -> Nuclei:
        """No nuclei yet, to be placed in blocks as they are asked for.

        Parameters
        ----------
        complex_ : Complex
            The specimen.
        l_f : float
            Smallest distance of nuclei [m].
        key : int
            Of all random numbers, 64 bits.
        """
        none = np.empty(0, np.int64)
        blocks = Blocks(Levels.of(complex_, l_f), key, none, none)
        return cls(np.empty((0, 3)), none, none, l_f, complex_, blocks=blocks)

    def known_for(self, least: LeastSpacing) -> Nuclei:
        """The same nuclei, and all others that may be used with a wanted spacing.

        Those that are known besides depend on what was asked for before; `select` does not use them.

        Parameters
        ----------
        least : callable
            The least wanted spacing within a radius [m] around points (n, 3) [m], shape (n,).
        """
        if self.blocks is None:
            return self
        levels, key, known = self.blocks.levels, self.blocks.key, self.blocks.known
        todo = levels.missing(levels.asked(least), known)
        if not len(todo):
            return self
        before = (self.x, self.home, self.blocks.identity)
        x, home, identity = filled(todo, levels, key, self.complex, known, *before)
        return replace(
            self,
            x=x,
            home=home,
            priority=_by_level(levels.level_of(identity), random_of(np.uint64(key), identity)),
            blocks=replace(self.blocks, known=np.union1d(known, todo), identity=identity),
        )

    def complete(self) -> Nuclei:
        """All fine nuclei of the specimen."""
        return self.known_for(lambda x, _: np.zeros(len(x)))


def _by_level(level: IntArray, random: IntArray) -> IntArray:
    """Priorities: coarser levels first, then at random; (n,) each."""
    bits = (LEVELS - 1).bit_length()
    return np.asarray((LEVELS - 1 - level << 63 - bits) | random >> bits)


def read_nuclei(path: Path) -> FloatArray:
    """Read nuclei from a file: ``.npy`` with shape (n, 3), or text with ``x y z`` in metres on each line.

    Raises
    ------
    InputError
        Missing or unreadable file, wrong shape, values that are not finite.
    """
    key, allowed = _KEY, "x y z on each line, in m, or .npy of shape (n, 3)"
    x: NDArray[Any]
    try:
        with warnings.catch_warnings(action="ignore"):  # numpy warns of empty files; the shape tells as much
            if path.suffix == ".npy":
                check_file(path, key, allowed, MOST_BYTES)
                x = np.lib.format.open_memmap(path, mode="r")  # takes no memory for what the file does not hold
            else:
                x = np.loadtxt(io.StringIO(read_text(path, key, allowed, MOST_BYTES_OF_TEXT)), ndmin=2)
    except InputError:
        raise
    except Exception as error:  # NumPy raises many kinds for damaged files
        raise InputError(key, f"{path} does not hold numbers: {error}", allowed) from error
    if x.ndim != 2 or x.shape[1] != 3 or not len(x):
        raise InputError(key, f"{path} holds an array of shape {x.shape}", "one row of x y z per nucleus")
    if x.dtype.kind not in "iuf" or not np.isfinite(x).all():
        raise InputError(key, f"{path} holds values that are not finite numbers", "finite coordinates in m")
    return np.array(x, dtype=np.float64, order="C")


def nuclei_from_case(case: Case, domain: Domain) -> Nuclei:
    """Place the fine nuclei of a case's specimen, beginning with those of its nuclei file if there is one.

    Nuclei from a file stay where they are, and all of them are used. Gaps are filled up to saturation. With
    ``discretization.placement = "blocks"`` none is placed yet.

    Raises
    ------
    InputError
        A nuclei file that cannot be used.
    """
    part = case.discretization
    if part.placement == "blocks":
        key = int(np.random.SeedSequence(case.seed).generate_state(1, np.uint64)[0])
        return Nuclei.in_blocks(domain.complex, part.l_f, key)
    rng = np.random.default_rng(np.random.SeedSequence(case.seed))
    if part.nuclei is None:
        return Nuclei.placed(domain.complex, part.l_f, rng)
    given = read_nuclei(part.nuclei)
    outside = (domain.cell_of(given) < 0) | _on_surface(given, domain.complex)
    if outside.any():
        row = int(np.argmax(outside))
        raise InputError(
            _KEY,
            f"nucleus {row + 1} at {tuple(given[row].tolist())} m is not inside the specimen",
            "places in the material, not on its surface",
        )
    nuclei = replace(Nuclei.placed(domain.complex, part.l_f, rng, given), given=len(given))
    _check_used(given, nuclei)
    return nuclei


def _on_surface(x: FloatArray, complex_: Complex) -> BoolArray:
    """Whether points lie on the surface but for round-off, which must not decide on which side; (n, 3) -> (n,)."""
    c = complex_
    margin = ON_SURFACE * c.extent
    out = np.zeros(len(x), np.bool_)
    cell = np.repeat(np.arange(len(c.low)), np.diff(c.plane_start))
    for f in np.unique(np.repeat(np.arange(len(c.offset)), np.diff(c.part_start))[c.part_to < 0]):
        near = np.flatnonzero(np.abs(x @ c.normal[f] - c.offset[f]) <= margin)
        rows = slice(c.plane_start[cell[f]], c.plane_start[cell[f] + 1])
        near = near[np.all(x[near] @ c.normal[rows].T <= c.offset[rows] + margin, axis=1)]
        for part in range(c.part_start[f], c.part_start[f + 1]):
            if c.part_to[part] < 0:
                edges = slice(c.edge_start[part], c.edge_start[part + 1])
                out[near] |= np.all(x[near] @ c.edge_normal[edges].T <= c.edge_offset[edges] + margin, axis=1)
    return out


def _check_used(given: FloatArray, nuclei: Nuclei) -> None:
    """Every given nucleus must be one of the specimen's.

    Raises
    ------
    InputError
        Some are not: they are closer than the spacing to others.
    """
    distance, place = cKDTree(nuclei.x).query(given)
    used = np.zeros(len(given), bool)
    used[np.unique(place, return_index=True)[1]] = True  # of two at one place the first
    unused = np.flatnonzero(~used | (distance > 0.0))
    if not len(unused):
        return
    row = int(unused[0])
    gaps, others = (np.ravel(found) for found in cKDTree(given).query(given[row], k=2))  # one of the two is itself
    near = 0 if others[0] != row else 1
    raise InputError(
        _KEY,
        f"{len(unused)} of {len(given)} nuclei cannot be used; nucleus {row + 1} at {tuple(given[row].tolist())} m"
        f" is {1e3 * gaps[near]:.4g} mm from nucleus {others[near] + 1}, less than l_f = {1e3 * nuclei.spacing:.4g} mm",
        "nuclei at least l_f apart; leave others out, gaps are filled",
    )
