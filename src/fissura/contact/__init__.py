"""Contacts: kinematics, laws, and the stress in bodies."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from fissura.case.plausible import suspect
from fissura.case.registry import LAWS
from fissura.contact.closing import ClosingCusatisCedolin
from fissura.contact.kinematics import (
    Kinematics,
    add_stiffness,
    contact_strains,
    kinematics,
    kinematics_of,
    nodal_forces,
)
from fissura.contact.law import CusatisCedolin
from fissura.contact.protocol import AppliedLaw, ContactLaw
from fissura.contact.several import LawOfMaterials
from fissura.contact.stress import body_stress
from fissura.contact.two_energies import TwoEnergies
from fissura.errors import InputError
from fissura.material import materials_from_case

if TYPE_CHECKING:
    from fissura.case import Case

__all__ = [
    "AppliedLaw",
    "ClosingCusatisCedolin",
    "ContactLaw",
    "CusatisCedolin",
    "Kinematics",
    "LawOfMaterials",
    "TwoEnergies",
    "add_stiffness",
    "body_stress",
    "check_ductile",
    "contact_strains",
    "kinematics",
    "kinematics_of",
    "law_from_case",
    "limits_from_case",
    "nodal_forces",
]


def law_from_case(case: Case) -> type[ContactLaw]:
    """The contact law that a case names.

    Raises
    ------
    InputError
        Unknown law, or one of another package that cannot be used.
    """
    return LAWS.named(case.material.law)


def limits_from_case(case: Case) -> dict[str, float]:
    """Lengths [m] that contacts with damage must not reach, by the names that the law gives them; the least of all.

    Raises
    ------
    InputError
        See :func:`law_from_case` and :func:`fissura.material.materials_from_case`.
    """
    law, out = law_from_case(case), dict[str, float]()
    for material in materials_from_case(case).pairs():
        for name, limit in law.limits(material).items():
            out[name] = min(limit, out.get(name, inf))
    return out


def check_ductile(case: Case) -> None:
    """Fine contacts must be able to soften: all are longer than ``l_f``, and a longer limit leaves none out.

    Raises
    ------
    InputError
        None of them can. Where a constant of the material looks wrong, it is named rather than ``l_f``.
    """
    l_f = case.discretization.l_f
    longest = min(limits_from_case(case).values(), default=inf)
    if not 0.0 < longest <= l_f:
        return
    problem = (
        f"contacts of this material soften properly only where they are shorter than {1e3 * longest:.4g} mm,"
        f" and fine ones are longer than l_f = {1e3 * l_f:.4g} mm"
    )
    odd = suspect(case, "material")
    if odd is not None:
        raise InputError(odd.key, f"{odd.problem}; {problem}", odd.advice)
    raise InputError("discretization.l_f", problem, "a smaller l_f, a larger material.G_t or a smaller material.f_t")
