"""Every number of this room that decides something: what it limits, and why it has its size."""

#: Share of the stiffness that is left to a broken contact, so that loose bodies keep a position.
INTACT_SHARE = 1e-9

#: Compressive cap over the stress at which it would meet the strength in pure shear, at least.
LEAST_CAP = 1.001

#: Difference of softening moduli that is round-off, relative to the larger one.
ROUND_OFF = 1e-12

#: Share by which bounds and brackets are kept apart from what they bound, so that round-off cannot cross it.
APART = 1e-9
