"""What looks wrong in the curve of a run: a load that turned round, places that broke, refinement that came late."""

import math
import re

import numpy as np

from fissura.arrays import FloatArray
from fissura.case import Case
from fissura.errors import Notice
from fissura.results.curve import Curve, peak_position
from fissura.results.load_path import ROUND_OFF
from fissura.text.quantities import force, length

NO_LOAD = 1e-6
"""Share of the largest load below which a load is none."""

MOST = 0.5
"""Share of the dissipated energy from which on a specimen broke at the places of load and supports."""

ALL = "dissipated_at_places_J"
"""Column of the energy at all places."""


def curve_notices(case: Case, curve: Curve, bound: float | None) -> list[Notice]:
    """What looks wrong in the curve of a run, whose load error has this bound."""
    pushes = len(curve["step"]) and _pushes(case)
    found = negative_before_peak(curve["load_N"], curve["gauge_m"]) if pushes else []
    return [*found, *torn_at_places(curve), *refined_late(curve), *_beyond(case.adaptivity.tolerance, bound)]


def _pushes(case: Case) -> bool:
    """Whether nothing but a fault makes the load of a case negative: one load, which is never to be turned round."""
    alone = case.gravity is None and len({stage.ratios for stage in case.stages}) == 1
    return alone and all(target.value >= 0.0 for stage in case.stages for target in stage.targets)


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
    negative = np.flatnonzero(load[:until] < -NO_LOAD * np.abs(load).max())
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


def torn_at_places(curve: Curve) -> list[Notice]:
    """Whether most of the energy was dissipated by contacts of the bodies on which the load or the supports act.

    Then single bodies were pulled out or crushed, which ends a run like a crack through the specimen would.

    Parameters
    ----------
    curve : Curve
        Curve of a run; see `fissura.results.curve.case_columns`.
    """
    column = re.compile(r"dissipated_at_(load|support)(?:_(.+))?_J")
    keys = {name: _key(*found.groups()) for name in curve if name != ALL and (found := column.fullmatch(name))}
    if not keys or not len(curve["step"]):
        return []
    dissipated, work = (abs(float(curve[name][-1])) for name in ("dissipated_J", "work_J"))
    everywhere = float(curve[ALL][-1])
    if dissipated <= ROUND_OFF * work or everywhere <= MOST * dissipated:
        return []
    shares = {key: float(curve[name][-1]) / dissipated for name, key in keys.items()}
    ordered = sorted(shares, key=lambda key: -shares[key])
    told = ", ".join(f"{100 * shares[key]:.0f} % at {key}" for key in ordered if shares[key] >= 0.005)
    return [
        Notice(
            ordered[0],
            f"{math.floor(100 * everywhere / dissipated)} % of the energy was dissipated by contacts of the bodies on"
            f" which load and supports act ({told}): bodies were torn out or crushed there, and the peak need not be"
            " that of the specimen",
            "a wider place, or a zone without damage around it (material.elastic)",
        )
    ]


def _key(kind: str, name: str | None) -> str:
    """Where the case has a place."""
    if name is None:
        return kind
    return f"supports[{name}]" if kind == "support" else f"loads.{name}"


def refined_late(curve: Curve) -> list[Notice]:
    """Whether elastic contacts went beyond their strength."""
    used = curve["max_elastic_utilisation"]
    late = np.flatnonzero(used > 1.0)
    if not len(late):
        return []
    worst = late[np.argmax(used[late])]
    problem = (
        f"elastic contacts reached {used[worst]:.2f} times their strength at step {curve['step'][worst]} "
        f"(gauge {length(float(curve['gauge_m'][worst]))}): refinement came too late there; "
        f"they exceeded it in {len(late)} of {len(used)} steps"
    )
    return [
        Notice("adaptivity.gamma", problem, "a smaller adaptivity.gamma or a larger adaptivity.r_f refines earlier")
    ]


def _beyond(tolerance: float | None, bound: float | None) -> list[Notice]:
    """What to say where the error may be larger than a case allows."""
    if tolerance is None or bound is None or bound <= tolerance:
        return []
    problem = f"the estimated load error is {bound:.2%} of the peak, more than the tolerance of {tolerance:.2%}"
    return [Notice("adaptivity.tolerance", problem, "a smaller tolerance refines earlier")]
