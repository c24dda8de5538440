"""What decides the discretization of a specimen, apart from its fine nuclei."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fissura.adaptivity.coarsening import Coarsening
from fissura.adaptivity.region import RefinedRegion
from fissura.arrays import FloatArray


@dataclass(frozen=True)
class Layout:
    """Where a specimen is fine, and how stiff it is elsewhere: bodies and equations follow from it.

    Attributes
    ----------
    region : RefinedRegion
        What is fine.
    coarsening : Coarsening
        What decides when the region shrinks.
    stays_fine : bool
        It does not shrink any more.
    elastic_scale : float
        Factor of calibration on the stiffness of elastic contacts.
    """

    region: RefinedRegion
    coarsening: Coarsening
    stays_fine: bool = False
    elastic_scale: float = 1.0

    def refined(self, centers: FloatArray) -> Layout:
        """With further critical centres, shape (k, 3); the factor is still that of before."""
        return replace(self, region=self.region.grown(centers), coarsening=self.coarsening.refined(centers))

    def coarsened(self, region: RefinedRegion) -> Layout:
        """With a smaller region; the factor is still that of before."""
        return replace(self, region=region, coarsening=self.coarsening.coarsened(self.region))
