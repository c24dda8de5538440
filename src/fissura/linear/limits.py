"""Every number of this room that decides something: what it limits, why it has its size, what it was measured by.

Where no other script is named, that is `benchmarks/linear_solvers.py`. Kernels take theirs by name.
"""

# Which solver, and how exact

#: From this number of bodies on the two-level solver is chosen. For one elastic solution the two cross between 500 and
#: 1000 bodies; as the preconditioner of whole runs it is faster from 500 on.
LARGE = 500

#: Error of iterative solutions in the energy norm, and iterations after which they are given up.
TOLERANCE, MOST_ITERATIONS = 1e-8, 500

# Two-level solver

#: Fine bodies in the largest cluster: with more of them iterations grow, with fewer the coarse matrix.
CLUSTER = 50

#: Share of its stiffness that a contact must keep to hold a cluster together.
INTACT = 0.05

#: Share of the bodies that are fine, at least, wherever there are fine and coarse ones.
FINE = 0.25

#: Residuals, relative to the sizes of all terms of their equations, that are round-off if restarts do not reduce them.
ROUND_OFF = 1e-11

#: Starts from the true residual; more than one when the residual carried along has drifted from it. A start ends when
#: the energy of its error is estimated to be half of what is allowed.
STARTS, ENDED = 4, 0.5

#: Bodies from which on there are two and four domains: below, starting threads costs more than they save, and the tail
#: would be a large part of the structure.
TWO_DOMAINS, FOUR_DOMAINS = 15_000, 30_000

# Incomplete Cholesky factors

#: Smallest pivot in shares of the diagonal entry it came from. Rotations of loosely held bodies are legitimately 1e-6
#: of their neighbours' stiffness, and next to supports another 1e-5.
SMALLEST_PIVOT = 1e-14

#: Shares of the diagonal that are added, one after the other, until all pivots are positive definite (Manteuffel 1980).
SHARES = (0.0, 0.01, 0.05, 0.2, 1.0)

#: Blocks that are asked for before their turn: matrices do not fit into caches, and short loops hide no waiting
#: (`benchmarks/simd.py`).
AHEAD = 16

#: What compilers may do with sums: take them in any order, always the same one in one build; and with products of
#: blocks more than that.
ANY_ORDER = {"reassoc", "contract"}
FAST = {*ANY_ORDER, "nsz", "arcp"}

# Generalized minimal residuals

#: Share of a vector that is round-off after others have been taken out of it.
NOTHING_NEW = 1e-13

#: Vectors from this size on are cut into so many pieces: four domains of 30 000 bodies.
LONG, CUT = 6 * FOUR_DOMAINS, 4

# Direct solvers

#: Pivots of SuperLU are taken from the diagonal unless they are smaller than this share of their column; always in
#: symmetric matrices.
PIVOT = 0.01

# Smoothed aggregation

#: Share of their stiffness that supports keep in the hierarchy: it makes them about as stiff as contacts.
SOFT = 1e-4

#: Springs on bodies of wide supports in the hierarchy, relative to their own stiffness.
SPRING = 1e-2
