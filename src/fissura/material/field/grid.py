"""Regular grids over a box, the supports of all expansions."""

from dataclasses import dataclass

import numpy as np

from fissura.arrays import FloatArray

Axes = tuple[FloatArray, FloatArray, FloatArray]


@dataclass(frozen=True)
class Accuracy:
    """How an expansion represents a field; said before its pointwise variance is corrected.

    Attributes
    ----------
    method : str
        What it is.
    nodes, modes : int
        Nodes of its grid, and independent random numbers of a realisation.
    spacing : tuple of float
        Of the grid along the axes [m].
    mean, largest : float
        Variance error, averaged over the specimen and at its largest.
    """

    method: str
    nodes: int
    modes: int
    spacing: tuple[float, float, float]
    mean: float
    largest: float


def counts(size: tuple[float, float, float], spacing: FloatArray) -> list[int]:
    """Nodes along each axis of a grid that ends on the faces of a box and is at most ``spacing`` wide."""
    return [max(int(np.ceil(length / step * (1 - 1e-9))), 1) + 1 for length, step in zip(size, spacing, strict=True)]


def sample(axes: Axes, most: int) -> Axes:
    """Coordinates at which to look at errors: faces, middles of cells and nodes, thinned to so many on each axis."""
    out = []
    for nodes in axes:
        inner = np.stack([nodes[:-1], 0.5 * (nodes[:-1] + nodes[1:])], axis=1).ravel()
        if len(inner) > most - 1:  # odd steps, so that nodes and middles take turns
            step = int(np.ceil(len(inner) / (most - 1))) | 1
            inner = inner[::step]
        out.append(np.append(inner, nodes[-1]))
    return out[0], out[1], out[2]
