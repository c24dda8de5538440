"""Whether a specimen broke at the places of load and supports rather than inside."""

from __future__ import annotations

import math

from fissura.errors import Notice
from fissura.results.curve import Curve
from fissura.results.path import ROUND_OFF

__all__ = ["MOST", "torn_at_places"]

MOST = 0.5
"""Share of the dissipated energy from which on a specimen broke at the places of load and supports."""


def torn_at_places(curve: Curve) -> list[Notice]:
    """Whether most of the energy was dissipated by contacts of the bodies on which the load or the supports act.

    Then single bodies were pulled out or crushed, which ends a run like a crack through the specimen would.

    Parameters
    ----------
    curve : Curve
        Curve of a run; see `fissura.results.curve.support_columns`.
    """
    column = "dissipated_at_{}_J"
    if column.format("load") not in curve or not len(curve["step"]):
        return []
    dissipated, work = (abs(float(curve[name][-1])) for name in ("dissipated_J", "work_J"))
    everywhere = float(curve["dissipated_at_places_J"][-1])
    if dissipated <= ROUND_OFF * work or everywhere <= MOST * dissipated:
        return []
    supports = [name for name in curve if name.startswith("dissipated_at_support_")]
    keys = {column.format("load"): "load"} | {name: f"supports[{k}]" for k, name in enumerate(supports)}
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
