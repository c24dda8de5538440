"""The refined region: a set of balls, lines with a radius, and boxes; and the spacing that it asks for."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.spatial import cKDTree

from fissura.arrays import FloatArray
from fissura.case import Case
from fissura.material import Regions
from fissura.specimen import Domain


def _empty(*shape: int) -> FloatArray:
    return np.empty(shape)


@dataclass(frozen=True)
class RefinedRegion:
    """Where the specimen is fine (theory section 5).

    Attributes
    ----------
    l_f, l_c : float
        Fine and coarse spacing [m].
    r_f : float
        Radius of the balls around critical centres [m].
    ramp : float
        Distance ``r_c - r_f`` over which spacing grows from `l_f` to `l_c` [m].
    centers : (k, 3) array
        Critical centres so far [m].
    r_w : float
        Radius of the balls around bodies that coarsening left fine [m].
    needed : (w, 3) array
        Nuclei of these bodies [m].
    lines : (q, 2, 3) array
        Ends of lines that are fine within `r_l` [m].
    r_l : float or None
        That radius [m]; None for `r_f`.
    balls, radii : (b, 3), (b,) arrays
        Further balls from the start [m].
    lower, upper : (b, 3) arrays
        Boxes from the start [m].
    everywhere : bool
        The whole specimen is fine.
    """

    l_f: float
    l_c: float
    r_f: float
    ramp: float
    centers: FloatArray = field(default_factory=lambda: _empty(0, 3))
    lines: FloatArray = field(default_factory=lambda: _empty(0, 2, 3))
    balls: FloatArray = field(default_factory=lambda: _empty(0, 3))
    radii: FloatArray = field(default_factory=lambda: _empty(0))
    lower: FloatArray = field(default_factory=lambda: _empty(0, 3))
    upper: FloatArray = field(default_factory=lambda: _empty(0, 3))
    everywhere: bool = False
    r_l: float | None = None
    r_w: float = 0.0
    needed: FloatArray = field(default_factory=lambda: _empty(0, 3))

    def grown(self, centers: FloatArray) -> RefinedRegion:
        """The same region with further critical centres, shape (k, 3)."""
        return replace(self, centers=np.unique(np.concatenate([self.centers, centers]), axis=0))

    def coarsened(self, needed: FloatArray, lasting: FloatArray) -> RefinedRegion:
        """What a case asks for, `r_w` around tip lines and bodies that are needed, and `r_f` around lasting centres.

        Parameters
        ----------
        needed : (w, 3) array
            Nuclei of bodies that must stay fine [m].
        lasting : (k, 3) array
            Critical centres that stay [m].
        """
        return replace(self, centers=lasting, needed=needed, r_l=self.r_w)

    def distance(self, x: FloatArray) -> FloatArray:
        """Distance of points from the region [m], zero or negative inside; (n, 3) -> (n,)."""
        if self.everywhere:
            return np.full(len(x), -np.inf)
        nearest = np.full(len(x), np.inf)
        for centers, radius in ((self.centers, self.r_f), (self.needed, self.r_w)):
            if len(centers):
                nearest = np.minimum(nearest, np.asarray(cKDTree(centers).query(x)[0]) - radius)
        tip = self.r_f if self.r_l is None else self.r_l
        for a, b in self.lines:
            along = b - a
            t = np.clip((x - a) @ along / (along @ along), 0.0, 1.0)
            nearest = np.minimum(nearest, np.linalg.norm(x - a - t[:, None] * along, axis=1) - tip)
        given = Regions(self.balls, self.radii, self.lower, self.upper).distance(x)
        return np.asarray(np.minimum(nearest, given), dtype=np.float64)

    def spacing(self, x: FloatArray, within: float = 0.0) -> FloatArray:
        """Least wanted spacing within a radius around points [m], 0 inside the region; (n, 3) -> (n,)."""
        d = self.distance(x) - within
        share = np.clip(d / self.ramp, 0.0, 1.0) if self.ramp > 0.0 else np.ones(len(x))
        return np.where(d <= 0.0, 0.0, self.l_f + (self.l_c - self.l_f) * share)


def region_from_case(case: Case, domain: Domain, *, full: bool) -> RefinedRegion:
    """The region that is fine from the start."""
    part, sizes = case.adaptivity, case.discretization
    lines = [notch.tip_lines() for notch in domain.notches] if part.notch_tips else []
    regions = Regions.from_parts(part.regions)
    return RefinedRegion(
        sizes.l_f,
        sizes.l_c,
        part.r_f,
        part.r_c - part.r_f,
        lines=np.concatenate([_empty(0, 2, 3), *lines]),
        balls=regions.balls,
        radii=regions.radii,
        lower=regions.lower,
        upper=regions.upper,
        everywhere=full,
        r_w=part.r_w,
    )
