"""One run of an ensemble, and the words by which an ensemble is asked for."""

from dataclasses import dataclass, field
from typing import Literal

from fissura.case import Case
from fissura.case.points import Value

Mode = Literal["geometry", "field", "both"]
"""What is random: the nuclei, the field of material, or both."""

Sampling = Literal["monte-carlo", "latin-hypercube"]
Companions = Literal["one", "each", "none"]
Kind = Literal["run", "companion"]
Key = tuple[Kind, int]
"""What tells runs of an ensemble apart: kind and number."""


@dataclass(frozen=True)
class Task:
    """One run to be computed.

    Attributes
    ----------
    number : int
        Of the realisation, from 1; 0 for the companion of them all.
    kind : {"run", "companion"}
        Whether it belongs to the ensemble or is computed for comparison.
    case : Case
        What to compute.
    full, keep : bool
        Full resolution; all the files of a run.
    realisation : int
        Which realisation of its point it is, from 1; 0 for the companion of them all. Without varied keys it is the
        number.
    point : int
        Number of the point of a parameter study, from 0.
    values : dict of str to float or str
        Values of the varied keys there.
    """

    number: int
    kind: Kind
    case: Case
    full: bool = False
    keep: bool = False
    realisation: int = 0
    point: int = 0
    values: dict[str, Value] = field(default_factory=dict)

    @property
    def key(self) -> Key:
        """What tells tasks of an ensemble apart."""
        return self.kind, self.number
