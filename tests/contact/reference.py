"""The contact law, written a second time from the printed equations, one contact at a time."""

import math


def strength(omega, omega0, m, scale=1.0):
    """Effective strength in the printed form, ``omega`` in (-pi/2, pi/2); default ratios of the material only."""
    s, c, f_t = math.sin(omega), math.cos(omega), m.f_t * scale
    if omega < omega0:
        return 16.0 * f_t / math.sqrt(s * s + m.alpha * c * c)
    bottom = 0.04 * s * s - m.alpha * c * c
    return f_t * (4.52 * s - math.sqrt(20.0704 * s * s + 9.0 * m.alpha * c * c)) / bottom


def softening(length, omega0, m):
    """``K_t, K_s, n_t``."""
    E, f2 = m.E, m.f_t**2
    k_t = 2 * E * f2 * length / (2 * E * m.G_t - f2 * length)
    k_s = 18 * m.alpha * E * f2 * length / (32 * m.alpha * E * m.G_t - 9 * f2 * length)
    return k_t, k_s, math.log(k_t / (k_t - k_s)) / math.log(1 - 2 * omega0 / math.pi)


def modulus(omega, omega0, length, m):
    """Slope K of the boundary."""
    if omega < omega0:
        return 0.26 * m.E * (1 - ((omega + math.pi / 2) / (omega0 + math.pi / 2)) ** 2)
    k_t, _, n_t = softening(length, omega0, m)
    return -k_t * (1 - ((omega - math.pi / 2) / (omega0 - math.pi / 2)) ** n_t)


def response(strain, history, length, omega0, m):
    """Tractions, damage, largest ``e_N`` and ``e_T`` of one contact."""
    e_n, e_m, e_l = strain
    damage, top_n, top_t = history
    e_t = math.hypot(e_m, e_l)
    e = math.sqrt(e_n**2 + m.alpha * e_t**2)
    omega = math.atan2(e_n, math.sqrt(m.alpha) * e_t)
    top_n, top_t = max(top_n, e_n), max(top_t, e_t)
    e_max = math.sqrt(top_n**2 + m.alpha * top_t**2)
    if omega < omega0:
        chi = e
    elif omega < 0:
        chi = e * omega / omega0 + e_max * (1 - omega / omega0)
    else:
        chi = e_max
    f = strength(omega, omega0, m)
    bound = f * math.exp(modulus(omega, omega0, length, m) / f * max(chi - f / m.E, 0.0))
    damage = max(damage, 1 - bound / (m.E * e))
    traction = [(1 - damage) * m.E * e_n, (1 - damage) * m.alpha * m.E * e_m, (1 - damage) * m.alpha * m.E * e_l]
    return traction, damage, top_n, top_t
