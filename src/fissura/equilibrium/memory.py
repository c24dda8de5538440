"""What solvers keep from one step to the next: it decides the last bits of what they find."""

from dataclasses import dataclass

from fissura.arrays import FloatArray


@dataclass(frozen=True)
class SecantMemory:
    """What the secant stiffness was prepared for; matrices and their factors follow from it.

    Attributes
    ----------
    intact : (k, 3) array
        Shares of their elastic moduli that contacts with damage had left.
    unit : (6 n,) array
        Displacements that the unit load causes with that stiffness, more or less.
    unit_forces : (6 n,) array
        Forces that these need exactly.
    exact : bool
        These are the unit load.
    direct : bool
        The direct solver has taken over from an iterative one.
    """

    intact: FloatArray
    unit: FloatArray
    unit_forces: FloatArray
    exact: bool
    direct: bool


@dataclass(frozen=True)
class SolverMemory:
    """What is kept of the solution of the latest step.

    Attributes
    ----------
    secant : SecantMemory or None
        The prepared secant stiffness; None where none is.
    fresh : int or None
        Iterations that the preparation needed when it was new; None where that is not known yet.
    excess : int
        Iterations on top of these since.
    usual : int
        Iterations that the last preparation needed when it was new.
    """

    secant: SecantMemory | None = None
    fresh: int | None = None
    excess: int = 0
    usual: int = 0
