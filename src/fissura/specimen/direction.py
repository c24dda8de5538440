"""A load that moves the gauge backwards: which key of the case is to be turned."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fissura.errors import InputError
from fissura.specimen.notch import FACES

if TYPE_CHECKING:
    from fissura.case import Case
    from fissura.specimen.conditions import Functional

__all__ = ["backward_gauge"]


def backward_gauge(case: Case, gauge: Functional, stiffness: float) -> InputError:
    """Error about a gauge that gets smaller under the load, so that it could only grow under a negative one.

    Parameters
    ----------
    case : Case
        What is loaded; it is controlled by its gauge.
    gauge : Functional
        The gauge.
    stiffness : float
        Load over gauge of the undamaged structure [N/m], negative.

    Returns
    -------
    InputError
        It names ``load.direction`` where that pulls the specimen outwards, else ``gauge.direction``.
    """
    along = gauge.coefficients[0] / np.linalg.norm(gauge.coefficients[0])  # the first points are those of b
    turned = ", ".join(f"{-value + 0.0:.4g}" for value in along)
    problem = (
        f"the gauge gets smaller under the load (load over gauge is {stiffness:.3g} N/m at first), so it could only"
        " grow to control.target under a negative load"
    )
    measure = f"gauge.direction = [{turned}] counts what it gets smaller by as positive"
    axis, side = FACES[case.load.face]
    direction = case.load.direction
    if direction is not None and direction[axis] * (2.0 * side - 1.0) > 0.0:
        return InputError(
            "load.direction",
            f"it pulls the specimen outwards, and {problem}",
            f"without it the load presses into the specimen; if it is to pull, {measure}",
        )
    return InputError("gauge.direction", problem, f"{measure}; if the specimen is to be pulled, turn load.direction")
