"""Running a calibration: rounds of ensembles, then what they say."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from fissura.batch.cluster import check_scheduler
from fissura.batch.machines import Machines, require_packages
from fissura.batch.resuming import check_same, folder_for, head_of
from fissura.calibration.evaluate import evaluated
from fissura.calibration.observed import observed
from fissura.calibration.problem import Problem
from fissura.calibration.report import write_report
from fissura.calibration.request import (
    DEFAULT_UNKNOWNS,
    Request,
    is_request,
    problem_of,
    read_request,
    request_of,
)
from fissura.calibration.result import Calibration
from fissura.calibration.runs import OnRound, Rounds
from fissura.calibration.search import least_runs, search
from fissura.case import Case
from fissura.case.report import input_error
from fissura.errors import InputError
from fissura.files.atomic import write_atomically, write_json
from fissura.files.folder import Folder, folder_name
from fissura.files.lock import locked
from fissura.results.provenance import versions
from fissura.results.summary import FORMAT_VERSION, read_summary

if TYPE_CHECKING:
    from distributed.deploy.cluster import Cluster


RUNS, RUNS_MORE = 40, 20
"""Runs at most, of each test, unless told otherwise and unless the first rounds need more; and how many more of each
unknown beyond the third."""

_FILES = ("calibration.json", "calibration.png", "calibration.html")


def calibrate(
    case: Case | Mapping[str, Any] | str | Path,
    measured: str | Path | Iterable[str | Path] | None = None,
    unknowns: Iterable[str] | Mapping[str, Any] | None = None,
    *,
    output: str | Path,
    fixed: Mapping[str, Any] | None = None,
    seeds: int | None = None,
    runs: int | None = None,
    seed: int | None = None,
    specimens: int | None = None,
    units: Iterable[str] = (),
    columns: Iterable[str] = (),
    full: bool = False,
    resume: bool = False,
    overwrite: bool = False,
    workers: int | None = None,
    threads_per_worker: int = 1,
    scheduler: str | Cluster | None = None,
    on_start: Callable[[Problem, int], None] | None = None,
    on_round: OnRound | None = None,
    on_outcome: Callable[[dict[str, Any]], None] | None = None,
) -> Calibration:
    """Find keys of a case from measured curves, with standard errors.

    A script that calls this needs the guard ``if __name__ == "__main__":``, as every program that starts processes.

    Parameters
    ----------
    case : Case, mapping or path
        Case, or the TOML file that describes it; or, without `measured`, tests and unknowns: a mapping with ``test``
        and ``unknowns``, or the TOML file that has them.
    measured : path or iterable of path, optional
        CSV file with a measured curve or band, or several with a curve each, one for each specimen.
    unknowns : iterable of str or mapping, optional
        Keys to find; a mapping tells ``start``, ``lower`` and ``upper`` of each. By default ``material.f_t`` and
        ``material.G_t``, from a quarter to four times what the case has.
    output : path
        Folder for the results.
    fixed : mapping, optional
        Values by key that the case gets before, such as ``{"material.macro.E": "37 GPa"}``.
    seeds : int, optional
        Random structures of each full round; 6 by default, at least 2.
    runs : int, optional
        Runs at most; by default 40 for each test, 20 more for each unknown beyond the third, or what the first rounds
        need.
    seed : int, optional
        From which the seeds of the structures are spawned; by default that of the (first) case.
    specimens : int, optional
        How many specimens are behind a mean curve (by default 1) or a band (2).
    units, columns : iterable of str, optional
        Units of the columns of the files, and names of those that are meant.
    full : bool, optional
        Full resolution instead of adaptive refinement.
    resume : bool, optional
        Go on with what is in the folder.
    overwrite : bool, optional
        Whether the folder may hold an earlier calibration, which is replaced.
    workers : int, optional
        Processes on this machine; by default one per processor, as far as memory allows.
    threads_per_worker : int, optional
        Threads of each of them.
    scheduler : str or Cluster, optional
        Address of a Dask scheduler whose workers are used instead, or a cluster object of Dask.
    on_start : callable, optional
        Called with the problem and the most runs, before the first.
    on_round : callable, optional
        Called before each round with its number, the values by key that are run, and the seeds of each.
    on_outcome : callable, optional
        Called with the summary of every run.

    Returns
    -------
    Calibration
        Estimates, their errors, and how the curves fit.

    Raises
    ------
    InputError
        An argument, a key, a bound or a file is wrong: nothing has been computed then. Or an unknown does not affect
        the curves, or unknowns cannot be told apart, which the first rounds tell.
    EnsembleStopped
        The scheduler has gone, or no process can be started. As with KeyboardInterrupt and OSError, what has ended is
        on disk, and ``resume`` goes on.

    Examples
    --------
    >>> options = {"output": "results/strength", "seeds": 2, "runs": 8, "workers": 1}
    >>> found = fissura.calibrate(case, "results/first/curve.csv", ["material.f_t"], **options)
    >>> estimate = found.estimates["material.f_t"]
    >>> estimate.low < estimate.value < estimate.high
    True
    >>> ax = found.plot()
    """
    require_packages("fissura calibrate", scheduler, "pyarrow", "jinja2")
    machines = Machines(workers, threads_per_worker, scheduler)
    numbers = {"seeds": seeds, "runs": runs, "seed": seed}
    files = {"specimens": specimens, "units": list(units), "columns": list(columns)}
    request, folder = _requested(case, measured, unknowns, fixed, numbers, files)
    problem = problem_of(request, folder)
    tests = [observed(test) for test in problem.tests]
    most = _most(problem, request)
    if scheduler is not None:
        check_scheduler(scheduler)
    place = folder_for(output, "calibration", resume=resume, overwrite=overwrite)
    if resume:
        inputs = _inputs(problem, request, full=full)
        check_same(place, head_of(place, "calibration").get("inputs"), inputs)
    with locked(place):
        _begin(place, problem, request, full=full, resume=resume)
        if on_start is not None:
            on_start(problem, most)
        told: dict[str, Any] = {"on_round": on_round, "on_outcome": on_outcome}
        rounds = Rounds(problem, tests, place, master=request.seed, full=full, machines=machines, **told)
        found = search(problem, tests, rounds, request.seeds, most)
        result = evaluated(problem, found, place)
        _write(result, problem, request)
    return result


def _requested(
    case: Any,
    measured: Any,
    unknowns: Any,
    fixed: Mapping[str, Any] | None,
    numbers: Mapping[str, int | None],
    files: Mapping[str, Any],
) -> tuple[Request, Path]:
    """What is asked for by arguments, and the folder to which its paths are relative."""
    more: dict[str, Any] = {name: value for name, value in numbers.items() if value is not None}
    is_mapping = isinstance(case, Mapping) and "test" in case
    if measured is None:
        if not is_mapping and (isinstance(case, Case | Mapping) or not is_request(Path(case))):
            raise InputError(
                "MEASURED", "is missing", "a CSV file; or, instead of the case, a file with tables [[test]]"
            )
        request, folder = (request_of(case), Path()) if is_mapping else read_request(case)
        if fixed:
            more["fixed"] = {**request.fixed, **fixed}
        if unknowns is not None:
            more["unknowns"] = _entries(unknowns)
        for name, value in files.items():
            if value:
                raise InputError(name, "is given together with a file of tests", f"{name} in its tables [[test]]")
        return _copied(request, more), folder
    given = {name: value for name, value in files.items() if value is not None}
    test = {"case": case, "measured": [measured] if isinstance(measured, str | Path) else list(measured), **given}
    data = {"test": [test], "unknowns": _entries(unknowns), "fixed": dict(fixed or {}), **more}
    if not isinstance(case, Mapping):
        data["name"] = case.name if isinstance(case, Case) else folder_name(Path(case).stem)
    request = request_of(data)
    if numbers["seed"] is None:
        first = problem_of(request).tests[0].case
        request = _copied(request, {"seed": first.seed})
    return request, Path()


def _entries(unknowns: Any) -> dict[str, Any]:
    if unknowns is None:
        return dict.fromkeys(DEFAULT_UNKNOWNS)
    if isinstance(unknowns, Mapping):
        return dict(unknowns)
    return dict.fromkeys([unknowns] if isinstance(unknowns, str) else list(unknowns))


def _copied(request: Request, update: Mapping[str, Any]) -> Request:
    try:
        return request.model_copy(update=update)
    except ValidationError as error:
        raise input_error(error, Request, update) from None


def _most(problem: Problem, request: Request) -> int:
    """Runs at most."""
    least = least_runs(problem, request.seeds)
    if request.runs is None:
        usual = RUNS + RUNS_MORE * max(len(problem.unknowns) - 3, 0)
        return max(usual * len(problem.tests), least)
    if request.runs < least:
        what = f"{request.seeds} seeds, {len(problem.unknowns)} unknowns and {len(problem.tests)} tests"
        raise InputError("runs", f"{request.runs} are too few for {what}", f"at least {least}, or fewer seeds")
    return request.runs


def _inputs(problem: Problem, request: Request, *, full: bool) -> dict[str, Any]:
    return {**problem.as_dict(), "seeds": request.seeds, "seed": request.seed, "full": full}


def _begin(place: Path, problem: Problem, request: Request, *, full: bool, resume: bool) -> None:
    """Mark the folder, and write down what is asked for."""
    from fissura.calibration.written import files_of

    own = Folder.kept(place, "calibration") if resume else Folder.begun(place, "calibration")
    own.add(*_FILES, *files_of(problem).values())
    if resume:
        return
    data = {"format_version": FORMAT_VERSION, "inputs": _inputs(problem, request, full=full), "versions": versions()}
    write_json(place / "calibration.json", {**data, "result": None})


def _write(result: Calibration, problem: Problem, request: Request) -> None:
    """Write what was found."""
    from fissura.calibration.written import case_text, files_of

    data = read_summary(result.folder / "calibration.json")
    write_json(result.folder / "calibration.json", {**data, "versions": versions(), "result": result.as_dict()})
    found = {key: estimate.text["value"] for key, estimate in result.estimates.items()}
    values = {
        key: float(text) if problem.unknowns[k].dimension is None else text
        for k, (key, text) in enumerate(found.items())
    }
    names = files_of(problem)
    for test in problem.tests:
        text = case_text(test.case, {**request.fixed, **values}, result.folder)
        write_atomically(result.folder / names[test.name], text.encode())
    write_report(result)
