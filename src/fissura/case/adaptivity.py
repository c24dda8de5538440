"""When and where a case refines its discretization."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from fissura.case.named import NameIn
from fissura.case.part import Part
from fissura.case.ranges import LONGEST
from fissura.case.region import Region
from fissura.case.registry import CRITERIA
from fissura.case.report import fail
from fissura.case.types import Flag, Fraction, PositiveLength, as_tuple, at_most


@dataclass(frozen=True)
class Level:
    """Parameters that keep the error of adaptivity below a tolerance.

    Attributes
    ----------
    tolerance : float
        Largest difference of the load from that of full resolution, over the peak load, in 93 % or more of the
        runs of the study in `docs/study.md`, or less.
    gamma : float
        As in a case.
    r_f : float
        Over `l_f`.
    ramp : float
        ``r_c - r_f`` over `l_c`.
    """

    tolerance: float
    gamma: float
    r_f: float
    ramp: float


#: From the coarsest to the finest (`fissura study benchmarks/study.toml`).
LEVELS = (
    Level(0.05, 0.85, 5.0, 2.0),
    Level(0.01, 0.75, 6.0, 2.0),
    Level(0.005, 0.6, 8.0, 4.0),
)

#: Tolerance of the defaults.
_USUAL = 0.01

#: The same for a smooth coarse part; only these have been measured.
SMOOTH_LEVELS = (LEVELS[1],)


class Adaptivity(Part):
    """When and where the discretization is refined; its radii are nan until a case resolves them."""

    criterion: Annotated[str, NameIn(CRITERIA)] = Field(default="utilisation", description="the name of a criterion")
    tolerance: Fraction | None = None
    coarse_part: Literal["heterogeneous", "smooth"] = "heterogeneous"
    gamma: Fraction = Field(default=math.nan, validate_default=False)
    r_f: PositiveLength = Field(default=math.nan, validate_default=False)
    r_c: PositiveLength = Field(default=math.nan, validate_default=False)
    ahead: Fraction = 0.85
    coarsen: Flag = False
    gamma_coarse: Fraction = Field(default=math.nan, validate_default=False)
    r_w: PositiveLength = Field(default=math.nan, validate_default=False)
    notch_tips: Flag = True
    calibrate: Flag = True
    regions: Annotated[tuple[Region, ...], BeforeValidator(as_tuple), at_most(10_000)] = ()

    def resolved(self, l_f: float, l_c: float) -> Adaptivity:
        """The same with every number known: by the tolerance where there is one, else by the defaults.

        Parameters
        ----------
        l_f, l_c : float
            Spacings [m].

        Raises
        ------
        ValueError
            Keys that contradict each other.
        """
        level = self._level()
        # What an earlier case resolved was not given, and follows the spacings of this one.
        given = self.model_fields_set
        gamma = self.gamma if "gamma" in given else level.gamma
        r_f = self.r_f if "r_f" in given else min(level.r_f * l_f, LONGEST)
        r_c = self.r_c if "r_c" in given else min(r_f + level.ramp * l_c, LONGEST)
        r_w = self.r_w if "r_w" in given else min(3.0 * l_f, LONGEST)
        if self.tolerance is not None:
            # A case read again from its resolved values gives them beside the tolerance: the same are allowed.
            found = {"gamma": gamma, "r_f": r_f, "r_c": r_c}
            due = {"gamma": level.gamma, "r_f": level.r_f * l_f, "r_c": level.r_f * l_f + level.ramp * l_c}
            for key, value in due.items():
                if not math.isclose(found[key], min(value, LONGEST), rel_tol=1e-9):
                    fail("is given together with tolerance, which chooses it", f"either tolerance or {key}", key)
        if r_f > r_c:
            fail(f"{r_f:g} m is larger than r_c = {r_c:g} m", "r_f at most r_c", "r_f")
        gamma_coarse = self.gamma_coarse if "gamma_coarse" in given else 0.8 * gamma
        if gamma_coarse >= gamma:
            fail(f"{gamma_coarse:g} is not below gamma = {gamma:g}", "a number below gamma", "gamma_coarse")
        resolved = self.model_copy()
        resolved.__dict__.update(gamma=gamma, r_f=r_f, r_c=r_c, r_w=r_w, gamma_coarse=gamma_coarse)
        return resolved

    def _level(self) -> Level:
        """The coarsest level that keeps the tolerance; the one of 1 % without a tolerance."""
        levels = SMOOTH_LEVELS if self.coarse_part == "smooth" else LEVELS
        tolerance = _USUAL if self.tolerance is None else self.tolerance
        for level in levels:
            if level.tolerance <= tolerance:
                return level
        least = levels[-1].tolerance
        fail(
            f"{tolerance:g} is smaller than what has been measured",
            f"{least:g} ({100 * least:g} % of the peak load) or more, or gamma, r_f and r_c",
            "tolerance",
        )
