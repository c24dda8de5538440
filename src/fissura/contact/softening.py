"""Tractions, damage and tangent of contacts under the law of Cusatis & Cedolin (theory section 3)."""

import numpy as np

from fissura.contact.limits import INTACT_SHARE
from fissura.contact.strength import compression_strength, tension_shear_strength
from fissura.kernels import INNER, njit


@njit(**INNER)
def _surface(omega, sin, cos, e, e_max, scale, k_t, n_t, par):  # type: ignore[no-untyped-def]
    """Strength and softening modulus with derivatives to omega; the strain that counts, and the share of `e` in it."""
    _, alpha, f_t, f_s, f_c, k_c, mu, beta, n_c, omega0, _, _, _ = par
    if omega < omega0:
        f, df = compression_strength(sin, cos, alpha, f_c * scale, beta)
        base = (omega + 0.5 * np.pi) / (omega0 + 0.5 * np.pi)
        power = base**n_c
        k = k_c * (1.0 - power)
        dk = -k_c * n_c * power / (omega + 0.5 * np.pi) if base > 0.0 else 0.0
        return f, df, k, dk, e, 1.0
    f, df = tension_shear_strength(sin, cos, alpha, f_t * scale, f_s * scale, mu)
    base = (omega - 0.5 * np.pi) / (omega0 - 0.5 * np.pi)
    power = base**n_t if base > 0.0 else 0.0
    k = -k_t * (1.0 - power)
    dk = k_t * n_t * power / (omega - 0.5 * np.pi) if base > 0.0 else 0.0
    weight = omega / omega0 if omega < 0.0 else 0.0
    return f, df, k, dk, e * weight + e_max * (1.0 - weight), weight


@njit(**INNER)
def _bound(f, k, excess, tail, steep, flat):  # type: ignore[no-untyped-def]
    """Largest stress, and how much faster it falls with the excess of strain than one exponential."""
    if excess > 0.0 and (tail == 0.0 or k >= 0.0):
        return f * np.exp(k / f * excess), 1.0
    if excess > 0.0:  # two exponentials
        first, last = (1.0 - tail) * np.exp(steep * k / f * excess), tail * np.exp(flat * k / f * excess)
        return f * (first + last), (steep * first + flat * last) / (first + last)
    return f, 1.0


@njit(**INNER)
def _fill(c, strain, damage, d, E, alpha, traction, tangent, with_tangent):  # type: ignore[no-untyped-def]
    """Tractions, and the tangent for the derivatives `d` of damage."""
    intact = 1.0 - damage
    traction[c, 0] = intact * E * strain[c, 0]
    traction[c, 1] = intact * alpha * E * strain[c, 1]
    traction[c, 2] = intact * alpha * E * strain[c, 2]
    if with_tangent:
        for a in range(3):
            s = E if a == 0 else alpha * E
            for b in range(3):
                tangent[c, a, b] = -s * strain[c, a] * d[b]
            tangent[c, a, a] += intact * s


@njit()
def respond(  # type: ignore[no-untyped-def]
    strain, history, scale, k_t, n_t, par, lowest, traction, new, tangent, with_tangent
):
    """Fill in tractions (m, 3), new history (m, 3), and where asked for the tangent (m, 3, 3)."""
    E, alpha, _, _, _, _, _, _, _, omega0, tail, steep, flat = par
    root_alpha = np.sqrt(alpha)
    d = np.zeros(3)
    for c in range(len(strain)):
        p = strain[c, 0]
        e_t = np.sqrt(strain[c, 1] ** 2 + strain[c, 2] ** 2)
        damage = history[c, 0]
        top_n, top_t = max(history[c, 1], p), max(history[c, 2], e_t)
        new[c, 1], new[c, 2] = top_n, top_t
        # Most contacts are far from their strength: nothing more is asked about these.
        far = lowest * scale[c] / E
        if max(p * p, top_n * top_n) + alpha * top_t * top_t < far * far:
            new[c, 0] = damage
            for a in range(3):
                s = (1.0 - damage) * E if a == 0 else (1.0 - damage) * alpha * E
                traction[c, a] = s * strain[c, a]
                if with_tangent:
                    for b in range(3):
                        tangent[c, a, b] = 0.0
                    tangent[c, a, a] = s
            continue
        q = root_alpha * e_t
        e = np.sqrt(p * p + q * q)
        d[0], d[1], d[2] = 0.0, 0.0, 0.0  # derivatives of damage
        if e > 0.0:
            sin, cos = p / e, q / e
            omega = np.arctan2(p, q)
            e_max = np.sqrt(top_n * top_n + alpha * top_t * top_t)
            f, df, k, dk, chi, weight = _surface(omega, sin, cos, e, e_max, scale[c], k_t[c], n_t[c], par)
            excess = chi - f / E
            bound, rate = _bound(f, k, excess, tail, steep, flat)
            trial = 1.0 - bound / (E * e)
            if trial > damage:
                damage = min(trial, 1.0 - INTACT_SHARE)
                if trial <= 1.0 - INTACT_SHARE and with_tangent:
                    w_p, w_q = cos / e, -sin / e  # derivatives of omega
                    log_w = df / f
                    log_p, log_q = 0.0, 0.0
                    if excess > 0.0:
                        log_w += rate * ((dk - k * df / f) / f * excess - k / f * df / E)
                        # chi = e weight + e_max (1 - weight)
                        m_p = top_n / e_max if (e_max > 0.0 and p >= history[c, 1] and p > 0.0) else 0.0
                        m_q = root_alpha * top_t / e_max if (e_max > 0.0 and e_t >= history[c, 2]) else 0.0
                        chi_p = sin * weight + m_p * (1.0 - weight)
                        chi_q = cos * weight + m_q * (1.0 - weight)
                        if omega >= omega0 and omega < 0.0:
                            chi_p += (e - e_max) / omega0 * w_p
                            chi_q += (e - e_max) / omega0 * w_q
                        log_p, log_q = rate * k / f * chi_p, rate * k / f * chi_q
                    ratio = bound / (E * e)
                    d[0] = -ratio * (log_w * w_p + log_p - sin / e)
                    d_q = -ratio * (log_w * w_q + log_q - cos / e)
                    if e_t > 0.0:
                        d[1] = d_q * root_alpha * strain[c, 1] / e_t
                        d[2] = d_q * root_alpha * strain[c, 2] / e_t
        new[c, 0] = damage
        _fill(c, strain, damage, d, E, alpha, traction, tangent, with_tangent)
