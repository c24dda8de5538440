"""Gauges that do not measure what they are meant to: they get smaller under the load, or do not see the notch."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fissura.errors import InputError, Notice
from fissura.specimen.notch import AXES

if TYPE_CHECKING:
    from fissura.case import Case
    from fissura.specimen.conditions import Conditions

__all__ = ["backward_gauge", "gauge_notices"]


def gauge_notices(case: Case, conditions: Conditions) -> tuple[Notice, ...]:
    """Whether a gauge has both of its ends on one side of the only notch.

    Gauges that measure along the plane of the notch, such as a deflection, are left alone.

    Parameters
    ----------
    case : Case
        Where the notch is.
    conditions : Conditions
        Where the gauge is.
    """
    gauge = conditions.gauge
    if gauge is None or len(case.notch) != 1:
        return ()
    (notch,) = case.notch
    axis = AXES[notch.normal]
    beyond = gauge.points[:, axis] - notch.position
    if not (np.all(beyond > 0.0) or np.all(beyond < 0.0)) or not np.any(gauge.coefficients[:, axis]):
        return ()
    return (
        Notice(
            "gauge",
            f"both ends lie on one side of the notch at {notch.normal} = {1e3 * notch.position:.6g} mm, so it does not"
            " measure how the notch opens",
            "place gauge.a and gauge.b on different sides of the notch",
        ),
    )


def backward_gauge(conditions: Conditions, stiffness: float) -> InputError:
    """Error about a gauge that gets smaller under the load, so that it could only grow under a negative one.

    Parameters
    ----------
    conditions : Conditions
        They are controlled by the gauge.
    stiffness : float
        Load over gauge of the undamaged structure [N/m], negative.

    Returns
    -------
    InputError
        It names ``load.direction`` where that pulls the specimen outwards, else ``gauge.direction``.
    """
    first = conditions.control.coefficients[0]  # of a point of b
    along = first / np.linalg.norm(first)
    turned = ", ".join(f"{-value + 0.0:.4g}" for value in along)
    problem = (
        f"the gauge gets smaller under the load (load over gauge is {stiffness:.3g} N/m at first), so it could only"
        " grow to control.target under a negative load"
    )
    measure = f"gauge.direction = [{turned}] counts what it gets smaller by as positive"
    if conditions.pulls:
        return InputError(
            "load.direction",
            f"it pulls the specimen outwards, and {problem}",
            f"without it the load presses into the specimen; if it is to pull, {measure}",
        )
    return InputError("gauge.direction", problem, f"{measure}; if the specimen is to be pulled, turn load.direction")
