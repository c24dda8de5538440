"""Voronoi cells of nuclei, restricted to a complex of convex cells; bodies that cannot have changed are kept."""

from dataclasses import dataclass

import numpy as np

from fissura.arrays import BoolArray, FloatArray, IntArray
from fissura.specimen.complex import Complex
from fissura.tessellation.admission import settled
from fissura.tessellation.clipped import Clipped, Setting, clipped, plane_keys
from fissura.tessellation.grid import grid_of, within


@dataclass(frozen=True)
class Cells:
    """Bodies of nuclei in a complex.

    Attributes
    ----------
    x : (n, 3) array
        Nuclei [m].
    home : (n,) array
        The convex cell that holds each of them.
    nucleus : (n,) array
        Identities of the nuclei, ascending.
    complex : Complex
        The convex cells.
    keys : (P,) array
        Keys of its planes, see `plane_keys`.
    first : Clipped
        The bodies before any nucleus is excluded from a cell: each a function of its own surroundings, so that the
        next ones can be made from them.
    bodies : Clipped
        The bodies.
    """

    x: FloatArray
    home: IntArray
    nucleus: IntArray
    complex: Complex
    keys: IntArray
    first: Clipped
    bodies: Clipped


def _unchanged(x: FloatArray, nucleus: IntArray, previous: Cells) -> tuple[IntArray, BoolArray]:
    """New number of every previous body, -1 for none, and which of them no change has any influence on."""
    number = np.minimum(np.searchsorted(nucleus, previous.nucleus), len(nucleus) - 1)
    number[nucleus[number] != previous.nucleus] = -1
    stay = number >= 0
    assert np.array_equal(x[number[stay]], previous.x[stay])
    came = np.ones(len(x), np.bool_)
    came[number[stay]] = False
    changed = np.concatenate([x[came], previous.x[~stay]])
    if len(changed):
        stay &= ~within(previous.x, previous.first.reach2, grid_of(changed, 0.0))
    return number, stay


def voronoi_cells(
    x: FloatArray,
    home: IntArray,
    complex_: Complex,
    surfaces: int,
    spacing: FloatArray,
    nucleus: IntArray | None = None,
    previous: Cells | None = None,
) -> Cells:
    """Voronoi cells of nuclei in a complex.

    Parameters
    ----------
    x : (n, 3) array
        Nuclei [m], all different.
    home : (n,) array
        The convex cell that holds each of them.
    complex_ : Complex
        The convex cells.
    surfaces : int
        Number of surfaces; ledges get the next number.
    spacing : (n,) array
        Local spacing [m], a guess of how far neighbours are; it has no influence on the result.
    nucleus : (n,) array, optional
        Identities of the nuclei, ascending; by default their indices.
    previous : Cells, optional
        Cells of other nuclei in the same complex, those of the same identity at the same place. The bodies on which no
        nucleus that came or went has any influence are taken from there; the result is the same, bit for bit.

    Raises
    ------
    ValueError
        Two nuclei coincide, or one lies in no convex cell.
    """
    x, home = np.ascontiguousarray(x), np.ascontiguousarray(home)
    if (home < 0).any():
        raise ValueError("a nucleus lies outside of the specimen")
    nucleus = np.arange(len(x)) if nucleus is None else nucleus
    keys = plane_keys(complex_) if previous is None else previous.keys
    setting = Setting.of(x, home, complex_, keys, spacing, surfaces)
    todo = np.ones(len(x), np.bool_)
    if previous is None:
        first = clipped(todo, setting)
    else:
        assert previous.complex is complex_
        number, stay = _unchanged(x, nucleus, previous)
        todo[number[stay]] = False
        first = previous.first.merged(stay, number, clipped(todo, setting))
    return Cells(x, home, nucleus, complex_, keys, first, settled(first, setting))
