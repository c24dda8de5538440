"""The random field of a case."""

from pydantic import Field as Entry

from fissura.case.part import Part
from fissura.case.types import (
    Count,
    Fraction,
    Gaussians,
    Lengths,
    Order,
    PositiveLength,
    SignedShare,
    Tolerance,
    Variation,
    WeibullShape,
)


class EnergyField(Part):
    """Field of the fracture energy, where it does not follow that of the strength."""

    cross_correlation: SignedShare = 0.0
    marginal: str = Entry(default="grafted", description="the name of a distribution")
    cov: Variation = 0.25
    shape: WeibullShape | None = None
    graft: Fraction | None = None
    lower: Fraction | None = None


class Field(Part):
    """Random field by which strength and fracture energy differ from place to place (theory section 8)."""

    correlation: str = Entry(default="squared-exponential", description="the name of a correlation")
    length: Lengths = Entry(description='a length such as "50 mm", or three along the axes')
    nu: Order | None = None
    marginal: str = Entry(default="grafted", description="the name of a distribution")
    cov: Variation = 0.25
    shape: WeibullShape | None = None
    graft: Fraction | None = None
    lower: Fraction | None = None
    variance_error: Tolerance = 0.01
    spacing: PositiveLength | None = None
    seed: Count | None = None
    leading: Gaussians = ()
    energy: EnergyField | None = None
