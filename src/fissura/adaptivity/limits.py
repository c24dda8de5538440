"""Every number of this room that decides something: what it limits, why it has its size, what it was measured by."""

# Elastic calibration (`benchmarks/start_stiffness.py`)

#: Smallest and largest factor on the stiffness of coarse contacts.
SCALES = (0.5, 2.0)

#: Error of the gauge compliance at which calibration ends, and share of it below which the coarse part cannot matter.
ACCURACY, SMALLEST_SHARE = 1e-4, 0.01

#: Solutions after which it ends at the latest: the second one is mostly exact.
MOST_SOLUTIONS = 4

#: Error of one elastic solution in the energy norm; that of its gauge was at most half of it in 18 beams and bars.
TOLERANCE = 1e-4

#: The same where the load and a force at the gauge are solved for: the error of the gauge then goes with the square. It
#: was at most 2e-5.
TOLERANCE_OF_TWO = 3e-3

#: A change of the factor by less than this share needs no check: the slope leaves out 0.15 times its square at most.
SMALL_CHANGE = 0.03

# Elastic calibration of large specimens (`benchmarks/calibration_sequence.py`)

#: Most bodies at full resolution that are solved for: up to here that takes 10 s and 0.9 GB.
LARGEST_SOLVED = 50_000

#: Most bodies of a discretization of the sequence, and most of them that are fine.
MOST_OF_SEQUENCE, MOST_FINE = 40_000, 10_000

#: Coarse spacing over `l_f` with which the sequence begins, unless that leaves more bodies than these; the ratio of
#: one to the next; and the least.
COARSEST, FEWEST_OF_SEQUENCE, RATIO, FINEST = 8.0, 4_000, 2.0**0.5, 1.9

#: Discretizations from which the limit is extrapolated, and most in all.
LEVELS, MOST_LEVELS = 3, 6

#: Radii over `l_f` of what is fine around notch tips, loads, supports and gauges; the largest that is not too large. Up
#: to a radius of this the number of fine bodies cannot be told from that of the one before.
RADII, SURE = (0.0, 2.0, 4.0, 8.0, 12.0, 16.0), 2.0

#: Growth of the spacing with the distance from what is fine.
GRADING = 1.0 / 3.0

#: Stiffness of the surface of the bulk over that of a layer of one spacing, at these ratios `alpha`.
LAYER_AT = (0.01, 0.05, 0.1, 0.2, 0.29, 0.4, 0.6, 0.8, 1.0)
LAYER = (-0.180, -0.0518, -0.0173, 0.0038, 0.0094, 0.0108, 0.0085, 0.0044, 0.0)

#: Error that is always there, of one specimen against the mean of all; and the share of the last change by the radius.
FLOOR, SHARE_OF_RADIUS = 1e-3, 0.5

#: Ratios of stiffness are the same where they differ by less, and where their digits are.
ROUND_OFF, DIGITS = 1e-9, 9

#: Norm of the residual that is left, of that of the load: 1e-4 leaves 5e-6 of the compliance. Vectors that generalized
#: minimal residuals keep, and how often they start.
RESIDUAL, MOST_VECTORS, STARTS = 1e-4, 100, 5

# Coarsening (`benchmarks/adaptivity.py`)

#: Steps between two changes of the discretization: a region that has just grown is still needed.
PAUSE = 3

#: Least share of the fine bodies, and least number of bodies, that coarsening must save: a re-tessellation costs about
#: as much as two steps.
SAVING, FEWEST = 0.25, 100

#: A body has unloaded when the strain energy of its contacts is below this share of what it would be at the largest
#: strain of each.
UNLOADED = 0.75

# Bound of the error (``docs/study.md``)

#: Largest difference of the load from full resolution, over the peak load, per unit of the largest utilisation of
#: elastic contacts, with the default radius: 90 % of the runs of the study stay below, more where cracks do not branch.
PER_UTILISATION = 0.0133

#: The default radius over `l_f`, and the power with which the error falls with the radius.
RADIUS, POWER = 6.0, 1.65
