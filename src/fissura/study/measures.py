"""How far an adaptive run is from the run at full resolution of the same specimen.

**Where the crack ran.** The *crack* of a run is the smallest set of contacts that dissipated half of its energy: those
with the largest energies. (With 95 % it would have diffuse damage in it, which in a prism is everywhere.) Of the energy
of the adaptive run, the *share on the crack of full resolution* was dissipated by contacts whose facet has its centroid
within ``l_f`` of that of a contact of this crack. The run at full resolution itself does not reach 100 % in this
measure; what it reaches is reported, too. Sharper is the *overlap*: contacts are the same when they join the same two
nuclei, and the overlap is the energy that both runs dissipated in the same contacts, ``sum min(W_a, W_f) / W_f``.

**Energies** are compared at the same end: at the smaller of the last gauges (or displacements of the load, where these
are controlled) where loads are compared over them; where they are compared over dissipated energy, when the load has
fallen to the larger of the last loads.
"""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from fissura.adaptivity import load_error_bound
from fissura.arrays import IntArray
from fissura.errors import InputError
from fissura.results.compare import compare_results
from fissura.results.curve import COLUMN_OF, peak_position
from fissura.study.indicators import INDICATORS
from fissura.study.record import Energies, Record

CRACK = 0.5
"""Share of the dissipated energy that makes the crack."""


@dataclass(frozen=True)
class Measures:
    """Differences are fractions of the value at full resolution, positive where the adaptive run is larger.

    Attributes
    ----------
    specimen, variation : str
    seed : int
    end, end_full : str
        What ended the runs: "target", "load", "stopped", "refused", "failed".
    message : str
        Why, if the adaptive run did not finish.
    over : str
        What loads are compared over.
    load, peak, energy, stiffness : float
        Largest difference of loads over the peak; differences of the peak, the dissipated energy, and the initial
        stiffness. nan where a run has no steps.
    at : float
        Load at full resolution at the largest difference of loads, over its peak; negative before the peak.
    crack, crack_full, overlap : float
        Where the crack ran, see above.
    position, position_full : float
        Of the crack along x [m], see `crack_position`.
    bodies_start, bodies_end, bodies_full : int
    refinements : int
        Re-tessellations, each of which repeats a step.
    cpu, cpu_full, cpu_ratio : float
        Processor times [s], full over adaptive.
    effort_ratio : float
        Bodies times linear iterations, summed over the steps, full over adaptive: what `cpu_ratio` would be if nothing
        else cost anything. It is the same on every machine, however busy.
    repeated, refining : float
        Share of the adaptive run's processor time in solutions that were given up, and in re-tessellation.
    bound : float
        What the run itself gives as a bound of `load`; see `fissura.adaptivity.load_error_bound`.
    indicators : dict of str to float
        Largest value of every indicator over the run; of the calibration the last one.
    """

    specimen: str
    seed: int
    variation: str
    end: str
    end_full: str
    message: str
    over: str = ""
    load: float = math.nan
    at: float = math.nan
    peak: float = math.nan
    energy: float = math.nan
    stiffness: float = math.nan
    crack: float = math.nan
    crack_full: float = math.nan
    overlap: float = math.nan
    position: float = math.nan
    position_full: float = math.nan
    bodies_start: int = 0
    bodies_end: int = 0
    bodies_full: int = 0
    refinements: int = 0
    cpu: float = math.nan
    cpu_full: float = math.nan
    cpu_ratio: float = math.nan
    effort_ratio: float = math.nan
    repeated: float = math.nan
    refining: float = math.nan
    bound: float = math.nan
    indicators: dict[str, float] | None = None

    @property
    def compared(self) -> bool:
        """Whether both runs have a curve that could be compared."""
        return not math.isnan(self.load)

    @property
    def finished(self) -> bool:
        """Whether both runs came to the end that their case asks for."""
        return {self.end, self.end_full} <= {"target", "load"}

    @property
    def used(self) -> float:
        """Largest utilisation of elastic contacts; nan where it is not known."""
        return (self.indicators or {}).get("utilisation", math.nan)

    def row(self) -> dict[str, Any]:
        """All values by name, indicators among them as ``indicator_...``."""
        values = asdict(self)
        known = values.pop("indicators") or dict.fromkeys(INDICATORS, math.nan)
        return values | {f"indicator_{name}": value for name, value in known.items()}


def measure(adaptive: Record, full: Record) -> Measures:
    """Compare an adaptive run with its twin at full resolution; what cannot be compared is nan."""
    message = adaptive.message.strip().splitlines()[-1] if adaptive.message.strip() else ""
    head = (adaptive.specimen, adaptive.seed, adaptive.variation, adaptive.end, full.end, message)
    if not adaptive.steps or not full.steps:
        return Measures(*head)
    try:
        found = compare_results(adaptive.result(), full.result())
    except InputError as error:
        return Measures(*head[:-1], message or error.problem)
    l_f = float(full.case["discretization"]["l_f"])
    peak_at = peak_position(full.curve["load_N"])
    key = "dissipated_J" if found.by_energy else COLUMN_OF[found.quantity]
    after = found.at_max_difference > full.curve[key][peak_at]
    load_there = float(np.interp(found.at_max_difference, found.abscissa, found.load_b) / found.peaks[1])
    summary = adaptive.summary
    names = ("bodies_start", "bodies_end", "bodies_full", "refinements")
    counts: dict[str, Any] = {name: int(summary[name]) for name in names}
    cpu, cpu_full = float(summary["cpu_s"]), float(full.summary["cpu_s"])
    return Measures(
        *head,
        over=found.over,
        load=found.max_load_difference,
        at=load_there if after else -load_there,
        peak=found.peak_difference,
        energy=_energy_difference(adaptive, full) if found.by_energy else found.energy_difference,
        stiffness=found.stiffness_difference,
        crack=crack_share(adaptive.energies, full.energies, l_f),
        crack_full=crack_share(full.energies, full.energies, l_f),
        overlap=overlap(adaptive.energies, full.energies),
        position=crack_position(adaptive.energies),
        position_full=crack_position(full.energies),
        **counts,
        cpu=cpu,
        cpu_full=cpu_full,
        cpu_ratio=cpu_full / cpu,
        effort_ratio=_effort(full) / _effort(adaptive),
        repeated=float(summary["cpu_repeated_s"]) / cpu,
        refining=float(summary["cpu_refining_s"]) / cpu,
        bound=load_error_bound(
            float(adaptive.indicators["utilisation"].max()),
            float(adaptive.case["adaptivity"]["r_f"]) / l_f,
            float(summary.get("calibration_error") or 0.0),
        ),
        indicators={name: float(values.max()) for name, values in adaptive.indicators.items()}
        | {"calibration": abs(float(summary["elastic_scale"]) - 1.0)},
    )


def crack_of(energies: Energies) -> IntArray:
    """Contacts of the crack: the fewest that dissipated `CRACK` of the energy; indices, the largest energy first."""
    order = np.argsort(-energies.energy, kind="stable")
    before = np.cumsum(energies.energy[order]) - energies.energy[order]
    crack: IntArray = order[before < CRACK * energies.energy.sum()]
    return crack


def crack_share(adaptive: Energies, full: Energies, reach: float) -> float:
    """Part of the energy that was dissipated within a distance of the crack of full resolution; nan without energy.

    Parameters
    ----------
    adaptive, full : Energies
        Of both runs.
    reach : float
        Largest distance of centroids of facets [m].
    """
    if not len(adaptive) or not len(full):
        return math.nan
    away = cKDTree(full.centroid[crack_of(full)]).query(adaptive.centroid)[0]
    return float(adaptive.energy[away <= reach].sum() / adaptive.energy.sum())


def overlap(adaptive: Energies, full: Energies) -> float:
    """Energy that both runs dissipated in the same contacts, over that of full resolution; nan without energy."""
    if not len(adaptive) or not len(full):
        return math.nan
    nuclei, number = np.unique(np.concatenate([adaptive.pairs, full.pairs]), return_inverse=True)  # of few digits
    keys = number.reshape(-1, 2) @ np.array([len(nuclei), 1])
    of_a, of_f = keys[: len(adaptive)], keys[len(adaptive) :]
    _, in_a, in_f = np.intersect1d(of_a, of_f, assume_unique=True, return_indices=True)
    both = np.minimum(adaptive.energy[in_a], full.energy[in_f])
    return float(both.sum() / full.energy.sum())


def crack_position(energies: Energies) -> float:
    """Coordinate x [m] with half of the energy on either side; nan without energy.

    A median, as little damage far from the crack should not count.
    """
    if not len(energies):
        return math.nan
    order = np.argsort(energies.centroid[:, 0], kind="stable")
    total = np.cumsum(energies.energy[order])
    return float(energies.centroid[order[np.searchsorted(total, 0.5 * total[-1])], 0])


def _effort(record: Record) -> float:
    """Bodies times linear iterations, summed over the steps; at least one, so that ratios are finite."""
    return max(float(record.curve["bodies"] @ record.curve["linear_iterations"]), 1.0)


def _energy_difference(adaptive: Record, full: Record) -> float:
    """Difference of the energies at which the loads have fallen to the larger of the last ones."""
    level = max(abs(float(record.curve["load_N"][-1])) for record in (adaptive, full))
    a, f = (_energy_at(record, level) for record in (adaptive, full))
    return a / f - 1.0 if f > 0.0 else math.nan


def _energy_at(record: Record, level: float) -> float:
    """Energy when the load falls below a level for the last time [J]."""
    load, energy = np.abs(record.curve["load_N"]), record.curve["dissipated_J"]
    above = np.flatnonzero(load > level)
    if not len(above) or above[-1] + 1 == len(load):
        return float(energy[-1])
    k = int(above[-1])
    share = (load[k] - level) / (load[k] - load[k + 1])
    return float(energy[k] + share * (energy[k + 1] - energy[k]))
