"""Parameters of the material at contact level."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fissura.case.plausible import suspect
from fissura.errors import InputError

if TYPE_CHECKING:
    from fissura.case import Case

__all__ = ["Material", "check_ductile", "material_from_case"]


@dataclass(frozen=True)
class Material:
    """Contact parameters (theory section 3).

    Attributes
    ----------
    E : float
        Normal modulus of contacts [Pa].
    alpha : float
        Ratio of tangential to normal stiffness.
    f_t, f_s, f_c : float
        Strength in tension, shear and compression [Pa].
    G_t, G_s : float
        Fracture energy in tension and shear [J/m^2].
    K_c : float
        Hardening modulus in compression [Pa].
    mu : float
        Slope of the strength surface at high compression.
    beta : float
        Shape of the compressive cap.
    n_c : float
        Exponent of the transition of the hardening modulus.
    """

    E: float
    alpha: float
    f_t: float
    G_t: float
    f_s: float
    f_c: float
    G_s: float
    K_c: float
    mu: float = 0.2
    beta: float = 1.0
    n_c: float = 2.0

    @classmethod
    def standard(cls, E: float, alpha: float, f_t: float, G_t: float) -> Material:
        """Material with the default ratios ``f_s = 3 f_t, f_c = 16 f_t, G_s = 16 G_t, K_c = 0.26 E``."""
        return cls(E, alpha, f_t, G_t, 3.0 * f_t, 16.0 * f_t, 16.0 * G_t, 0.26 * E)

    @property
    def longest_tension(self) -> float:
        """Contact length [m] at which tensile softening would snap back, ``l_t = 2 E G_t / f_t^2``."""
        return 2.0 * self.E * self.G_t / self.f_t**2

    @property
    def longest_shear(self) -> float:
        """Contact length [m] at which shear softening would snap back, ``2 alpha E G_s / f_s^2``."""
        return 2.0 * self.alpha * self.E * self.G_s / self.f_s**2

    @property
    def longest_mixed(self) -> float:
        """Contact length [m] at which shear would soften as fast as tension, so that ``K_s = K_t``.

        With the default ratios ``(7/9) l_t alpha / (1 - alpha)``; negative where shear is the more brittle at any
        length.
        """
        surplus = self.G_s / self.f_s**2 - self.G_t / self.f_t**2
        if self.alpha >= 1.0:
            return float("inf") if surplus > 0.0 else -float("inf")
        return 2.0 * self.alpha * self.E / (1.0 - self.alpha) * surplus

    @property
    def longest(self) -> float:
        """Length [m] that a contact with damage must not reach: the least of the three limits."""
        return min(self.longest_tension, self.longest_shear, self.longest_mixed)


def material_from_case(case: Case) -> Material:
    """Material of a case."""
    m = case.material
    return Material(m.E, m.alpha, m.f_t, m.G_t, m.f_s, m.f_c, m.G_s, m.K_c, m.mu, m.beta, m.n_c)


def check_ductile(case: Case) -> None:
    """Fine contacts must be able to soften: all are longer than ``l_f``, and a longer limit leaves none out.

    Raises
    ------
    InputError
        None of them can. Where a constant of the material looks wrong, it is named rather than ``l_f``.
    """
    material, l_f = material_from_case(case), case.discretization.l_f
    if not 0.0 < material.longest <= l_f:
        return
    problem = (
        f"contacts of this material soften properly only where they are shorter than {1e3 * material.longest:.4g} mm,"
        f" and fine ones are longer than l_f = {1e3 * l_f:.4g} mm"
    )
    odd = suspect(case, "material")
    if odd is not None:
        raise InputError(odd.key, f"{odd.problem}; {problem}", odd.advice)
    raise InputError("discretization.l_f", problem, "a smaller l_f, a larger material.G_t or a smaller material.f_t")
