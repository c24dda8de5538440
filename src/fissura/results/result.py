"""What a run leaves behind, in memory or reloaded from its folder."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fissura.errors import InputError
from fissura.results.curve import COLUMNS, Curve, read_curve
from fissura.results.numbers import Numbers
from fissura.results.state import read_states
from fissura.results.summary import curve_numbers, read_summary, result_folder
from fissura.text.rows import aligned

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fissura.case import Case
    from fissura.results.history import Frame
    from fissura.results.xarrays import Fields
    from fissura.simulation.step import Snapshot

__all__ = ["Result"]


@dataclass(frozen=True, repr=False, eq=False)
class Result(Numbers):
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

    case: Case
    full: bool
    curve: Curve
    summary: dict[str, Any]
    snapshots: dict[int, Snapshot]
    folder: Path | None = None
    sections: tuple[Frame, ...] = ()

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
        from fissura.case import case_from_dict
        from fissura.files.tables import read_json

        folder = result_folder(folder)
        curve, summary = read_curve(folder / "curve.csv"), read_summary(folder / "summary.json")
        if summary.get("status") == "running" and set(COLUMNS) <= set(curve):
            summary |= curve_numbers(curve)  # it is written every second only, the curve after every step
        steps, told = len(curve["step"]), summary.get("steps")
        if summary.get("status") != "running" and isinstance(told, int) and told != steps:
            problem = f"has {steps} step{'' if steps == 1 else 's'}, and summary.json tells of {told}"
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

    @cached_property
    def frames(self) -> tuple[Frame, ...]:
        """The section in the middle of the specimen at every step that pictures are made of; step 0 is unloaded.

        Raises
        ------
        InputError
            The folder has no such file, because the run has not ended or an earlier version wrote it.
        """
        if self.sections or self.folder is None:
            return self.sections
        from fissura.results.history import read_history

        return read_history(self.folder)

    @property
    def last(self) -> Snapshot:
        """State of the last step.

        Raises
        ------
        InputError
            There is none: no step was accepted, or the run was killed.
        """
        if not self.snapshots:
            raise InputError(str(self.folder or self.case.name), "has no state of a last step")
        return self.snapshots[max(self.snapshots)]

    def table(self) -> list[tuple[str, str]]:
        """Rows of name and value that describe the run.

        Returns
        -------
        list of (str, str)
            As ``fissura run`` prints them.

        Examples
        --------
        >>> dict(result.table())["status"]
        'finished'
        """
        from fissura.results.table import rows_of

        return rows_of(self)

    def plot(self, x: str | None = None, y: str = "load", ax: Axes | None = None, **line: Any) -> Axes:
        """Draw any column of the curve over any other, with units on the axes.

        Parameters
        ----------
        x, y : str, optional
            Names of columns of ``curve.csv``, with or without their units; by default the load over what is controlled.
        ax : matplotlib Axes, optional
            Where; by default those of a new figure. Units that its axes name are kept, so that curves may be compared.
        **line
            Properties of the line, such as ``color`` and ``label``.

        Returns
        -------
        matplotlib Axes
            Where it was drawn.

        Raises
        ------
        InputError
            There is no such column, or it holds words.

        Examples
        --------
        >>> ax = result.plot()
        >>> ax = adaptive.plot(ax=full.plot(color="0.7"))
        >>> ax = result.plot(x="step", y="dissipated")
        """
        from fissura.pictures.plotting import plot_columns

        return plot_columns(self, x, y, ax, line)

    def plot_crack(self, ax: Axes | None = None) -> Axes:
        """Draw the last state looking along z, with all opened contacts over it, in mm.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where; by default those of a new figure, with a title.

        Returns
        -------
        matplotlib Axes
            Where it was drawn; a colour bar stands beside it where anything has opened.

        Raises
        ------
        InputError
            There is no state of a last step.

        Examples
        --------
        >>> result.plot_crack().figure.savefig("crack.pdf")
        """
        from fissura.pictures.crack import crack_axes

        return crack_axes(self, ax)

    def plot_bodies(
        self, step: int | None = None, ax: Axes | None = None, *, stress: bool = False, magnify: float | None = None
    ) -> Axes:
        """Draw bodies and cracks in the middle of the specimen at any step, looking along z, in mm.

        Parameters
        ----------
        step : int, optional
            Number of the step, 0 for the unloaded specimen; by default the last one.
        ax : matplotlib Axes, optional
            Where; by default those of a new figure, with a title and with what the colours mean.
        stress : bool, optional
            Colour bodies by their largest principal stress instead of showing which are fine.
        magnify : float, optional
            Factor on displacements; by default a round number such that the largest is a few per cent of the specimen.

        Returns
        -------
        matplotlib Axes
            Where it was drawn.

        Raises
        ------
        InputError
            There is no such step, or the folder has no sections.

        Examples
        --------
        >>> ax = result.plot_bodies()
        >>> ax = result.plot_bodies(step=3, stress=True, magnify=1.0)
        """
        from fissura.pictures.bodies import bodies_axes

        return bodies_axes(self, step, ax, stress=stress, magnify=magnify)

    def to_dataframe(self) -> Any:
        """The curve as a ``pandas.DataFrame``, one row per step in SI units, steps as its index.

        Returns
        -------
        pandas.DataFrame
            Columns are those of ``curve.csv``, but ``step``.

        Raises
        ------
        InputError
            Pandas is not installed.

        Examples
        --------
        >>> result.to_dataframe()[["gauge_m", "load_N"]].to_csv("loads.csv")
        """
        from fissura.results.dataframe import dataframe_of

        return dataframe_of(self.curve)

    def to_xarray(self, what: Fields = "curve") -> Any:
        """The curve, or fields of bodies or contacts over steps, as an ``xarray.Dataset``; needs xarray.

        Names are without units, which stand in the attribute ``units`` of each variable; only where two columns differ
        in nothing else, as ``unbalanced_N`` and ``unbalanced_Nm`` do, they keep them.

        Parameters
        ----------
        what : {"curve", "bodies", "contacts"}, optional
            ``"curve"`` has every column over all steps. The others have the arrays of
            `fissura.simulation.step.Snapshot` over the steps of `snapshots`: bodies by the identity of their nucleus,
            contacts by the pair of nuclei that they join. Where a body or a contact is not there in a step, because
            the run had not refined that place yet, values are nan.

        Returns
        -------
        xarray.Dataset
            Dimensions ``step`` and, for fields, ``nucleus`` or ``contact``; ``axis`` is x, y, z, and ``direction`` of a
            contact N, M, L.

        Raises
        ------
        InputError
            There are no states of steps, ``what`` is something else, or xarray is not installed.

        Examples
        --------
        >>> result.to_xarray()["load"].attrs["units"]
        'N'
        >>> opening = result.to_xarray("contacts")["opening"].max("contact")
        >>> bool(opening[-1] == result.last.opening.max())
        True
        """
        from fissura.results.xarrays import dataset_of

        return dataset_of(self, what)

    def to_pyvista(self, step: int | None = None) -> Any:
        """Bodies and cracks of a step as meshes in metres; needs PyVista (extra ``view``).

        Parameters
        ----------
        step : int, optional
            One of `snapshots`, or of those that the folder has ``.vtu`` files of; by default the last one.

        Returns
        -------
        pyvista.MultiBlock
            ``bodies``: polyhedra; ``cracks``: polygons of contacts with damage. Their data are those of the files
            for ParaView (docs/files.md), such as ``stress``, ``opening`` and, at points, ``displacement``.

        Raises
        ------
        InputError
            There is no state of this step, or PyVista is not installed.

        Examples
        --------
        >>> meshes = result.to_pyvista()
        >>> moved = meshes["bodies"].warp_by_vector("displacement", factor=100)
        >>> bool(meshes["cracks"].cell_data["opening"].max() == result.last.opening.max())
        True
        """
        from fissura.pictures.meshes import meshes_of

        return meshes_of(self, step)

    def show(self, step: int | None = None, *, magnify: float | None = None, output: str | Path | None = None) -> Any:
        """Show cracks and the skin of the bodies in 3D, in a window or in the notebook; needs PyVista (extra ``view``).

        Parameters
        ----------
        step : int, optional
            As of `to_pyvista`.
        magnify : float, optional
            Factor on displacements; by default a round number such that the largest is a few per cent of the specimen.
        output : path, optional
            PNG file to write instead; no screen is needed then.

        Returns
        -------
        object or None
            What PyVista returns: in a notebook what that shows, else None.

        Raises
        ------
        InputError
            There is no state of this step, no screen, or PyVista is not installed.

        Examples
        --------
        >>> result.show()  # doctest: +SKIP
        >>> result.show(magnify=200, output="crack.png")  # doctest: +RENDER
        """
        from fissura.pictures.pyvista_tools import shown
        from fissura.pictures.result_window import result_view

        view = result_view(self, step, magnify=magnify, off_screen=True if output is not None else None)
        return shown(view, self.case.name, None if output is None else Path(output))

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

    def __repr__(self) -> str:
        return "\n".join(aligned(self.table()))
