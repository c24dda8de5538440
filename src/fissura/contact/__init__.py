"""Contacts: kinematics, laws, and the stress in bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fissura.contact.kinematics import (
    Kinematics,
    add_stiffness,
    contact_strains,
    kinematics,
    kinematics_of,
    nodal_forces,
)
from fissura.contact.law import CusatisCedolin
from fissura.contact.protocol import ContactLaw
from fissura.contact.stress import body_stress
from fissura.errors import InputError

if TYPE_CHECKING:
    from fissura.case import Case

__all__ = [
    "LAWS",
    "ContactLaw",
    "CusatisCedolin",
    "Kinematics",
    "add_stiffness",
    "body_stress",
    "contact_strains",
    "kinematics",
    "kinematics_of",
    "law_from_case",
    "nodal_forces",
]

#: Contact laws by the name that a case file gives.
LAWS: dict[str, type[ContactLaw]] = {"cusatis-cedolin": CusatisCedolin}


def law_from_case(case: Case) -> type[ContactLaw]:
    """The contact law that a case names.

    Raises
    ------
    InputError
        Unknown law.
    """
    law = LAWS.get(case.material.law)
    if law is None:
        raise InputError("material.law", f"{case.material.law!r} is not known", ", ".join(sorted(LAWS)))
    return law
