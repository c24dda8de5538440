"""The peak of a curve: the load of largest magnitude, with its sign."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fissura.errors import Notice
from fissura.text.quantities import force, length

__all__ = ["negative_before_peak", "peak_position"]

#: Share of the largest load below which a load is none.
_ROUND_OFF = 1e-6

FloatArray = NDArray[np.float64]


def peak_position(load: FloatArray) -> int:
    """Position of the load of largest magnitude, the first one of several; shape (steps,), at least one step."""
    return int(np.abs(load).argmax())


def negative_before_peak(load: FloatArray, gauge: FloatArray) -> list[Notice]:
    """Whether the load of a run was negative before its peak, or at it.

    The first stiffness is positive, so this is never asked for: the load then pushes a specimen forwards that has come
    loose, or pulls back one that is deforming too far.

    Parameters
    ----------
    load, gauge : (steps,) array
        Loads [N] and gauges [m] of a run with at least one step.
    """
    until = peak_position(load) + 1
    negative = np.flatnonzero(load[:until] < -_ROUND_OFF * np.abs(load).max())
    if not len(negative):
        return []
    first, least = int(negative[0]), float(load[:until].min())
    return [
        Notice(
            "load",
            f"it was negative before the peak in {len(negative)} of {until} steps, first at step {first + 1} "
            f"(gauge {length(float(gauge[first]))}), down to {force(least)}: there it acted against its direction",
            "look at the cracks: the gauge may not see the one that opens; place it across that, or let dissipation or"
            " the displacement of the load lead (control.type)",
        )
    ]
