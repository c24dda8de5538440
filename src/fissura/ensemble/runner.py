"""Running an ensemble: what is missing is computed, everything is written the moment it ends, then evaluated."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Mapping
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fissura.case import Case, case_from_dict, load_case
from fissura.case.ensemble import Combine
from fissura.ensemble.cluster import check_scheduler, outcomes, require_packages, workers_that_fit
from fissura.ensemble.outcome import Outcome
from fissura.ensemble.plan import Companions, Key, Mode, Plan, Sampling
from fissura.ensemble.planning import planned
from fissura.ensemble.result import EnsembleResult
from fissura.ensemble.store import Store
from fissura.ensemble.table import table, write_table
from fissura.errors import EnsembleStopped, FissuraError, InputError
from fissura.kernels import prepare_cache
from fissura.machine.threads import side_by_side
from fissura.simulation.memory import require_memory

if TYPE_CHECKING:
    from distributed.deploy.cluster import Cluster

__all__ = ["run_ensemble", "run_plan"]

_log = logging.getLogger(__name__)


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
    on_start: Callable[[Plan, int, int], None] | None = None,
    on_outcome: Callable[[dict[str, Any]], None] | None = None,
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
    require_packages(cluster=scheduler is not None)
    case = case_from_dict(case) if isinstance(case, Mapping) else case if isinstance(case, Case) else load_case(case)
    plan = planned(
        case,
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
    return run_plan(
        plan,
        output,
        resume=resume,
        overwrite=overwrite,
        workers=workers,
        threads_per_worker=threads_per_worker,
        scheduler=scheduler,
        on_start=on_start,
        on_outcome=on_outcome,
    )


def run_plan(
    plan: Plan,
    output: str | Path,
    *,
    resume: bool = False,
    overwrite: bool = False,
    workers: int | None = None,
    threads_per_worker: int = 1,
    scheduler: str | Cluster | None = None,
    on_start: Callable[[Plan, int, int], None] | None = None,
    on_outcome: Callable[[dict[str, Any]], None] | None = None,
    report: bool = True,
) -> EnsembleResult:
    """Run an ensemble that is planned; arguments and errors are those of `run_ensemble`.

    Parameters
    ----------
    plan : Plan
        The ensemble.
    report : bool, optional
        Whether statistics, pictures and the page are written, beside the table of runs.
    """
    workers = None if workers is None else side_by_side("--workers", workers)
    threads_per_worker = side_by_side("--threads-per-worker", threads_per_worker)
    if scheduler is not None and workers is not None:
        raise InputError(
            "--workers", "is given together with --scheduler", "one of them: the scheduler has its workers"
        )
    if scheduler is not None and threads_per_worker != 1:
        raise InputError(
            "--threads-per-worker",
            "is given together with --scheduler, whose workers run already",
            "FISSURA_THREADS in the environment of these workers",
        )
    if scheduler is None:
        for point in plan.points:
            require_memory(point.case, full=plan.full)
    else:
        check_scheduler(scheduler)
    store = _folder(output, plan, resume=resume, overwrite=overwrite)
    _compute(plan, store, workers, threads_per_worker, scheduler, on_start, on_outcome)
    return evaluate(plan, store, report=report)


def _folder(output: str | Path, plan: Plan, *, resume: bool, overwrite: bool) -> Store:
    """The folder, ready to be written to."""
    from fissura.files.folder import prepare_folder

    if resume and overwrite:
        raise InputError("--resume", "is given together with --overwrite", "one of them")
    if resume and not Path(output).is_dir():
        raise InputError("--resume", f"there is no folder {output}", "the folder of an ensemble")
    store = Store(prepare_folder(output, "ensemble", overwrite=overwrite, go_on=resume))
    if resume:
        warning = store.resume(plan)
        if warning:
            _log.warning(warning)
    else:
        store.begin(plan)
    return store


def _compute(
    plan: Plan,
    store: Store,
    workers: int | None,
    threads: int,
    scheduler: str | Cluster | None,
    on_start: Callable[[Plan, int, int], None] | None,
    on_outcome: Callable[[dict[str, Any]], None] | None,
) -> None:
    """Compute what is not there yet."""
    there, keys = store.kept(), list(plan.keys())
    for note in there.notes():
        _log.warning(note)
    done = there.done
    missing = [key for key in keys if key not in done]
    if on_start is not None:
        on_start(plan, len(missing), len(keys) - len(missing))
    if not missing:
        return
    fit = min(workers_that_fit(point.case, full=plan.full) for point in plan.points)
    count = min(workers or fit, len(missing))
    if scheduler is None:
        prepare_cache()
    try:
        with closing(outcomes(map(plan.task, missing), count, threads, scheduler)) as arriving:
            collect(arriving, store, missing, on_outcome)
    except BaseException:
        # Whatever ended it, the table of what is there helps the user now.
        write_table(table(store.kept().summaries.values()), store.folder)
        raise


def collect(
    arriving: Iterable[Outcome],
    store: Store,
    missing: list[Key],
    on_outcome: Callable[[dict[str, Any]], None] | None = None,
) -> None:
    """Write what arrives.

    Raises
    ------
    EnsembleStopped
        Some of what was missing did not arrive.
    OSError
        A file cannot be written.
    """
    left, warned = set(missing), set[str]()
    try:
        for outcome in arriving:
            summary = store.write(outcome)
            left.discard(outcome.task.key)
            for text in summary.get("warnings", ()):  # of each kind one: every run has its own numbers
                key = text.partition(":")[0]
                if key not in warned:
                    warned.add(key)
                    _log.warning("%s (%s %04d, perhaps others)", text, *outcome.task.key)
            if on_outcome is not None:
                on_outcome(summary)
    except EnsembleStopped as error:
        raise EnsembleStopped(f"{error}; {len(left)} of {len(missing)} runs are missing") from error
    if left:
        raise EnsembleStopped(f"{len(left)} of {len(missing)} runs did not arrive")


def evaluate(plan: Plan, store: Store, *, report: bool = True) -> EnsembleResult:
    """Write tables, statistics, pictures and the report of what is in the folder.

    An earlier ensemble may have had more runs; those beyond the plan's stay on disk, and out of the tables.
    """
    from fissura.ensemble.report import write_report

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
