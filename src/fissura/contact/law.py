"""The contact law of Cusatis & Cedolin (2007) in the form of Eliáš (2016), theory section 3.

One damage variable per contact; three running values of history: damage, largest ``e_N``, largest ``e_T``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fissura.arrays import FloatArray
from fissura.contact import limits
from fissura.contact.softening import respond
from fissura.contact.strength import lowest_strength, transition_angle, utilisations
from fissura.errors import InputError
from fissura.material import Material

#: Name of the limit from which shear and tension soften alike.
_BOTH = "of both together"


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
        respond(
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
        return utilisations(strain, self.scale, self._parameters())
