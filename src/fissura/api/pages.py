"""A report of whatever a folder holds."""

import logging
from collections.abc import Callable
from pathlib import Path

from fissura.ensemble.report import write_report
from fissura.ensemble.result import EnsembleResult
from fissura.errors import InputError
from fissura.files.folder import claimed, kind_of
from fissura.reports.libraries import require_libraries
from fissura.reports.page import write_page
from fissura.reports.run import run_page
from fissura.results.result import Result

logger = logging.getLogger(__name__)

NAME = "report.html"

SUFFIXES = (".html", ".htm")


def report(
    source: Result | EnsembleResult | str | Path,
    path: str | Path | None = None,
    *,
    runs: bool = False,
    on_run: Callable[[int, int], None] | None = None,
) -> Path:
    """Write one page in HTML about a run or an ensemble, which needs no other file and no network.

    It needs the extra ``report``.

    Parameters
    ----------
    source : Result, EnsembleResult or path
        A run, an ensemble, or the folder of its results.
    path : path, optional
        File to write, ``.html``; by default ``report.html`` in the folder of the results.
    runs : bool, optional
        Of an ensemble: write the pages of its runs, too, each in the folder of the run; the table links them.
    on_run : callable, optional
        Called with how many of these pages are written, and how many there will be.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        The folder holds no results, the extra ``report`` is not installed, a file of that name is there that Fissura
        did not write, the name does not end in ``.html``, or `runs` is asked for of a single run.
    OSError
        The file cannot be written.

    Examples
    --------
    >>> fissura.report(result, "beam.html").name
    'beam.html'
    """
    require_libraries()
    if isinstance(source, str | Path):
        source = EnsembleResult.load(source) if kind_of(Path(source)) == "ensemble" else Result.load(source)
    if isinstance(source, EnsembleResult):
        return _ensemble(source, path, runs=runs, on_run=on_run)
    if runs:
        raise InputError("--runs", "is for ensembles, and this is a single run", "the folder of an ensemble")
    wanted = _place(source.folder, path)
    write_page(run_page(source), wanted)
    return wanted


def _ensemble(
    result: EnsembleResult, path: str | Path | None, *, runs: bool, on_run: Callable[[int, int], None] | None
) -> Path:
    wanted = _place(result.folder, path)
    if runs:
        _runs(result, on_run)
    return write_report(result, None if path is None else wanted)


def _runs(result: EnsembleResult, on_run: Callable[[int, int], None] | None) -> None:
    """Write the pages of all runs and companions; what cannot be read is a warning."""
    count = len(result.rows["number"])
    keys = zip(result.rows["kind"].tolist(), result.rows["number"].tolist(), strict=True)
    for done, (kind, number) in enumerate(keys, 1):
        try:
            result.result(number, kind).report()
        except InputError as error:
            logger.warning("%s %04d has no page: %s", kind, number, error)
        if on_run is not None:
            on_run(done, count)


def _place(folder: Path | None, path: str | Path | None) -> Path:
    """Where a page goes.

    Raises
    ------
    InputError
        Nowhere.
    """
    if path is None:
        if folder is None:
            raise InputError("path", "is missing: the run was kept in memory only", "the name of a file, .html")
        return claimed(folder / NAME, "--output")
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        raise InputError("--output", f"{path}: reports are written as .html only", "a name that ends in .html")
    if kind_of(path.parent) is not None:
        claimed(path, "--output")
    return path
