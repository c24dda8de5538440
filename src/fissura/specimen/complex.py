"""A specimen as a complex of convex cells, in arrays that compiled kernels read."""

from typing import NamedTuple

from fissura.arrays import BoolArray, FloatArray, IntArray


class Complex(NamedTuple):
    """Convex polyhedra whose faces are open to a neighbour or part of a named surface.

    Corners, half-edges and planes of cell ``k`` are numbered within the cell, from 0; its planes come in the order of
    ``plane_start[k]:plane_start[k + 1]``. Half-edges are those of `fissura.specimen.polyhedron`, four places for
    each corner, of which three are used.

    A plane of a cell is divided into convex parts, each open to another cell or on the surface. Where all of a plane is
    one part, that part needs no edges.

    A cell may have rules of sides: a nucleus owns material in the cell only if it lies on the same side of a given
    plane. They keep bodies from reaching around the tip of a notch.

    Attributes
    ----------
    corner_start : (K + 1,) array
        Corners of cell ``k`` are ``corner[:, corner_start[k]:corner_start[k + 1]]``.
    corner : (3, V) array
        Corners [m].
    twin, face : (4 V,) array
        Half-edges of each cell: the opposite half-edge, and the plane on the left.
    plane_start : (K + 1,) array
        Where the planes of each cell begin.
    normal : (P, 3) array
        Outward unit normals of the planes.
    offset : (P,) array
        ``normal @ point`` on each plane [m]. Two cells on either side of one plane have the same numbers but for their
        sign, bit for bit.
    plane_id : (P,) array
        Identity of each plane: the same for all cells that it bounds, on either side.
    opens : (P,) bool array
        Whether a part of the plane is open.
    part_start : (P + 1,) array
        Where the parts of each plane begin.
    part_to : (S,) array
        The cell to which a part is open, or ``-1 - surface``.
    edge_start : (S + 1,) array
        Where the edges of each part begin.
    edge_normal, edge_offset : (E, 3), (E,) array
        A part is where ``edge_normal @ point <= edge_offset`` for all of its edges.
    rule_start : (K + 1,) array
        Where the rules of each cell begin.
    rule_normal, rule_offset : (R, 3), (R,) array
        A nucleus ``x`` is admitted in a cell only if ``rule_normal @ x > rule_offset`` for all of its rules.
    low, high : (K, 3) array
        Bounds of the cells [m].
    extent : float
        Largest dimension of the whole [m], to which round-off is compared.
    """

    corner_start: IntArray
    corner: FloatArray
    twin: IntArray
    face: IntArray
    plane_start: IntArray
    normal: FloatArray
    offset: FloatArray
    plane_id: IntArray
    opens: BoolArray
    part_start: IntArray
    part_to: IntArray
    edge_start: IntArray
    edge_normal: FloatArray
    edge_offset: FloatArray
    rule_start: IntArray
    rule_normal: FloatArray
    rule_offset: FloatArray
    low: FloatArray
    high: FloatArray
    extent: float
