"""The law of Cusatis & Cedolin with a steep drop and a long tail (theory section "Two fracture energies").

Softening is the sum of two exponentials, which have the same energy in all as the one of the published law. Strength of
specimens depends on the initial fracture energy, the tail of their curves on the total one.
"""

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

from pydantic import BeforeValidator, Field

from fissura.case.part import Part
from fissura.case.ranges import between, quantity
from fissura.case.units import NUMBER
from fissura.contact.law import CusatisCedolin


class TwoEnergiesTable(Part):
    """The table ``[material.cusatis-cedolin-two-energies]``."""

    initial: Annotated[float, BeforeValidator(quantity(NUMBER, between(0.05, 0.5)))] = Field(
        default=0.25,
        description="a number from 0.05 to 0.5: initial over total fracture energy, G_f/G_t; 0.5 is the published law",
    )
    tail: Annotated[float, BeforeValidator(quantity(NUMBER, between(0.01, 0.9)))] = Field(
        default=0.2, description="a number from 0.01 to 0.9: share of the strength from which the tail starts"
    )


def energy_of_tail(initial: float, tail: float) -> float:
    """Share of the total energy that the tail dissipates.

    Parameters
    ----------
    initial : float
        Initial over total fracture energy.
    tail : float
        Share of the strength from which the tail starts.

    Notes
    -----
    With the shares ``w`` of the strength and ``g`` of the energy the slope at the start is ``S = (1 - w)^2 / (1 - g) +
    w^2 / g`` times that of one exponential, and the area under the tangent there is ``1 / (2 S)`` of the total one.
    """
    slope = 0.5 / initial
    root = math.sqrt(max((slope - 1.0 + 2.0 * tail) ** 2 - 4.0 * slope * tail**2, 0.0))
    return (slope - 1.0 + 2.0 * tail + root) / (2.0 * slope)


@dataclass(frozen=True)
class TwoEnergies(CusatisCedolin):
    """The law for a set of contacts; see :class:`CusatisCedolin` for its attributes."""

    Parameters: ClassVar[type[TwoEnergiesTable]] = TwoEnergiesTable  # type: ignore[assignment]

    def _softening(self) -> tuple[float, float, float]:
        table = self.material.parameters
        assert isinstance(table, TwoEnergiesTable)
        tail, energy = table.tail, energy_of_tail(table.initial, table.tail)
        return tail, (1.0 - tail) / (1.0 - energy), tail / energy
