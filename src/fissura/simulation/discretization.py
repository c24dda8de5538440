"""The specimen of a run as it is discretized: equations that change with the refined region."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fissura.adaptivity import (
    Coarsening,
    ElasticState,
    Layout,
    RefinedRegion,
    bodies_of_calibration,
    calibrated,
    extrapolated_compliance,
    gauge_compliance,
    needed_bodies,
    region_from_case,
)
from fissura.arrays import FloatArray
from fissura.case import Case
from fissura.case.registry import CRITERIA
from fissura.equilibrium import Response, System, check_places
from fissura.errors import InputError
from fissura.machine.kernel_threads import KernelThreads
from fissura.material import Regions, check_not_everywhere, field_from_case
from fissura.simulation import limits
from fissura.simulation.described import described
from fissura.simulation.memory import estimated_bodies
from fissura.specimen import Conditions, Drive
from fissura.tessellation import Nuclei, Tessellation, discretize, nuclei_from_case


def _count(bodies: int) -> str:
    return "1 body" if bodies == 1 else f"{bodies} bodies"


class Discretization:
    """Discretizes a specimen for a refined region, and again when the region changes.

    Parameters
    ----------
    case : Case
        What is broken.
    full : bool
        Every nucleus is fine, for good.

    Raises
    ------
    InputError
        Something in the case cannot be built.

    Attributes
    ----------
    notices : tuple of Notice
        What looks wrong in the case, although it can be built.
    domain, nuclei : Domain, Nuclei
        The specimen, and its fine nuclei: all of them, or with blocks those that were needed so far.
    bodies_full : int
        Bodies at full resolution.
    estimated : bool
        Whether that number is an estimate, since not all of them are placed.
    field : RandomField or None
        Relative strength as a function of position; None where it is the same everywhere.
    layout : Layout
        What decides the current discretization.
    system : System
        Its equations.
    compliance : float or None
        Controlled quantity per unit load of the undamaged structure at full resolution [m/N]; known when calibration
        has needed it.
    compliance_error : float or None
        Estimate of its relative error where it was extrapolated; None where it was solved for.
    """

    def __init__(self, case: Case, *, full: bool) -> None:
        self._case, self._full = case, full
        self._criterion = CRITERIA.named(case.adaptivity.criterion)
        found = described(case)
        self._law, self._material, self._elastic = found.law, found.materials, found.elastic
        self.domain, self._conditions, self.notices = found.domain, found.conditions, found.notices
        self.field = field_from_case(case)
        self._threads = KernelThreads(case.solver.threads)
        self.nuclei = nuclei_from_case(case, self.domain)
        self.layout = Layout(region_from_case(case, self.domain, full=full), Coarsening())
        self._known(self.layout.region)
        self.estimated = self.nuclei.blocks is not None and not full
        self.bodies_full = estimated_bodies(case, self.domain) if self.estimated else len(self.nuclei)
        if self._elastic.contains(self.nuclei.x).all():  # facets between nuclei may lie outside all the same
            check_not_everywhere(self._elastic, self._whole().contacts.centroid)
        self.compliance: float | None = None
        self.compliance_error: float | None = None
        start = self._discretized(self.layout.region)
        check_places(self._conditions, self._near_places(), case.discretization.l_f, start=False)
        if not len(start.contacts) and len(start) < self.bodies_full:
            raise InputError(
                "discretization.l_c",
                f"{case.discretization.l_c:g} m: the start has {_count(len(start))} without any contact",
                f"less; l_f = {case.discretization.l_f:g} m, the least, starts with all {self.told_full} bodies",
            )
        if not full:
            check_places(self._conditions, start, case.discretization.l_f, start=True)
        self.system = self._equations(start)

    @property
    def told_full(self) -> str:
        """Bodies at full resolution, as messages tell them."""
        return f"about {self.bodies_full}" if self.estimated else f"{self.bodies_full}"

    def _known(self, region: RefinedRegion) -> Nuclei:
        """Nuclei that a region may need; a run that needs few of them does not carry along all of the specimen."""
        found = self.nuclei.known_for(region.spacing)
        if self._full or not region.everywhere:
            self.nuclei = found
        return found

    def _near_places(self) -> Nuclei:
        """Nuclei with all fine ones near supports, loads and gauges."""
        sizes, conditions = self._case.discretization, self._conditions
        places = (*conditions.supports, *conditions.loads, *conditions.gauges)
        points = [np.empty((0, 3)), *(place.points for place in places if place.platen is None)]
        near = RefinedRegion(sizes.l_f, sizes.l_c, limits.NEAR_PLACES * sizes.l_f, 0.0, centers=np.concatenate(points))
        return self.nuclei.known_for(near.spacing)

    def _discretized(self, region: RefinedRegion, previous: Tessellation | None = None) -> Tessellation:
        nuclei = self._known(region)
        found = discretize(nuclei, self.domain, region.spacing(nuclei.x), previous)
        return replace(found, cells=None) if self._full else found  # nothing will change there

    def _whole(self) -> Tessellation:
        """Full resolution, without what only another discretization of the specimen needs."""
        return self._discretized(replace(self.layout.region, everywhere=True)).without_shapes()

    def _equations(self, tessellation: Tessellation) -> System:
        return System(
            tessellation,
            self._material,
            self._law,
            self._conditions,
            self._case.solver.linear,
            self._elastic,
            self.field,
            self._threads,
            smooth=self._case.adaptivity.coarse_part == "smooth",
        )

    def _undamaged(self, region: RefinedRegion) -> System:
        """Equations for another region, with contacts of the material everywhere, which stay elastic."""
        tessellation = self._discretized(region).without_shapes()
        linear, elastic = self._case.solver.linear, Regions.everywhere()
        return System(tessellation, self._material, self._law, self._conditions, linear, elastic, threads=self._threads)

    def _calibrated(self, system: System) -> System:
        """The same equations, their elastic part calibrated when the case asks for that."""
        if self._full or not self._case.adaptivity.calibrate:
            return system
        if self.compliance is None:
            self.compliance, self.compliance_error = self._found_compliance()
        return calibrated(system, self.compliance, self.system.elastic_scale)

    def _found_compliance(self) -> tuple[float, float | None]:
        """Compliance at full resolution [m/N], extrapolated for large specimens, and then its relative error."""
        if bodies_of_calibration(self.bodies_full) < self.bodies_full:
            region, before = region_from_case(self._case, self.domain, full=False), self.nuclei
            found = extrapolated_compliance(self._undamaged, region, self._conditions.points, self.bodies_full)
            self.nuclei = before  # a run does not carry along what only this has needed
            if found is not None:
                return found.compliance, found.error
        return gauge_compliance(self._equations(self._whole())), None

    @property
    def conditions(self) -> Conditions:
        """Supports, loads and gauges."""
        return self._conditions

    def calibrate(self) -> System:
        """Calibrate the equations of the start, and return them.

        Raises
        ------
        SingularMatrixError
            The structure is a mechanism.
        """
        self._change(self.layout, self._calibrated(self.system))
        return self.system

    def at(self, layout: Layout, drive: Drive, kept: FloatArray) -> System:
        """The equations of a layout of this specimen under what is driven; made again unless they are the current ones.

        Parameters
        ----------
        layout : Layout
            What is fine.
        drive : Drive
            What is driven.
        kept : (L,) array
            Forces of loads that act besides [N].
        """
        now = self.system
        if layout is not self.layout or drive is not now.drive or not np.array_equal(kept, now.kept):
            system, scale = self._equations(self._discretized(layout.region, now.tessellation)), layout.elastic_scale
            self.layout = layout
            self.system = _driving(system if scale == 1.0 else system.scaled(scale), drive, kept)
        return self.system

    def drive(self, drive: Drive, kept: FloatArray) -> None:
        """Let other loads be driven, as :meth:`at`."""
        self.system = self.system.driven(drive, kept)

    def assess(self, response: Response, load: float) -> tuple[ElasticState, FloatArray]:
        """How near to failure elastic bodies are.

        Parameters
        ----------
        response : Response
            A state of equilibrium on the current discretization.
        load : float
            Its load [N].

        Returns
        -------
        state : ElasticState
            What the criterion looks at.
        criterion : (n,) array
            Its value, 1 at strength; nan for fine bodies.

        Raises
        ------
        InputError
            The criterion does not give one value for each body.
        """
        system, tessellation = self.system, self.system.tessellation
        state = ElasticState(
            tessellation,
            system.stress(response, load),
            system.strength,
            system.elastic_utilisation(response),
            self._elastic.contains(tessellation.x),
        )
        value = np.asarray(self._criterion(state), float)
        if value.shape != (len(tessellation),):
            problem = f"it gives an array of shape {value.shape} for {len(tessellation)} bodies"
            raise InputError("adaptivity.criterion", problem, "a criterion that gives one value for each body")
        return state, np.where(tessellation.fine, np.nan, value)

    def refine(self, centers: FloatArray) -> System:
        """Refine around critical centres, shape (k, 3), and return the new equations.

        Raises
        ------
        InputError, SingularMatrixError
            The refined discretization cannot be used.
        """
        layout = self.layout.refined(centers)
        self._change(layout, self._changed(layout.region))
        return self.system

    def coarsen(self, response: Response, settle: Callable[[System], None]) -> bool:
        """Give up what is fine and not needed any more after an accepted step.

        Parameters
        ----------
        response : Response
            The accepted state.
        settle : callable
            Takes the new equations for the state.

        Returns
        -------
        bool
            Whether anything changed.

        Raises
        ------
        InputError, SingularMatrixError
            The coarser discretization cannot be used; then, and after an error of `settle`, nothing has changed.
        """
        if self._full or not self._case.adaptivity.coarsen or self.layout.stays_fine:
            return False
        self.layout = layout = replace(self.layout, coarsening=self.layout.coarsening.stepped())
        system = self.system
        needed = needed_bodies(
            system.tessellation,
            system.damageable,
            system.law,
            response.strain[system.damageable],
            response.history,
            self._case.adaptivity.gamma_coarse,
        )
        region = layout.coarsening.smaller(layout.region, system.tessellation, needed, self._fine_in)
        if region is None:
            return False
        changed = self._changed(region)
        settle(changed)
        self._change(layout.coarsened(region), changed)
        return True

    def _fine_in(self, region: RefinedRegion) -> int:
        """How many nuclei a region keeps fine."""
        return int((region.distance(self._known(region).x) <= 0.0).sum())

    def keep_fine(self) -> None:
        """Never coarsen again."""
        self.layout = replace(self.layout, stays_fine=True)

    def _change(self, layout: Layout, system: System) -> None:
        """Go over to another layout, but for its factor, and to its equations."""
        self.layout, self.system = replace(layout, elastic_scale=system.elastic_scale), system

    def _changed(self, region: RefinedRegion) -> System:
        """Equations for another region."""
        now = self.system
        found = self._calibrated(self._equations(self._discretized(region, now.tessellation)))
        return _driving(found, now.drive, now.kept)


def _driving(system: System, drive: Drive, kept: FloatArray) -> System:
    """Equations that drive the load of the last stage alone, under what is driven."""
    return system if drive is system.drive and not kept.any() else system.driven(drive, kept)
