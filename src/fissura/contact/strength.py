"""Both strength surfaces of the law of Cusatis & Cedolin, and where they meet (theory section 3)."""

import numpy as np
from scipy.optimize import brentq

from fissura.arrays import FloatArray
from fissura.contact import limits
from fissura.errors import InputError
from fissura.kernels import njit
from fissura.material import Material


@njit()
def tension_shear_strength(sin, cos, alpha, f_t, f_s, mu):  # type: ignore[no-untyped-def]
    """Strength and its derivative to omega for ``s_T^2 = (f_t - s_N)(f_s^2/f_t - mu^2 s_N)``."""
    b = f_s * f_s / f_t + mu * mu * f_t
    root = np.sqrt(b * b * sin * sin + 4.0 * f_s * f_s * (alpha * cos * cos - mu * mu * sin * sin))
    f = 2.0 * f_s * f_s / (b * sin + root)
    slope = (b * b - 4.0 * f_s * f_s * (alpha + mu * mu)) * sin * cos / root
    return f, -f * (b * cos + slope) / (b * sin + root)


@njit()
def compression_strength(sin, cos, alpha, f_c, beta):  # type: ignore[no-untyped-def]
    """Strength and its derivative to omega for ``s_N^2 + s_T^2 / beta = f_c^2``."""
    g2 = sin * sin + alpha * cos * cos / beta
    f = f_c / np.sqrt(g2)
    return f, -f * (1.0 - alpha / beta) * sin * cos / g2


def lowest_strength(material: Material) -> float:
    """Effective stress below which no contact of unit relative strength is damaged, whatever its direction [Pa].

    The surface under tension and shear is convex: a chord from tension to shear is below it, and under compression it
    bears more than without. The cap is an ellipse.
    """
    m = material
    shear = m.f_s / np.sqrt(m.alpha)
    tension = min(m.f_t, (m.f_s / m.mu) ** 2 / m.f_t) if m.mu > 0.0 else m.f_t
    chord = tension * shear / np.hypot(tension, shear)
    cap = m.f_c * min(1.0, np.sqrt(m.beta / m.alpha))
    return (1.0 - limits.APART) * float(min(chord, cap))


def transition_angle(material: Material) -> float:
    """Angle ``omega_0 < 0`` at which both strength surfaces meet [rad].

    Raises
    ------
    InputError
        The surfaces do not meet under compression.
    """
    m = material

    def gap(omega: float) -> float:
        sin, cos = np.sin(omega), np.cos(omega)
        shear, _ = tension_shear_strength(sin, cos, m.alpha, m.f_t, m.f_s, m.mu)
        cap, _ = compression_strength(sin, cos, m.alpha, m.f_c, m.beta)
        return float(shear - cap)

    low = (
        -np.arctan(np.sqrt(m.alpha) / m.mu) * (1.0 - limits.APART) if m.mu > 0 else -0.5 * np.pi * (1.0 - limits.APART)
    )
    least = limits.LEAST_CAP * m.f_s / np.sqrt(m.beta)
    if m.f_c < least or gap(low) <= 0.0:
        raise InputError(
            "material.f_c",
            f"{m.f_c:g} Pa: the compressive cap does not meet the shear strength under compression",
            f"{least:g} Pa or more, {limits.LEAST_CAP:g} f_s/sqrt(beta)",
        )
    return float(brentq(gap, low, 0.0, xtol=1e-15, rtol=1e-14))


@njit()
def _utilisation(strain, scale, par, out):  # type: ignore[no-untyped-def]
    E, alpha, f_t, f_s, f_c, _, mu, beta, _, omega0, _, _, _ = par
    for c in range(len(strain)):
        p = strain[c, 0]
        q = np.sqrt(alpha * (strain[c, 1] ** 2 + strain[c, 2] ** 2))
        e = np.sqrt(p * p + q * q)
        out[c] = 0.0
        if e > 0.0:
            if np.arctan2(p, q) < omega0:
                f, _ = compression_strength(p / e, q / e, alpha, f_c * scale[c], beta)
            else:
                f, _ = tension_shear_strength(p / e, q / e, alpha, f_t * scale[c], f_s * scale[c], mu)
            out[c] = E * e / f


def utilisations(strain: FloatArray, scale: FloatArray, parameters: tuple[float, ...]) -> FloatArray:
    """Elastic effective traction over strength, ``E e / f_eff(omega)``; shape (m,).

    Parameters
    ----------
    strain : (m, 3) array
        ``e_N, e_M, e_L``.
    scale : (m,) array
        Relative strength.
    parameters : tuple of float
        See :class:`~fissura.contact.law.CusatisCedolin`.
    """
    out = np.empty(len(strain))
    _utilisation(strain, scale, parameters, out)
    return out
