"""Parameters of the material at contact level."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import BaseModel

from fissura.case import Case
from fissura.case import Material as Part


@dataclass(frozen=True)
class Material:
    """Constants of contacts (theory section 3): stiffness, strength in tension and its energy for any law, others too.

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
    parameters : BaseModel, optional
        Those of the law's own table, an instance of its model `Parameters`.
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
    parameters: BaseModel | None = None

    @classmethod
    def standard(cls, E: float, alpha: float, f_t: float, G_t: float) -> Material:
        """Material with the default ratios ``f_s = 3 f_t, f_c = 16 f_t, G_s = 16 G_t, K_c = 0.26 E``."""
        return cls(E, alpha, f_t, G_t, 3.0 * f_t, 16.0 * f_t, 16.0 * G_t, 0.26 * E)


def material_from_case(case: Case) -> Material:
    """Material of a case where no region has another one."""
    return material_from_part(case.material)


def material_from_part(part: Part) -> Material:
    """Material of a table of a case."""
    m = part
    return Material(m.E, m.alpha, m.f_t, m.G_t, m.f_s, m.f_c, m.G_s, m.K_c, m.mu, m.beta, m.n_c, m.parameters)
