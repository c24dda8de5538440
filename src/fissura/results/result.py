"""What a run leaves behind, in memory or reloaded from its folder."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.results.curve import COLUMN_OF, COLUMNS, Curve, read_curve
from fissura.results.state import read_state
from fissura.results.summary import curve_numbers, read_summary, result_folder

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fissura.case import Case, Quantity
    from fissura.step import Snapshot

__all__ = ["Result"]


@dataclass(frozen=True, repr=False, eq=False)
class Result:
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
        States by step number: those chosen for ParaView, that of the peak load, and the last. A reloaded
        result has the last one only.
    folder : Path or None
        Where the files are; None when nothing was written.
    """

    case: Case
    full: bool
    curve: Curve
    summary: dict[str, Any]
    snapshots: dict[int, Snapshot]
    folder: Path | None = None

    @classmethod
    def load(cls, folder: str | Path) -> Result:
        """Read a result folder.

        A run that was killed before its end can be loaded too; its status is ``"running"`` and it has no
        snapshots.

        Raises
        ------
        InputError
            There is no such folder, or a file in it is missing or broken.
        """
        from fissura.case import case_from_dict
        from fissura.case.load import read_json

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
        state = folder / "state_last.npz"
        snapshots = dict([read_state(state)]) if state.exists() else {}
        try:
            case = case_from_dict(data, folder, files_exist=False)
        except InputError as error:
            raise InputError(f"{path}: {error.key}", error.problem, error.allowed) from None
        return cls(case, bool(summary.get("full")), curve, summary, snapshots, folder)

    @property
    def gauge(self) -> NDArray[np.float64]:
        """Gauge at every step [m], or displacement of the load where the case has no gauge; shape (steps,)."""
        return self.curve["gauge_m"].astype(np.float64)

    @property
    def controlled(self) -> NDArray[np.float64]:
        """Controlled quantity at every step [m], shape (steps,); it turns back where there is snap-back.

        It is the gauge or the displacement of the load, as `Case.quantity` says.
        """
        return self.values_of(self.case.quantity)

    def values_of(self, quantity: Quantity) -> NDArray[np.float64]:
        """Gauge, or displacement of the load, at every step [m], shape (steps,)."""
        return self.curve[COLUMN_OF[quantity]].astype(np.float64)

    @property
    def load_values(self) -> NDArray[np.float64]:
        """Load at every step [N], shape (steps,)."""
        return self.curve["load_N"].astype(np.float64)

    @property
    def led_by_energy(self) -> NDArray[np.bool_]:
        """Whether dissipated energy led in a step, shape (steps,); never in files of before there was that choice."""
        led = self.curve.get("control")
        return np.zeros(self.steps, dtype=np.bool_) if led is None else led == "dissipation"

    @property
    def steps(self) -> int:
        """Number of accepted steps."""
        return len(self.curve["step"])

    @property
    def peak_load(self) -> float:
        """Load of largest magnitude, with its sign [N]; nan without steps."""
        return self.number("peak_load_N")

    @property
    def gauge_at_peak(self) -> float:
        """Gauge at the peak load [m]; nan without steps."""
        return self.number("gauge_at_peak_m")

    @property
    def dissipated_energy(self) -> float:
        """Energy dissipated by the contacts until the last step [J]; nan without steps."""
        return self.number("dissipated_energy_J")

    @property
    def initial_stiffness(self) -> float:
        """Load per gauge of the first elastic solution [N/m]; nan without steps."""
        return self.number("initial_stiffness_N_per_m")

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
        """Rows of name and value that describe the run."""
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
        >>> adaptive.plot(ax=full.plot(color="0.7")).legend()
        >>> result.plot(x="step", y="dissipated")
        """
        from fissura.results.plotting import plot_columns

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
        from fissura.results.crack_picture import crack_axes

        return crack_axes(self, ax)

    def to_dataframe(self) -> Any:
        """The curve as a ``pandas.DataFrame``, one row per step in SI units, steps as its index.

        Raises
        ------
        InputError
            Pandas is not installed.

        Examples
        --------
        >>> result.to_dataframe()[["gauge_m", "load_N"]].to_excel("curve.xlsx")
        """
        from fissura.results.dataframe import dataframe_of

        return dataframe_of(self.curve)

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
        >>> meshes["bodies"].warp_by_vector("displacement", factor=100).plot(scalars="largest_principal_stress")
        >>> meshes["cracks"].cell_data["opening"].max()
        """
        from fissura.results.meshes import meshes_of

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
        What PyVista returns: in a notebook what that shows, else None.

        Raises
        ------
        InputError
            There is no state of this step, no screen, or PyVista is not installed.

        Examples
        --------
        >>> result.show()
        >>> result.show(step=20, magnify=200, output="step20.png")
        """
        from fissura.results.pyvista_tools import shown
        from fissura.results.result_view import result_view

        view = result_view(self, step, magnify=magnify, off_screen=True if output is not None else None)
        return shown(view, self.case.name, None if output is None else Path(output))

    def _repr_html_(self) -> str:
        from fissura.results.html import result_html

        return result_html(self)

    def number(self, key: str) -> float:
        """A number of the summary; nan where there is none."""
        value = self.summary.get(key)
        return math.nan if value is None else float(value)

    def __repr__(self) -> str:
        rows = self.table()
        width = max(len(name) for name, _ in rows)
        return "\n".join(f"{name:<{width}}  {value}" for name, value in rows)
