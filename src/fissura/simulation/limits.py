"""Every number of this room that decides something: what it limits, and why it has its size."""

# Legs of the loading programme

#: Steps of a leg to a share of a load as long as it unloads, else to a share or to zero, and of the weight, and what is
#: left of one when a run is given up (`benchmarks/loading.py`).
UNLOADING_STEPS, STEPS, WEIGHT_STEPS, SMALLEST_STEP = 10, 50, 4, 1e-4

#: Share of loads, and of values of a controlled quantity, that is round-off: where they differ by less, loads are in
#: the same ratios, and a leg leads nowhere.
NO_WAY = 1e-12

# The start

#: Error of the initial stiffness that is accepted after calibration (`benchmarks/start_stiffness.py`).
STIFFNESS_ERROR = 0.02

#: Share of the elastic energy in the trace of friction of a platen from which on the specimen slides on it
#: (`benchmarks/platens.py`).
SLIDING = 0.2

# A step (`benchmarks/step_length.py`)

#: Share of the peak load below which residuals are no longer measured against the current load.
LEAST_LOAD = 0.05

#: Extrapolation in steps, at most; where energy leads and there is nothing to extrapolate from, the factor on a state
#: for contacts to go on being damaged, and the largest one that a guess may put on the load.
FARTHEST, PAST, PAST_AIM = 4.0, 1.001, 1.2

#: Share of the value to be reached below which a state is too near to rest to be scaled to it.
NEAR_REST = 1e-6

#: Refinements of one step before the run is given up; each must add bodies, so this only stops a runaway.
MOST_REFINEMENTS = 60

#: Corrections up to which a step has followed its path: most take two or three, where much damage begins up to eight.
FOLLOWED = 8

# Memory

#: Most bodies of a specimen, and memory of a nucleus while they are placed [bytes] (`benchmarks/tessellation.py`).
MOST_BODIES, BYTES_PER_NUCLEUS = 5e7, 400.0

#: Saturated nuclei in a cube of side ``l_f``, and fewest nuclei of a file with which no gap is left, over those: the
#: thinnest lattice of balls that cover space has 1.4635/(4 pi/3) of them for each such cube.
SATURATED = 0.734
SPARSEST = 0.349 / SATURATED

#: The same for nuclei in blocks (`benchmarks/placement.py`).
IN_BLOCKS = 0.740

#: Points along each axis by which the share of regions in a specimen is counted: only its order matters.
LATTICE = 20

#: Distance in `l_f` from a place within which its body has its nucleus: within 1 there is one, but it may lie across a
#: notch, and the nearest on the place's own side as far again.
NEAR_PLACES = 3.0

#: Memory of a run, and of one elastic solution at full resolution, for each body and besides [bytes].
BYTES_OF_RUN, BYTES_OF_SOLUTION, BYTES_BESIDES = 35e3, 12e3, 300e6
