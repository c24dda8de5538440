"""Running an ensemble: what is missing is computed, everything is written the moment it ends, then evaluated."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fissura.batch.cluster import check_scheduler
from fissura.batch.computing import compute_all
from fissura.batch.machines import Machines, require_packages, workers_that_fit
from fissura.batch.resuming import folder_for
from fissura.case import Case, case_of
from fissura.case.ensemble import Combine
from fissura.ensemble.outcome import Outcome, compute
from fissura.ensemble.plan import Plan
from fissura.ensemble.planning import planned
from fissura.ensemble.report import write_report
from fissura.ensemble.result import EnsembleResult
from fissura.ensemble.store import Store
from fissura.ensemble.table import table, write_table
from fissura.ensemble.task import Companions, Mode, Sampling, Task
from fissura.errors import FissuraError
from fissura.simulation.memory import require_memory

if TYPE_CHECKING:
    from distributed.deploy.cluster import Cluster

_log = logging.getLogger(__name__)

OnStart = Callable[[Plan, int, int], None]
OnOutcome = Callable[[dict[str, Any]], None]


def run_ensemble(
    case: Case | Mapping[str, Any] | str | Path,
    runs: int | None = None,
    *,
    output: str | Path,
    vary: Mapping[str, Any] | None = None,
    combine: Combine | None = None,
    seeds: Iterable[int] | None = None,
    mode: Mode | None = None,
    sampling: Sampling = "monte-carlo",
    leading_modes: int | None = None,
    seed: int | None = None,
    full: bool = False,
    companions: Companions | None = None,
    keep: bool = False,
    resume: bool = False,
    overwrite: bool = False,
    workers: int | None = None,
    threads_per_worker: int = 1,
    scheduler: str | Cluster | None = None,
    on_start: OnStart | None = None,
    on_outcome: OnOutcome | None = None,
) -> EnsembleResult:
    """Run many realisations of a case, at each point of a parameter study where keys are varied.

    A script that calls this needs the guard ``if __name__ == "__main__":``, as every program that starts processes.

    Parameters
    ----------
    case : Case, mapping or path
        Case; tables and keys as in a case file; or the TOML file that describes it. Its table ``[ensemble]`` holds for
        `runs`, `seeds`, `vary` and `combine` where these are not given.
    runs : int, optional
        Number of realisations; by default 1 at each point where keys are varied.
    output : path
        Folder for the results.
    vary : mapping of str to list, optional
        Values by dotted key of the case, as a case file gives them.
    combine : {"grid", "together"}, optional
        All combinations of these values, by default; or the first value of every key, then the second, and so on.
    seeds : iterable of int, optional
        Seeds of the realisations, each as of ``fissura run --seed``, instead of `runs` and `seed`.
    mode : {"geometry", "field", "both"}, optional
        What is random: the nuclei, the field of material, or both; by default both if the case has a field, else the
        nuclei.
    sampling : {"monte-carlo", "latin-hypercube"}, optional
        How the field is sampled.
    leading_modes : int, optional
        Modes of the field that Latin hypercube sampling stratifies; by default 10, or all if there are fewer.
    seed : int, optional
        Seed of the ensemble, from which those of all realisations are spawned; by default the seed of the case.
    full : bool, optional
        Full resolution instead of adaptive refinement.
    companions : {"one", "each", "none"}, optional
        Deterministic runs for comparison: one with the nuclei of the case, by default; one with those of each
        realisation; or none, by default where keys are varied.
    keep : bool, optional
        Keep all the files of every run, as ``output.vtk`` asks for them; by default its curve and summary only.
    resume : bool, optional
        Go on with what is in the folder.
    overwrite : bool, optional
        Whether the folder may hold an earlier ensemble, which is replaced.
    workers : int, optional
        Processes on this machine; by default one per processor, as far as memory allows.
    threads_per_worker : int, optional
        Threads of each of them, unless environment variables as MKL_NUM_THREADS are set already.
    scheduler : str or Cluster, optional
        Address of a Dask scheduler whose workers are used instead; or a cluster object of Dask, which brings along the
        credentials that its scheduler asks for.
    on_start : callable, optional
        Called with the plan, the number of runs to be computed, companions included, and of those already there.
    on_outcome : callable, optional
        Called with the summary of every run, after it was written.

    Returns
    -------
    EnsembleResult
        The table of runs and everything that was made from it.

    Raises
    ------
    InputError
        An argument, the case or the folder is wrong, or the optional dependencies are not installed; nothing has been
        computed then.
    EnsembleStopped
        The scheduler has gone, or no process can be started. As with KeyboardInterrupt and OSError, what has ended is
        on disk, and ``resume`` goes on.

    Examples
    --------
    >>> ensemble = fissura.run_ensemble(case, 2, output="results/ensemble", workers=1)
    >>> len(ensemble.peaks)
    2
    """
    require_packages("fissura ensemble", scheduler, "pyarrow", "jinja2")
    plan = planned(
        case_of(case),
        runs,
        vary=vary,
        combine=combine,
        seeds=seeds,
        mode=mode,
        sampling=sampling,
        leading_modes=leading_modes,
        seed=seed,
        full=full,
        companions=companions,
        keep=keep,
    )
    machines = Machines(workers, threads_per_worker, scheduler)
    return run_plan(
        plan, output, machines, resume=resume, overwrite=overwrite, on_start=on_start, on_outcome=on_outcome
    )


def run_plan(
    plan: Plan,
    output: str | Path,
    machines: Machines,
    *,
    resume: bool = False,
    overwrite: bool = False,
    on_start: OnStart | None = None,
    on_outcome: OnOutcome | None = None,
    report: bool = True,
) -> EnsembleResult:
    """Run an ensemble that is planned; arguments and errors are those of `run_ensemble`.

    Parameters
    ----------
    plan : Plan
        The ensemble.
    machines : Machines
        Where it is computed.
    report : bool, optional
        Whether statistics, pictures and the page are written, beside the table of runs.
    """
    if machines.scheduler is None:
        for point in plan.points:
            require_memory(point.case, full=plan.full)
    else:
        check_scheduler(machines.scheduler)
    store = Store(folder_for(output, "ensemble", resume=resume, overwrite=overwrite))
    if resume:
        warning = store.resume(plan)
        if warning:
            _log.warning(warning)
    else:
        store.begin(plan)
    _compute(plan, store, machines, on_start, on_outcome)
    return evaluate(plan, store, report=report)


def _compute(
    plan: Plan, store: Store, machines: Machines, on_start: OnStart | None, on_outcome: OnOutcome | None
) -> None:
    """Compute what is not there yet, and write it."""
    there, keys = store.kept(), list(plan.keys())
    for note in there.notes():
        _log.warning(note)
    done = there.done
    missing = [key for key in keys if key not in done]
    if on_start is not None:
        on_start(plan, len(missing), len(keys) - len(missing))
    if not missing:
        return
    if machines.scheduler is None:
        fit = min(workers_that_fit(point.case, full=plan.full) for point in plan.points)
        machines = replace(machines, workers=min(machines.workers or fit, len(missing)))
    warned: set[str] = set()

    def keep(task: Task, outcome: Outcome) -> None:
        summary = store.write(outcome)
        for text in summary.get("warnings", ()):  # of each kind one: every run has its own numbers
            kind = text.partition(":")[0]
            if kind not in warned:
                warned.add(kind)
                _log.warning("%s (%s %04d, perhaps others)", text, *task.key)
        if on_outcome is not None:
            on_outcome(summary)

    try:
        tasks = map(plan.task, missing)
        compute_all(compute, tasks, len(missing), machines, failed=Outcome.failed, keep=keep)
    except BaseException:
        # Whatever ended it, the table of what is there helps the user now.
        write_table(table(store.kept().summaries.values()), store.folder)
        raise


def evaluate(plan: Plan, store: Store, *, report: bool = True) -> EnsembleResult:
    """Write tables, statistics, pictures and the report of what is in the folder.

    An earlier ensemble may have had more runs; those beyond the plan's stay on disk, and out of the tables.
    """
    wanted = set(plan.keys())
    rows = table(summary for key, summary in store.kept().summaries.items() if key in wanted)
    write_table(rows, store.folder)
    result = EnsembleResult.of(plan, rows, store.folder)
    if not report:
        return result
    result.write()
    try:
        write_report(result)
    except FissuraError as error:  # the numbers are worth more than the page
        _log.warning("report.html was not written: %s", error)
    return result
