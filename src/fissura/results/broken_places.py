"""Whether a specimen broke at the places of load and supports rather than inside."""

from __future__ import annotations

import math
import re

from fissura.errors import Notice
from fissura.results.curve import Curve
from fissura.results.load_path import ROUND_OFF

__all__ = ["MOST", "torn_at_places"]

MOST = 0.5
"""Share of the dissipated energy from which on a specimen broke at the places of load and supports."""


ALL = "dissipated_at_places_J"
"""Column of the energy at all places."""


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
