"""An ensemble that has been computed, in memory or reloaded from its folder."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from fissura.arrays import FloatArray
from fissura.batch.result import FolderResult
from fissura.case import case_from_dict
from fissura.case.ensemble import lists_of_values
from fissura.case.points import Value
from fissura.ensemble.band import Band, band, write_bands
from fissura.ensemble.groups import GROUP_KINDS, group_rows
from fissura.ensemble.overview import rows_of
from fissura.ensemble.plan import Plan
from fissura.ensemble.statistics import Statistics, statistics
from fissura.ensemble.store import Store
from fissura.ensemble.table import Table, read_table, select, write_csv
from fissura.ensemble.task import Kind
from fissura.files.atomic import write_json
from fissura.files.folder import FolderKind
from fissura.files.tables import read_json
from fissura.results.curve import COLUMN_OF, read_curve
from fissura.results.dataframe import frame
from fissura.results.load_path import LoadPath
from fissura.results.result import Result
from fissura.results.summary import read_summary

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Runs that a notebook names one by one, at most.
_TOLD = 10


@dataclass(frozen=True, repr=False, eq=False)
class EnsembleResult(FolderResult):
    """Results of an ensemble, or of a parameter study: an ensemble at each of several points.

    Attributes
    ----------
    plan : Plan
        What was run.
    rows : dict of str to (n,) array
        The table of all runs and companions (`fissura.ensemble.table.COLUMNS`).
    folder : Path
        Where the files are.
    values : dict of str to float or str
        Of one point of a parameter study: its values of the varied keys, numbers in SI units.

    Examples
    --------
    >>> study.complete, study.count("finished")
    (True, 4)
    >>> [group.values["material.f_t"] for group in study.groups]
    [2000000.0, 3000000.0]
    """

    plan: Plan
    rows: Table
    folder: Path
    values: dict[str, Value] = field(default_factory=dict)
    _kept: object = None  # a folder that lasts as long as whoever refers to it
    kind: ClassVar[FolderKind] = "ensemble"
    left_behind: ClassVar[dict[str, Any]] = {"_kept": None}

    @classmethod
    def of(cls, plan: Plan, rows: Table, folder: Path) -> EnsembleResult:
        """Result of a table of runs, in order of their numbers.

        Parameters
        ----------
        plan : Plan
            What was run.
        rows : dict of str to (n,) array
            The table, in any order.
        folder : Path
            Where the files are.

        Returns
        -------
        EnsembleResult
            The result.

        Examples
        --------
        >>> EnsembleResult.of(study.plan, study.rows, study.folder).complete
        True
        """
        order = np.lexsort((rows["number"], rows["kind"]))
        return cls(plan, {name: column[order] for name, column in rows.items()}, folder)

    @classmethod
    def load(cls, folder: str | Path) -> EnsembleResult:
        """Read the folder of an ensemble.

        Parameters
        ----------
        folder : path
            The folder.

        Returns
        -------
        EnsembleResult
            What was in it.

        Raises
        ------
        InputError
            There is no ensemble, or a file of it is broken.

        Examples
        --------
        >>> bool((EnsembleResult.load(study.folder).peaks == study.peaks).all())
        True
        """
        folder = Path(folder)
        plan = read_summary(folder / "ensemble.json").get("plan", {})
        data = read_json(folder / "case.json", "the case.json of an ensemble")
        data["output"] = (data.get("output") or {}) | {"measured": _there(data)}
        case = case_from_dict(data, folder, files_exist=False)
        named = {name: plan[name] for name in ("runs", "mode", "sampling", "full", "companions", "keep")}
        if plan["leading_modes"] is not None:
            named["leading_modes"] = plan["leading_modes"]
        if plan.get("vary"):
            named |= {"vary": lists_of_values(plan["vary"]), "combine": plan["combine"]}
        named["chosen"] = tuple(plan.get("seeds") or ())
        return cls.of(Plan(case, master=plan["seed"], **named), read_table(folder), folder)

    @cached_property
    def runs(self) -> Table:
        """The runs, in order of their numbers."""
        return select(self.rows, self.rows["kind"] == "run")

    @cached_property
    def companions(self) -> Table:
        """The deterministic runs for comparison."""
        return select(self.rows, self.rows["kind"] == "companion")

    @cached_property
    def groups(self) -> tuple[EnsembleResult, ...]:
        """Of a parameter study: the runs of each point as a result of their own, in order; else the result itself.

        Examples
        --------
        >>> [len(group.peaks) for group in study.groups]
        [2, 2]
        """
        if not self.plan.vary:
            return (self,)
        return tuple(
            EnsembleResult(
                self.plan.at(k), select(self.rows, self.rows["point"] == k), self.folder, point.values, self._kept
            )
            for k, point in enumerate(self.plan.points)
        )

    @property
    def peaks(self) -> FloatArray:
        """Magnitudes of the peak loads [N] of the runs that count, in order of number; see `Statistics`."""
        return self.statistics.peaks

    @cached_property
    def statistics(self) -> Statistics:
        """Statistics of the runs."""
        return statistics(self.runs, self.plan.master)

    @cached_property
    def paths(self) -> dict[int, LoadPath]:
        """Curves of all runs that have steps, by number."""
        return self._paths("run")

    @cached_property
    def companion_paths(self) -> dict[int, LoadPath]:
        """Curves of the companions, by number."""
        return self._paths("companion")

    @cached_property
    def band(self) -> Band | None:
        """Mean curve of the runs that finished; None if there are none."""
        finished = self.runs["number"][self.runs["status"] == "finished"]
        return band([self.paths[number] for number in finished.tolist() if number in self.paths])

    def place(self, number: int, kind: Kind = "run") -> Path:
        """Folder of a run or companion.

        Parameters
        ----------
        number : int
            Its number.
        kind : {"run", "companion"}, optional
            Which of the two.

        Returns
        -------
        Path
            The folder.

        Examples
        --------
        >>> study.place(1).name
        '0001'
        """
        return Store(self.folder).place(kind, number)

    def result(self, number: int, kind: Kind = "run") -> Result:
        """A run, or a companion, as `Result`.

        Parameters
        ----------
        number : int
            Its number.
        kind : {"run", "companion"}, optional
            Which of the two.

        Returns
        -------
        Result
            What its folder holds.

        Raises
        ------
        InputError
            There is no such run.

        Examples
        --------
        >>> study.result(1).status
        'finished'
        """
        return Result.load(self.place(number, kind))

    def count(self, status: str) -> int:
        """Number of runs, without companions, that ended with a status.

        Parameters
        ----------
        status : str
            Such as ``"finished"`` or ``"stopped"``.

        Returns
        -------
        int
            How many.

        Examples
        --------
        >>> study.count("failed")
        0
        """
        return int((self.runs["status"] == status).sum())

    @property
    def complete(self) -> bool:
        """Whether every run and every companion finished."""
        wanted = self.plan.runs * len(self.plan.points)
        return bool((self.rows["status"] == "finished").all()) and self.count("finished") == wanted

    def unfinished(self) -> list[tuple[str, str]]:
        """Name and reason of every run or companion that did not finish.

        Returns
        -------
        list of (str, str)
            In order; empty where all finished.

        Examples
        --------
        >>> study.unfinished()
        []
        """
        bad = select(self.rows, self.rows["status"] != "finished")
        return [
            (f"{kind} {number:04d}", f"{status}: {error}")
            for kind, number, status, error in zip(bad["kind"], bad["number"], bad["status"], bad["error"], strict=True)
        ]

    def write(self) -> None:
        """Write ``statistics.json`` and ``mean_curve.csv``; of a parameter study ``groups.csv``, too.

        Examples
        --------
        >>> study.write()
        """
        write_json(self.folder / "statistics.json", self._statistics())
        bands = [(group.values, group.band) for group in self.groups]
        write_bands([(values, found) for values, found in bands if found is not None], self.folder / "mean_curve.csv")
        if self.plan.vary:
            write_csv(group_rows(self.groups), self.folder / "groups.csv", GROUP_KINDS)

    def _statistics(self) -> dict[str, Any]:
        if not self.plan.vary:
            return self.statistics.as_dict()
        return {"groups": [{"values": group.values, **group.statistics.as_dict()} for group in self.groups]}

    def plot(self, x: str | None = None, y: str | None = None, ax: Axes | None = None, **line: Any) -> Axes:
        """Draw all curves with their means, by value where keys are varied; or a column of the table of runs.

        Parameters
        ----------
        x, y : str, optional
            Columns of the table of runs, with or without units; a varied key by its name or the last part of it.
            With `x` alone, `y` is the peak load. Without both, curves are drawn.
        ax : matplotlib Axes, optional
            Where; by default those of a new figure.
        **line
            Properties of lines and points, such as ``color``.

        Returns
        -------
        matplotlib Axes
            Where it was drawn.

        Raises
        ------
        InputError
            There is no such column, or it holds words; or no run has a curve.

        Examples
        --------
        >>> ax = study.plot()
        >>> ax = study.plot(x="material.f_t", y="peak_load")
        """
        from fissura.ensemble.plotting import plot_curves_of, plot_rows

        return plot_curves_of(self, ax, line) if x is None and y is None else plot_rows(self, x, y, ax, line)

    def to_dataframe(self, *, groups: bool = False) -> Any:
        """The table of runs as a ``pandas.DataFrame``, one row per run in SI units; companions are left out.

        Parameters
        ----------
        groups : bool, optional
            The table of ``groups.csv`` instead: one row for each point of a parameter study.

        Returns
        -------
        pandas.DataFrame
            Numbers of the runs, or of the points, are its index.

        Raises
        ------
        InputError
            Pandas is not installed.

        Examples
        --------
        >>> means = study.to_dataframe().groupby("material.f_t")["peak_load_N"].mean()
        >>> list(means.index)
        [2000000.0, 3000000.0]
        """
        return frame(group_rows(self.groups), "point") if groups else frame(self.runs, "number")

    def _rows(self) -> list[tuple[str, str]]:
        return rows_of(self)

    def _notes(self) -> list[str]:
        unfinished = [f"{name} {reason}" for name, reason in self.unfinished()]
        if len(unfinished) > _TOLD:
            unfinished[_TOLD:] = [f"{len(unfinished) - _TOLD} more runs did not finish"]
        return unfinished

    def _figure(self) -> tuple[Figure | None, str]:
        from fissura.ensemble.curve_picture import plot_curves
        from fissura.ensemble.study_pictures import plot_study_curves

        return (plot_study_curves if self.plan.vary else plot_curves)(self), self.plan.case.name

    def _paths(self, kind: Kind) -> dict[int, LoadPath]:
        of = select(self.rows, (self.rows["kind"] == kind) & (self.rows["steps"] > 0))
        found = {}
        for number in of["number"].tolist():
            curve: dict[str, Any] = read_curve(self.place(number, kind))
            if np.any(curve[COLUMN_OF[self.plan.case.quantity]] > 0):
                found[number] = LoadPath.of(curve, str(self.place(number, kind)), self.plan.case.quantity)
        return found


def _there(data: dict[str, Any]) -> str | None:
    """The measured curve of a case, if the file is still there: a result can be looked at without it."""
    measured = (data.get("output") or {}).get("measured")
    return measured if measured is not None and Path(measured).is_file() else None
