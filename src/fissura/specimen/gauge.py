"""Gauges that do not measure what they are meant to: they get smaller under the load, or do not see the notch."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fissura.errors import InputError, Notice

if TYPE_CHECKING:
    from fissura.specimen.conditions import Conditions
    from fissura.specimen.domain import Domain
    from fissura.specimen.notches import Notch


def gauge_notices(domain: Domain, conditions: Conditions) -> tuple[Notice, ...]:
    """Whether a gauge has both of its ends on one side of the only notch.

    Gauges that measure along the plane of the notch, such as a deflection, are left alone.

    Parameters
    ----------
    domain : Domain
        Where the notch is.
    conditions : Conditions
        Where the gauge is.
    """
    if len(domain.notches) != 1:
        return ()
    (notch,) = domain.notches
    found = []
    for key, gauge in zip(conditions.gauge_keys, conditions.gauges, strict=True):
        beyond = notch.across(gauge.points)
        opening = np.abs(gauge.coefficients @ notch.normal)
        across = bool((opening > 1e-9 * np.linalg.norm(gauge.coefficients, axis=1).max()).any())
        if not (np.all(beyond > 0.0) or np.all(beyond < 0.0)) or not across:
            continue
        where = _place(notch)
        found.append(
            Notice(
                key,
                f"both ends lie on one side of the notch at {where}, so it does not measure how the notch opens",
                f"place {key}.a and {key}.b on different sides of the notch",
            )
        )
    return tuple(found)


def _place(notch: Notch) -> str:
    """Where the mid-plane of a notch is, in words."""
    axis = int(np.argmax(np.abs(notch.normal)))
    if abs(notch.normal[axis]) > 1.0 - 1e-9:
        return f"{'xyz'[axis]} = {1e3 * notch.point[axis]:.6g} mm"
    return f"({', '.join(f'{1e3 * v:.6g}' for v in notch.front.mean(axis=0))}) mm"


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
    gauge, main = conditions.main.gauge, conditions.main
    assert gauge is not None
    first = conditions.gauges[gauge].coefficients[0]  # of a point of b
    along = first / np.linalg.norm(first)
    turned = ", ".join(f"{-value + 0.0:.4g}" for value in along)
    problem = (
        f"the gauge gets smaller under the load (load over gauge is {stiffness:.3g} N/m at first), so it could only"
        " grow to its target under a negative load"
    )
    key, load = conditions.gauge_keys[gauge], conditions.load_keys[int(np.argmax(main.ratios != 0.0))]
    measure = f"{key}.direction = [{turned}] counts what it gets smaller by as positive"
    if conditions.pulls:
        return InputError(
            f"{load}.direction",
            f"it pulls the specimen outwards, and {problem}",
            f"without it the load presses into the specimen; if it is to pull, {measure}",
        )
    return InputError(f"{key}.direction", problem, f"{measure}; if the specimen is to be pulled, turn {load}.direction")
