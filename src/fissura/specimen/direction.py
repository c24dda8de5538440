"""A load that moves the gauge backwards: which key of the case is to be turned."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fissura.errors import InputError

if TYPE_CHECKING:
    from fissura.specimen.conditions import Conditions

__all__ = ["backward_gauge"]


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
