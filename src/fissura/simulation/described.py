"""What a case says of a specimen before any body is placed: it is read in an instant, and most mistakes show here."""

from dataclasses import dataclass

from fissura.case import Case, case_notices
from fissura.contact import ContactLaw, check_ductile, law_from_case
from fissura.errors import Notice
from fissura.material import Materials, Regions, elastic_from_case, materials_from_case
from fissura.specimen import (
    Conditions,
    Domain,
    conditions_from_case,
    domain_from_case,
    edge_notices,
    gauge_notices,
    thin_notices,
    thin_parts,
)


@dataclass(frozen=True)
class Described:
    """A specimen without bodies.

    Attributes
    ----------
    law : type of ContactLaw
        Contact law.
    materials : Materials
        Constants of the contacts, by place.
    elastic : Regions
        Regions without damage.
    domain : Domain
        The specimen.
    conditions : Conditions
        Supports, loads and gauges.
    notices : tuple of Notice
        What looks wrong, although it can be built.
    """

    law: type[ContactLaw]
    materials: Materials
    elastic: Regions
    domain: Domain
    conditions: Conditions
    notices: tuple[Notice, ...]


def described(case: Case) -> Described:
    """Read a case as far as that is possible without bodies.

    Raises
    ------
    InputError
        Something in the case cannot be built.
    """
    law, materials = law_from_case(case), materials_from_case(case)
    domain = domain_from_case(case)
    thin = thin_notices(thin_parts(case, domain), case.discretization.l_f)
    check_ductile(case)
    conditions = conditions_from_case(case, domain)
    notices = (
        *case_notices(case),
        *thin,
        *edge_notices(case, domain),
        *domain.notices,
        *gauge_notices(domain, conditions),
    )
    return Described(law, materials, elastic_from_case(case), domain, conditions, notices)
