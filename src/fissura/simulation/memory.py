"""Memory that runs need, by their number of bodies."""

import numpy as np

from fissura.adaptivity import bodies_of_calibration
from fissura.case import Case
from fissura.case.plausible import suspect
from fissura.errors import InputError
from fissura.machine.memory import gigabytes, physical_memory
from fissura.material import Regions
from fissura.simulation import limits
from fissura.specimen import Domain, domain_from_case
from fissura.specimen.notches import SURFACE
from fissura.tessellation import needed_spacing


def estimate_bodies(case: Case) -> float:
    """Estimate how many bodies full resolution has.

    Saturated nuclei in a specimen with free surfaces: ``0.734`` for every cube of side ``l_f``, ``0.740`` in blocks,
    with 0.3 of a layer more on the surface; exact for a box, edges and corners included. Walls of notches have no such
    layer: nuclei keep their distance across a notch, too.

    Returns
    -------
    float
        Number of bodies, not rounded; may be infinite for absurd sizes.
    """
    return _estimated(case, domain_from_case(case), case.discretization.l_f)


def estimated_bodies(case: Case, domain: Domain) -> int:
    """What :func:`estimate_bodies` gives for a domain that is there, to three digits."""
    return int(float(f"{_estimated(case, domain, case.discretization.l_f):.3g}"))


def _estimated(case: Case, domain: Domain, spacing: float) -> float:
    area = sum(part.area for part in domain.faces(*(name for name in domain.surfaces if name != SURFACE)))
    layers = domain.volume / spacing**3 + 0.3 * area / spacing**2 + 0.36 * float(domain.size.sum()) / spacing + 0.216
    density = limits.IN_BLOCKS if case.discretization.placement == "blocks" else limits.SATURATED
    return density * layers


def estimate_memory(bodies: float) -> float:
    """Estimate the memory of a run [bytes], all solvers being linear in the number of bodies.

    Measured at full resolution: 1.0 GB for a whole run of 23 647 bodies, far past its peak, and 2.9 GB for 101 000
    while damage grows. This is an eighth more than the first, and a third more than the second, for which the files
    and the states that a run keeps are still to come.
    """
    return limits.BYTES_OF_RUN * bodies + limits.BYTES_BESIDES


def estimate_elastic_memory(bodies: float) -> float:
    """Estimate the memory of one elastic solution at full resolution [bytes], as calibration needs it.

    Measured, tessellation and iterative solver together: 0.45 GB for 23 647 bodies, 1.25 GB for 103 603.
    """
    return limits.BYTES_OF_SOLUTION * bodies + limits.BYTES_BESIDES


def _fine_share(case: Case, domain: Domain) -> float:
    """Share of a specimen that its regions make fine from the start, counted at points of a lattice."""
    if not case.adaptivity.regions:
        return 0.0
    low, high = domain.complex.low.min(axis=0), domain.complex.high.max(axis=0)
    along = [np.linspace(a, b, 2 * limits.LATTICE + 1)[1::2] for a, b in zip(low, high, strict=True)]
    points = np.stack(np.meshgrid(*along), axis=-1).reshape(-1, 3)
    points = points[domain.cell_of(points) >= 0]
    fine = Regions.from_parts(case.adaptivity.regions).distance(points) <= 0.0
    return float(fine.mean()) if len(points) else 0.0


def require_memory(case: Case, *, full: bool = False) -> None:
    """Refuse a case that cannot fit into this machine, before its nuclei are placed.

    Parameters
    ----------
    case : Case
        Case to run.
    full : bool, optional
        Whether full resolution is to be solved, not only placed.

    Raises
    ------
    InputError
        If the nuclei of the whole specimen, or with ``full`` the solver, or calibration, need more memory than
        there is.
    """
    domain, machine, l_f = domain_from_case(case), physical_memory(), case.discretization.l_f
    bodies = _estimated(case, domain, l_f)
    if case.discretization.nuclei is not None:
        bodies *= limits.SPARSEST
    size = " x ".join(f"{length:g}" for length in domain.size)
    least = "at least" if case.discretization.nuclei is not None else "about"
    problem = f"{l_f:g} m in a specimen of {size} m means {least} {bodies:.2g} bodies"
    odd = suspect(case, "specimen")
    part, placed = case.discretization, bodies
    if part.placement == "blocks" and not full:  # what is coarse, and what regions refine from the start
        placed = _estimated(case, domain, needed_spacing(part.l_f, part.l_c)) + _fine_share(case, domain) * bodies
    if odd is not None and placed * limits.BYTES_PER_NUCLEUS > machine:
        raise InputError(odd.key, f"{odd.problem}; {problem}", odd.advice)
    if placed > limits.MOST_BODIES:
        raise InputError("discretization.l_f", problem, f"a spacing that gives at most {limits.MOST_BODIES:.0e} bodies")
    need = placed * limits.BYTES_PER_NUCLEUS
    if full:
        need = max(need, estimate_memory(bodies))
    if need > machine:
        task = "solving them" if full else "placing them"
        raise InputError(
            "discretization.l_f",
            f"{problem}; {task} takes about {gigabytes(need)}, this machine has {gigabytes(machine)}",
            "a larger spacing" + (", or a run without full resolution" if full else ""),
        )
    # Calibration solves the elastic structure once at full resolution, or where that is large, coarser ones.
    elastic = estimate_elastic_memory(bodies_of_calibration(bodies))
    if not full and case.adaptivity.calibrate and elastic > machine:
        raise InputError(
            "adaptivity.calibrate",
            f"{problem}; their elastic solution takes about {gigabytes(elastic)}, this machine has"
            f" {gigabytes(machine)}",
            "false, or a larger spacing",
        )
