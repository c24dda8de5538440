"""How wrong an adaptive run is, told without a run at full resolution.

Elastic contacts stand for contacts that would be damaged at full resolution once they come near their strength, and the
nearer the coarse part is to the crack, the more its elastic field is off. Over the runs of the study in
``docs/study.md`` the largest elastic utilisation and the radius `r_f` together bound the error of the load.
"""

from __future__ import annotations

__all__ = ["load_error_bound"]

#: Largest difference of the load from full resolution, over the peak load, per unit of the largest utilisation of
#: elastic contacts, with the default radius: 90 % of the runs of the study stay below, more where cracks do not branch.
_PER_UTILISATION = 0.0133

#: The default radius over `l_f`, and the power with which the error falls with the radius.
_RADIUS, _POWER = 6.0, 1.65


def load_error_bound(utilisation: float, radius: float = _RADIUS) -> float:
    """Bound of the error of the load that holds for 90 % of the runs of the study, over the peak load.

    Parameters
    ----------
    utilisation : float
        Largest effective traction over strength among elastic contacts in the whole run.
    radius : float, optional
        ``r_f`` over ``l_f``.
    """
    return float(_PER_UTILISATION * utilisation * (_RADIUS / radius) ** _POWER)
