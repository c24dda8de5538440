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
