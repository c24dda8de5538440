"""How wrong an adaptive run is, told without a run at full resolution.

Elastic contacts stand for contacts that would be damaged at full resolution once they come near their strength. Over
the runs of the study in ``docs/adaptivity.md`` the largest elastic utilisation bounds the error of the load.
"""

from __future__ import annotations

__all__ = ["ERROR_PER_UTILISATION", "load_error_bound"]

#: Largest difference of the load from full resolution, over the peak load, per unit of the largest utilisation of
#: elastic contacts: 95 % of the runs of the study stay below.
ERROR_PER_UTILISATION = 0.013


def load_error_bound(utilisation: float) -> float:
    """Bound of the error of the load that holds for 95 % of the runs of the study, over the peak load.

    Parameters
    ----------
    utilisation : float
        Largest effective traction over strength among elastic contacts in the whole run.
    """
    return ERROR_PER_UTILISATION * utilisation
