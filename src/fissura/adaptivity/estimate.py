"""How wrong an adaptive run is, told without a run at full resolution.

Elastic contacts stand for contacts that would be damaged at full resolution once they come near their strength, and the
nearer the coarse part is to the crack, the more its elastic field is off. Over the runs of the study in
``docs/study.md`` the largest elastic utilisation and the radius `r_f` together bound the error of the load.
"""

from fissura.adaptivity import limits


def load_error_bound(utilisation: float, radius: float = limits.RADIUS, calibration: float = 0.0) -> float:
    """Bound of the error of the load that holds for 90 % of the runs of the study, over the peak load.

    Parameters
    ----------
    utilisation : float
        Largest effective traction over strength among elastic contacts in the whole run.
    radius : float, optional
        ``r_f`` over ``l_f``.
    calibration : float, optional
        Relative error of the compliance that elastic calibration met: all loads before the peak share it.
    """
    return float(limits.PER_UTILISATION * utilisation * (limits.RADIUS / radius) ** limits.POWER) + calibration
