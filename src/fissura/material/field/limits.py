"""Every number of this room that decides something: what it limits, and why it has its size.

`benchmarks/random_field.py` measures errors and costs of fields.
"""

# Grid, and which expansion

#: Grid over correlation length, and by how much it shrinks while the variance error is too large.
SPACING, SHRINK = 1.0 / 3.0, 0.8

#: Most nodes for all eigenpairs of a grid, and for products of one-dimensional ones: beyond them circulant embedding
#: costs less for each point.
DENSE, SEPARABLE = 300, 20_000

#: Most nodes of a torus: as many as take about a gigabyte, and as many as a finer grid may have that only the variance
#: error asks for.
MOST, MOST_FINER = 1 << 24, 1 << 21

#: Correlation at which a torus closes while its nodes are only counted.
COUNTED = 1e-4

#: Variance error from which on the variance that is left is round-off, and cannot be corrected.
NOTHING_LEFT = 1.0 - 1e-9

# Eigenpairs

#: Eigenvalues below this share of the largest are round-off; so is the variance that modes give from this decimal on.
ROUND_OFF, DECIMALS = 1e-11, 12

#: Most coordinates on an axis for mean values, and for the largest error: of a whole grid, and of one axis.
MEANS, LOOKS = 12, 8
MEANS_OF_AXIS, LOOKS_OF_AXIS = 400, 24

#: Modes of one axis that give less variance than this share of the error allowed cannot be among those kept.
NEGLIGIBLE = 1e-3

# Circulant embedding

#: Nodes along an axis from which the field is estimated.
STENCIL = 4

#: Correlation at which the torus closes at first and at the latest, and share of negative eigenvalues, which are set to
#: zero, that is accepted.
CLOSES, CLOSED, NEGATIVE = 1e-3, 1e-8, 1e-4

#: Points in a cell, along an axis, at which the error is looked at.
LOOKS_IN_CELL = 9

# Correlation

#: Intervals of the table from which kernels read a correlation, and the correlation at which it ends.
INTERVALS, NO_CORRELATION = 4096, 1e-10

#: Largest order: beyond it Matérn's correlation is as good as ``exp(-d^2/2)``, and its Bessel function overflows.
LARGEST_ORDER = 50.0

# Memory

#: Numbers in an array of a chunk, points times nodes; points that are evaluated together, between the nodes of a torus
#: and from modes of axes; and points whose values are kept at once while marginals are applied.
CHUNK, CHUNK_OF_CELLS, CHUNK_OF_AXES, CHUNK_OF_POINTS = 1 << 20, 8192, 4096, 1 << 16

# Marginal distributions

#: Scatter of Weibull's distribution: between shapes of 1000 and 0.5.
WEIBULL = (0.00128, 2.236)

#: With a bound that many deviations above the centre, a truncated Gaussian is as good as exponential.
FAR = 30.0

#: Places of the graft, in deviations of the core from its centre; and probabilities there may be.
GRAFTS, GRAFTED = (-12.0, 12.0), (1e-12, 0.5)
