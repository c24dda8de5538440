"""The contact law of Cusatis & Cedolin (2007) in the form of Eliáš (2016), theory section 3.

One damage variable per contact; three running values of history: damage, largest ``e_N``, largest ``e_T``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.optimize import brentq

from fissura.arrays import FloatArray
from fissura.contact import limits
from fissura.contact.limits import INTACT_SHARE
from fissura.errors import InputError
from fissura.kernels import njit
from fissura.material import Material

__all__ = ["CusatisCedolin", "lowest_strength", "transition_angle"]


_HALF_PI = 0.5 * np.pi


#: Name of the limit from which shear and tension soften alike.
_BOTH = "of both together"


@njit()
def _tension_shear_strength(sin, cos, alpha, f_t, f_s, mu):  # type: ignore[no-untyped-def]
    """Strength and its derivative to omega for ``s_T^2 = (f_t - s_N)(f_s^2/f_t - mu^2 s_N)``."""
    b = f_s * f_s / f_t + mu * mu * f_t
    root = np.sqrt(b * b * sin * sin + 4.0 * f_s * f_s * (alpha * cos * cos - mu * mu * sin * sin))
    f = 2.0 * f_s * f_s / (b * sin + root)
    slope = (b * b - 4.0 * f_s * f_s * (alpha + mu * mu)) * sin * cos / root
    return f, -f * (b * cos + slope) / (b * sin + root)


@njit()
def _compression_strength(sin, cos, alpha, f_c, beta):  # type: ignore[no-untyped-def]
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
        shear, _ = _tension_shear_strength(sin, cos, m.alpha, m.f_t, m.f_s, m.mu)
        cap, _ = _compression_strength(sin, cos, m.alpha, m.f_c, m.beta)
        return float(shear - cap)

    low = -np.arctan(np.sqrt(m.alpha) / m.mu) * (1.0 - limits.APART) if m.mu > 0 else -_HALF_PI * (1.0 - limits.APART)
    least = limits.LEAST_CAP * m.f_s / np.sqrt(m.beta)
    if m.f_c < least or gap(low) <= 0.0:
        raise InputError(
            "material.f_c",
            f"{m.f_c:g} Pa: the compressive cap does not meet the shear strength under compression",
            f"{least:g} Pa or more, {limits.LEAST_CAP:g} f_s/sqrt(beta)",
        )
    return float(brentq(gap, low, 0.0, xtol=1e-15, rtol=1e-14))


@njit()
def _respond(  # type: ignore[no-untyped-def]
    strain, history, scale, k_t, n_t, par, lowest, traction, new, tangent, with_tangent
):
    E, alpha, f_t0, f_s0, f_c0, k_c, mu, beta, n_c, omega0, tail, steep, flat = par
    root_alpha = np.sqrt(alpha)
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
        grows = False
        d_p, d_q = 0.0, 0.0  # derivatives of damage
        if e > 0.0:
            f_t, f_s, f_c = f_t0 * scale[c], f_s0 * scale[c], f_c0 * scale[c]
            sin, cos = p / e, q / e
            omega = np.arctan2(p, q)
            e_max = np.sqrt(top_n * top_n + alpha * top_t * top_t)
            if omega < omega0:
                f, df = _compression_strength(sin, cos, alpha, f_c, beta)
                base = (omega + 0.5 * np.pi) / (omega0 + 0.5 * np.pi)
                power = base**n_c
                k = k_c * (1.0 - power)
                dk = -k_c * n_c * power / (omega + 0.5 * np.pi) if base > 0.0 else 0.0
                chi, weight = e, 1.0
            else:
                f, df = _tension_shear_strength(sin, cos, alpha, f_t, f_s, mu)
                base = (omega - 0.5 * np.pi) / (omega0 - 0.5 * np.pi)
                power = base ** n_t[c] if base > 0.0 else 0.0
                k = -k_t[c] * (1.0 - power)
                dk = k_t[c] * n_t[c] * power / (omega - 0.5 * np.pi) if base > 0.0 else 0.0
                weight = omega / omega0 if omega < 0.0 else 0.0
                chi = e * weight + e_max * (1.0 - weight)
            excess = chi - f / E
            bound, rate = f, 1.0
            if excess > 0.0 and (tail == 0.0 or k >= 0.0):
                bound = f * np.exp(k / f * excess)
            elif excess > 0.0:  # two exponentials; `rate` is how much faster their sum falls than one
                first, last = (1.0 - tail) * np.exp(steep * k / f * excess), tail * np.exp(flat * k / f * excess)
                bound, rate = f * (first + last), (steep * first + flat * last) / (first + last)
            trial = 1.0 - bound / (E * e)
            if trial > damage:
                damage = trial
                grows = True
                if damage > 1.0 - INTACT_SHARE:
                    damage = 1.0 - INTACT_SHARE
                    grows = False
            if grows and with_tangent:
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
                d_p = -ratio * (log_w * w_p + log_p - sin / e)
                d_q = -ratio * (log_w * w_q + log_q - cos / e)
        new[c, 0] = damage
        intact = 1.0 - damage
        traction[c, 0] = intact * E * p
        traction[c, 1] = intact * alpha * E * strain[c, 1]
        traction[c, 2] = intact * alpha * E * strain[c, 2]
        if with_tangent:
            d = np.zeros(3)
            if grows:
                d[0] = d_p
                if e_t > 0.0:
                    d[1] = d_q * root_alpha * strain[c, 1] / e_t
                    d[2] = d_q * root_alpha * strain[c, 2] / e_t
            for a in range(3):
                s = E if a == 0 else alpha * E
                for b in range(3):
                    tangent[c, a, b] = -s * strain[c, a] * d[b]
                tangent[c, a, a] += intact * s


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
                f, _ = _compression_strength(p / e, q / e, alpha, f_c * scale[c], beta)
            else:
                f, _ = _tension_shear_strength(p / e, q / e, alpha, f_t * scale[c], f_s * scale[c], mu)
            out[c] = E * e / f


def _check_ductility(length: FloatArray, ductility: FloatArray, longest: float) -> None:
    """No contact may be too long for the fracture energy and the strength that a field gives it.

    Raises
    ------
    InputError
        A contact that would snap back; the brittlest one is named.
    """
    if not len(length):
        return
    worst = int(np.argmax(length / ductility))
    limit = longest * float(ductility[worst])
    if longest > length.max() and length[worst] >= limit:
        raise InputError(
            "field.energy",
            f"a fine contact is {length[worst] * 1e3:.4g} mm long, but where the field leaves it"
            f" {ductility[worst]:.3g} times the mean ductility G_t/f_t^2, this material softens properly only below"
            f" {limit * 1e3:.4g} mm",
            "a smaller cov, a larger cross_correlation, a smaller discretization.l_f or a larger material.G_t",
        )


@dataclass(frozen=True)
class CusatisCedolin:
    """The law for a set of contacts.

    Attributes
    ----------
    material : Material
        Parameters.
    length : (m,) array
        Contact lengths [m].
    scale : (m,) array
        Relative strength ``H``: strengths go with it, fracture energies with its square unless ``create`` is told
        otherwise.
    k_t, k_s, n_t : (m,) array
        Softening moduli [Pa] and exponent; they depend on length and ductility alone.
    omega0 : float
        Angle at which both strength surfaces meet [rad].
    """

    Parameters: ClassVar[None] = None

    material: Material
    length: FloatArray
    scale: FloatArray
    k_t: FloatArray
    k_s: FloatArray
    n_t: FloatArray
    omega0: float

    @classmethod
    def create(
        cls,
        material: Material,
        length: FloatArray,
        scale: FloatArray | None = None,
        ductility: FloatArray | None = None,
    ) -> CusatisCedolin:
        """Prepare the law for contacts of given lengths.

        Strengths ``f H`` and fracture energies ``G g`` give the softening moduli of the material itself at the length
        ``L H^2 / g``, which is ``L`` where ``g = H^2``.

        Parameters
        ----------
        material : Material
            Parameters where the field has its mean.
        length : (m,) array
            Contact lengths ``L`` [m].
        scale : (m,) array, optional
            Relative strength ``H`` of each contact; 1 by default.
        ductility : (m,) array, optional
            Relative fracture energy over the square of the relative strength, ``g / H^2``; 1 by default.

        Raises
        ------
        InputError
            A contact longer than the law allows without snap-back.
        """
        m = material
        lengths = cls.limits(m)
        if lengths[_BOTH] <= 0.0:
            raise InputError(
                "material.G_s",
                f"{m.G_s:g} J/m^2: shear softens faster than tension",
                f"more than {m.G_t * m.f_s**2 / m.f_t**2:g} J/m^2, G_t f_s^2 / f_t^2",
            )
        longest = min(lengths.values())
        if ductility is not None:
            _check_ductility(length, ductility, longest)
            length = length / ductility
        top = float(length.max(initial=0.0))
        if top >= longest:
            raise InputError(
                "discretization.l_f",
                f"a fine contact is {top * 1e3:.4g} mm long, but this material softens properly only below"
                f" {longest * 1e3:.4g} mm",
                "a smaller l_f, a larger material.G_t or a smaller material.f_t",
            )
        omega0 = transition_angle(m)
        k_t = 2.0 * m.E * m.f_t**2 * length / (2.0 * m.E * m.G_t - m.f_t**2 * length)
        k_s = 2.0 * m.alpha * m.E * m.f_s**2 * length / (2.0 * m.alpha * m.E * m.G_s - m.f_s**2 * length)
        # At the limit of the length both moduli are the same, but for round-off.
        apart = np.maximum(k_t - k_s, limits.ROUND_OFF * k_t)
        n_t = np.log(k_t / apart) / np.log(1.0 - 2.0 * omega0 / np.pi)
        return cls(m, length, np.ones(len(length)) if scale is None else scale, k_t, k_s, n_t, omega0)

    @classmethod
    def limits(cls, material: Material) -> dict[str, float]:
        """Lengths [m] that contacts must not reach.

        Tension and shear would snap back from ``2 E G_t / f_t^2`` and ``2 alpha E G_s / f_s^2`` on; from the third
        limit on shear would soften as fast as tension, so that ``K_s = K_t``. With the default ratios that is ``(7/9)
        l_t alpha / (1 - alpha)``; it is negative where shear is the more brittle at any length.
        """
        m = material
        surplus = m.G_s / m.f_s**2 - m.G_t / m.f_t**2
        if m.alpha >= 1.0:
            both = float("inf") if surplus > 0.0 else -float("inf")
        else:
            both = 2.0 * m.alpha * m.E / (1.0 - m.alpha) * surplus
        return {
            "in tension": 2.0 * m.E * m.G_t / m.f_t**2,
            "in shear": 2.0 * m.alpha * m.E * m.G_s / m.f_s**2,
            _BOTH: both,
        }

    @property
    def strength(self) -> float:
        """Tensile strength of a contact of unit relative strength [Pa]."""
        return self.material.f_t

    @property
    def elastic(self) -> FloatArray:
        """Elastic moduli of the three strain components [Pa], shape (3,)."""
        return self.material.E * np.array([1.0, self.material.alpha, self.material.alpha])

    def initial_history(self) -> FloatArray:
        """History of a virgin contact: damage, largest ``e_N``, largest ``e_T``; shape (m, 3)."""
        return np.zeros((len(self.length), 3))

    def damage(self, history: FloatArray) -> FloatArray:
        """Damage; (m, 3) -> (m,)."""
        return history[:, 0]

    def intact(self, history: FloatArray) -> FloatArray:
        """Share ``1 - D`` of each elastic modulus that is left; (m, 3) -> (m, 3)."""
        return np.repeat(1.0 - history[:, 0], 3).reshape(-1, 3)

    def unloaded(self, strain: FloatArray, history: FloatArray) -> FloatArray:
        """The same history: the law does not remember where contacts are now."""
        return history

    def loading(self, strain: FloatArray, history: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Squares of the effective strain now and at most, ``e_N^2 + alpha e_T^2``; of compression nothing is kept.

        Parameters
        ----------
        strain, history : (m, 3) arrays
            Strains, and the accepted history that belongs to them.

        Returns
        -------
        now, largest : (m,) arrays
        """
        alpha = self.material.alpha
        now = np.maximum(strain[:, 0], 0.0) ** 2 + alpha * (strain[:, 1] ** 2 + strain[:, 2] ** 2)
        return now, history[:, 1] ** 2 + alpha * history[:, 2] ** 2

    def _softening(self) -> tuple[float, float, float]:
        """Share of strength of a second exponential of softening, and how fast both fall, over that of only one."""
        return 0.0, 1.0, 1.0

    def _parameters(self) -> tuple[float, ...]:
        m = self.material
        return (m.E, m.alpha, m.f_t, m.f_s, m.f_c, m.K_c, m.mu, m.beta, m.n_c, self.omega0, *self._softening())

    def _run(
        self, strain: FloatArray, history: FloatArray, tangent: FloatArray, with_tangent: bool
    ) -> tuple[FloatArray, FloatArray]:
        traction, new = np.empty_like(strain), np.empty_like(history)
        _respond(
            strain,
            history,
            self.scale,
            self.k_t,
            self.n_t,
            self._parameters(),
            lowest_strength(self.material),
            traction,
            new,
            tangent,
            with_tangent,
        )
        return traction, new

    def response(self, strain: FloatArray, history: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Tractions and new history.

        Parameters
        ----------
        strain : (m, 3) array
            ``e_N, e_M, e_L``.
        history : (m, 3) array
            History at the last accepted step.

        Returns
        -------
        traction : (m, 3) array
            ``s_N, s_M, s_L`` [Pa].
        history : (m, 3) array
            What it becomes when the step is accepted.
        """
        return self._run(strain, history, np.empty((1, 3, 3)), False)

    def tangent(self, strain: FloatArray, history: FloatArray) -> FloatArray:
        """Consistent tangent ``ds/de`` [Pa], shape (m, 3, 3); unsymmetric where damage grows."""
        tangent = np.empty((len(strain), 3, 3))
        self._run(strain, history, tangent, True)
        return tangent

    def utilisation(self, strain: FloatArray) -> FloatArray:
        """Elastic effective traction over strength, ``E e / f_eff(omega)``; shape (m,)."""
        out = np.empty(len(strain))
        _utilisation(strain, self.scale, self._parameters(), out)
        return out
