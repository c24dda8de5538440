"""What a run leaves behind, in memory or reloaded from its folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from fissura.case import case_from_dict
from fissura.errors import InputError
from fissura.files.tables import read_json
from fissura.results.curve import read_curve
from fissura.results.state import read_states
from fissura.results.summary import curve_numbers, read_summary, result_folder
from fissura.results.views import Views
from fissura.text.quantities import counted


@dataclass(frozen=True, repr=False, eq=False)
class Result(Views):
    """Results of one run.

    Attributes
    ----------
    case : Case
        What was run.
    full : bool
        Whether the whole specimen was fine from the start.
    curve : dict of str to (steps,) array
        The curve; keys are the columns of ``curve.csv`` (`fissura.results.curve.COLUMNS`).
    summary : dict
        Content of ``summary.json``.
    snapshots : dict of int to Snapshot
        States by step number: those chosen for ParaView, that of the peak load, and the last. Results of a folder that
        a run has written have the last one only; `save` writes all.
    folder : Path or None
        Where the files are; None when nothing was written.
    sections : tuple of Frame
        What `frames` gives for a run of this process; empty where the results were read from a folder.

    Examples
    --------
    >>> result.status, result.steps == len(result.gauge)
    ('finished', True)
    >>> float(result.load_values.max()) == result.peak_load
    True
    >>> bool(result.last.opening.max() > 0.0)
    True
    """

    @classmethod
    def load(cls, folder: str | Path) -> Result:
        """Read a result folder, such as `fissura.run` and `save` leave it.

        A run that was killed before its end can be loaded too; its status is ``"running"`` and it has no
        snapshots.

        Parameters
        ----------
        folder : path
            The folder.

        Returns
        -------
        Result
            What was in it. Of the states, the last one is there, and those of other steps that `save` has written.

        Raises
        ------
        InputError
            There is no such folder, or a file in it is missing or broken.

        Examples
        --------
        >>> Result.load(folder).status
        'finished'
        """
        folder = result_folder(folder)
        curve, summary = read_curve(folder / "curve.csv"), read_summary(folder / "summary.json")
        if summary.get("status") == "running":
            summary |= curve_numbers(curve)  # it is written every second only, the curve after every step
        steps, told = len(curve["step"]), summary.get("steps")
        if summary.get("status") != "running" and isinstance(told, int) and told != steps:
            problem = f"has {counted(steps, 'step')}, and summary.json tells of {told}"
            raise InputError(str(folder / "curve.csv"), problem, "files of one run")
        path = folder / "case.json"
        data = read_json(path, "the case.json of a Fissura run")
        try:
            case = case_from_dict(data, folder, files_exist=False)
        except InputError as error:
            raise InputError(f"{path}: {error.key}", error.problem, error.allowed) from None
        return cls(case, bool(summary.get("full")), curve, summary, read_states(folder), folder)

    def save(self, path: str | Path, *, overwrite: bool = False) -> Path:
        """Write a result folder: the one that ``fissura run`` writes, which `load` and all commands read.

        Results in memory are written as the run would have written them. Those of a folder are copied from there, with
        the checkpoint, so that the copy can be resumed, too. States that are only in memory are written beside the last
        one as ``state_NNNN.npz``, so that `load` gives back the same numbers, bit for bit.

        Parameters
        ----------
        path : path
            Folder; made if needed.
        overwrite : bool, optional
            Whether it may hold an earlier run, whose files are replaced; nothing else in it is touched.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        InputError
            The folder holds something else, or is that of these results, or a run is writing in either.
        OSError
            A file cannot be written.

        Examples
        --------
        >>> folder = result.save("results/beam")
        >>> Result.load(folder).peak_load == result.peak_load
        True
        """
        from fissura.running.storing import stored

        return stored(self, path, overwrite=overwrite)

    def report(self, path: str | Path | None = None) -> Path:
        """Write one page in HTML about the run, as `fissura.report` does; needs the extra ``report``.

        Parameters
        ----------
        path : path, optional
            File to write; by default ``report.html`` in the folder of the results.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError, OSError
            As `fissura.report`.

        Examples
        --------
        >>> result.report("beam.html").name
        'beam.html'
        """
        from fissura.api.pages import report

        return report(self, path)

    def _repr_html_(self) -> str:
        from fissura.pictures.html import result_html

        return result_html(self)
