"""A report of whatever a folder holds."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fissura.errors import InputError
from fissura.folder import claimed, kind_of

if TYPE_CHECKING:
    from fissura.results.result import Result

__all__ = ["report"]

NAME = "report.html"

SUFFIXES = (".html", ".htm")


def report(source: Result | str | Path, path: str | Path | None = None) -> Path:
    """Write one page in HTML about a run, which needs no other file and no network; needs the extra ``report``.

    Parameters
    ----------
    source : Result or path
        A run, or the folder of its results.
    path : path, optional
        File to write, ``.html``; by default ``report.html`` in the folder of the results.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        The folder holds no results, the extra ``report`` is not installed, a file of that name is there that Fissura
        did not write, or the name does not end in ``.html``.
    OSError
        The file cannot be written.

    Examples
    --------
    >>> fissura.report("results/beam_d100")  # doctest: +SKIP
    PosixPath('results/beam_d100/report.html')
    >>> fissura.report(fissura.run("beam.toml"), "beam.html")  # doctest: +SKIP
    PosixPath('beam.html')
    """
    from fissura.reports.libraries import require_libraries
    from fissura.reports.run import write_run_page
    from fissura.results.result import Result

    require_libraries()
    result = source if isinstance(source, Result) else Result.load(source)
    wanted = _place(result.folder, path)
    write_run_page(result, wanted)
    return wanted


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
