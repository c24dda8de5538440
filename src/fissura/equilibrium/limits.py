"""Every number of this room that decides something: what it limits, why it has its size, what it was measured by.

Where no script is named, results do not depend on the number within wide bounds; what bounds them is said.
"""

# Supports, platens and loose bodies

#: Supports are this many times stiffer than a typical contact, times the bodies that they hold. The structure resists a
#: support's motion with at most a few contacts of each of these, whatever its size: so supports take at most 4e-5 of
#: its deformation (slabs one body thick between two faces), 1e-5 of cubes, which falls as they grow, and 1e-6 of beams.
#: Round-off stays far below the tolerance of equilibrium, also where contacts have lost their stiffness.
SUPPORT_STIFFNESS = 1e5

#: Bodies up to which a support enters the matrix, as a dense block: as many entries as 240 bodies of the inside have.
NARROW = 60

#: Share of a glued facet's rotational stiffness that contacts keep, also where one of their bodies has few of them.
SPIN_STIFFNESS, SPIN_STIFFNESS_OF_FEW = 1e-6, 1e-4

#: Contacts up to which they are few: bodies at corners and edges have 5 or 6, others 15.
FEW = 6

#: Stiffness that holds platens, over that of their contacts: far below the error of equilibrium.
ANCHOR = 1e-13

#: Tangential stiffness of contacts without friction, over that of glued ones as long as the facet is wide: it keeps the
#: specimen in place (`benchmarks/platens.py`).
TRACE = 1e-5

#: Length of a contact with a platen, at least, in lengths of the facet: nuclei may lie in the surface itself.
SHORTEST = 1e-5

#: Share of the largest possible value of a load or gauge that is zero but for round-off.
NO_VALUE = 1e-9

# Contacts

#: Length at which coarse contacts are asked for their strength, over that of the shortest contact.
SHORT_CONTACT = 1e-3

#: Difference of a tangent from a secant stiffness that is round-off, over the largest modulus.
SAME_STIFFNESS = 1e-13

#: Linear solutions after which contacts that still open and close are left to the next step (`benchmarks/closing.py`).
CLOSINGS = 20

#: Controlled quantity, over the displacements of which it is the difference, that solutions cannot tell from zero.
UNMOVED = 1e-9

# A smooth coarse part (`benchmarks/coarse_part.py`)

#: Tangential over normal stiffness of coarse contacts, at least. With 0.29, that of the material, beams of 400 mm need
#: a fifth more bodies. With 0.7 and 1 they need a twentieth fewer, but errors of the load are half as large again and
#: twice as large: Poisson's ratio falls from 0.18 to 0.12 with 0.5, to 0.06 and 0 with these.
SMOOTH_ALPHA = 0.5

#: Rotational stiffness of coarse contacts over that of a square facet of the macroscopic modulus. Errors of the load
#: are twice as large without it, and a third larger with twice as much.
BENDING = 1.0

# Corrections of a step (`benchmarks/nonlinear.py`)

#: Smallest part of a correction that the line search tries, and share of the residual that a whole one must take away.
SMALLEST_CUT, LEAST_GAIN = 1.0 / 16.0, 0.1

#: Corrections of Newton that hardly reduce the residual before it is left: those that leave more than `HARDLY` of the
#: least one so far, unless they leave less than `LEAP` of the last one: a leap that is made up for at once is one
#: stall, not two. After one, growth of the residual by more than `RUNAWAY` ends them.
STALLS, HARDLY, LEAP, RUNAWAY = 2, 0.7, 0.1, 10.0

#: What then goes on: a mixture of tangent and secant stiffness, with these shares of the tangent in one burst after
#: another, the last one repeated; a burst takes twice as many corrections as the one before. With much of the tangent
#: most jumps of a crack take few corrections, but some never end; the secant stiffness always comes closer, slowly.
SHARES_OF_TANGENT = (0.9, 0.7, 0.5, 0.0)
FIRST_BURST = 4

#: Share of the residual to which Newton must come for its result to be kept.
DID_WELL = 0.5

#: Shares of the energy asked for within which a state that was found while contacts were held is taken.
NEAREST, FARTHEST = 0.1, 10.0

#: Errors, relative to what is asked for, with which a value, an energy and the opening of held contacts count as met:
#: linear in the unknowns, the first is met to round-off by every correction.
VALUE_ERROR, ENERGY_ERROR, HELD_ERROR = 1e-9, 1e-3, 1e-6

# Linear equations of a correction (`benchmarks/nonlinear.py`)

#: Share of the residual that they may leave: half of what would be in equilibrium, within limits; the least exact one
#: only where no energy leads, which makes them nearly singular wherever damage localizes.
EXACTNESS, LEAST_EXACT, MOST_EXACT = 0.5, 0.1, 1e-3

#: Most iterations for one Newton correction.
MOST_ITERATIONS = 60

#: Iterations that one preparation costs, roughly: when as many have been spent on top of what a fresh preparation
#: needs, it is time for one. This never costs more than twice the best choice in hindsight.
PREPARATION = 20

#: A correction that leaves more than this share of the residual is of no use.
USELESS = 0.9

# Lengths of steps (`benchmarks/step_length.py`)

#: A step is easy up to this number of corrections, hard from the second one on; easy steps in a row before the length
#: doubles.
EASY, HARD, EASY_STEPS = 5, 12, 2

#: Share of a step that is round-off of multiples of it.
ALIGNED = 1e-6

#: Share of a leg that is round-off of its end.
AT_END = 1e-9

#: Share of the first step asked for below which it is not shortened for the first contact that comes to its strength.
LEAST_FIRST = 1e-9

# What leads along a path (`benchmarks/step_length.py`, `benchmarks/whole_runs.py`)

#: Energy takes over at once when a step under the gauge fails; while hardly anything is damaged, for which energy is a
#: bad guide, the step is halved so many times before.
ELASTIC_CUTS = 3

#: Where nothing can lead and one cut did not help, corrections follow the jump of a crack to the next equilibrium: they
#: may be this many times as many, in so many attempts, since that is slow.
CUTS, PATIENCE, PATIENT_ATTEMPTS = 1, 15, 3

#: A step under the gauge that loses more than this share of the peak load is a jump, though it converged.
JUMP = 0.2

#: Before the peak, a step that is longer than this share of the way so far is done again with half its length where it
#: leaves less than that share of the load over the controlled quantity: a flat peak lies within it then, which may be
#: missed. What is left out is at most a percent of the load. Loads above `TOP` times the largest one so far count as
#: before the peak.
SHORT_STEP, STIFF, TOP = 0.1, 0.8, 0.99

#: The energy of a step may be halved so many times; the first one is at least the longest one halved so many times.
HALVINGS, FIRST_HALVINGS = 10, 6

#: Steps in a row in which the gauge must grow before it leads again; twice as many each time that it fails within so
#: many steps.
GROWING, MOST_GROWING, SOON = 3, 48, 10

#: Share of the longest energy step that a step must dissipate for the energy to lead from the start of damage on.
DAMAGE_BEGINS = 0.25

#: With energy in the lead a run ends at the latest when this share of the peak load is left; not beside other loads,
#: which the specimen still bears when this one passes through zero.
BROKEN = 0.01
