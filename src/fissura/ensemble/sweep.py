"""Parameter studies from Python: an ensemble at each of several points."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fissura.case import Case
from fissura.case.ensemble import Combine
from fissura.case.types import whole
from fissura.ensemble.plan import Plan
from fissura.ensemble.result import EnsembleResult
from fissura.ensemble.runner import run_ensemble
from fissura.ensemble.task import Mode
from fissura.errors import InputError

if TYPE_CHECKING:
    from distributed.deploy.cluster import Cluster


class _Temporary:
    """A folder that is removed when nothing refers to this any more, at the end of the program at the latest."""

    def __init__(self) -> None:
        self.path = Path(tempfile.mkdtemp(prefix="fissura_"))
        weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)


def sweep(
    case: Case | Mapping[str, Any] | str | Path,
    vary: Mapping[str, Any] | None = None,
    *,
    combine: Combine | None = None,
    seeds: int | Iterable[int] | None = None,
    output: str | Path | None = None,
    mode: Mode | None = None,
    full: bool = False,
    resume: bool = False,
    overwrite: bool = False,
    workers: int | None = None,
    threads_per_worker: int = 1,
    scheduler: str | Cluster | None = None,
    on_start: Callable[[Plan, int, int], None] | None = None,
    on_outcome: Callable[[dict[str, Any]], None] | None = None,
) -> EnsembleResult:
    """Run a case with several values of some of its keys.

    A script that calls this needs the guard ``if __name__ == "__main__":``, as every program that starts processes.

    Parameters
    ----------
    case : Case, mapping or path
        Case; tables and keys as in a case file; or the TOML file that describes it.
    vary : mapping of str to list, optional
        Values by dotted key of the case, as a case file gives them; by default those of its table ``[ensemble]``.
    combine : {"grid", "together"}, optional
        All combinations of these values, by default; or the first value of every key, then the second, and so on.
    seeds : int or iterable of int, optional
        How many random structures are broken at each point, or their seeds; the same ones at all points. By default
        that of the case alone.
    output : path, optional
        Folder for the results. Without it they last as long as the result does; `EnsembleResult.save` keeps them.
    mode, full, resume, overwrite, workers, threads_per_worker, scheduler, on_start, on_outcome : optional
        As of `fissura.run_ensemble`.

    Returns
    -------
    EnsembleResult
        Its `groups` are the points.

    Raises
    ------
    InputError
        A key is not known, a value is wrong, or as of `fissura.run_ensemble`; nothing has been computed then.
    EnsembleStopped
        The scheduler has gone, or no process can be started; ``resume`` goes on.

    Examples
    --------
    >>> study = fissura.sweep(case, {"material.f_t": ["2 MPa", "3 MPa"]}, seeds=2, workers=1)
    >>> ax = study.plot()
    >>> weak, strong = study.to_dataframe(groups=True)["mean_peak_load_N"]
    >>> weak < strong
    True
    """
    runs = whole(seeds)
    if resume and output is None:
        raise InputError("output", "is missing: resume goes on with what is in a folder", "the folder of the study")
    kept = None
    if output is None:
        kept = _Temporary()
        output = kept.path
    result = run_ensemble(
        case,
        runs,
        vary=vary,
        combine=combine,
        seeds=None if runs is not None or seeds is None else _listed(seeds),
        output=output,
        mode=mode,
        full=full,
        resume=resume,
        overwrite=overwrite,
        workers=workers,
        threads_per_worker=threads_per_worker,
        scheduler=scheduler,
        on_start=on_start,
        on_outcome=on_outcome,
    )
    return replace(result, _kept=kept)


def _listed(seeds: Any) -> list[int]:
    if isinstance(seeds, str | Mapping) or not isinstance(seeds, Iterable):
        raise InputError("seeds", f"{seeds!r} is neither a number nor a list", "a whole number, or a list of them")
    return list(seeds)
