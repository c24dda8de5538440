"""The standard Gaussian distribution, far out in its tails, too."""

import numpy as np
from scipy.special import log_ndtr

ROOT_2_PI = np.sqrt(2.0 * np.pi)


def hazard(a: float) -> float:
    """Hazard ``phi(a) / Phi(-a)`` of the standard Gaussian."""
    return float(np.exp(-0.5 * a * a - log_ndtr(-a)) / ROOT_2_PI)
