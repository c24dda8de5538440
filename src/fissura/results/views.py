"""A run as pictures, tables and meshes; what makes them is imported when it is asked for."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from fissura.results.dataframe import frame
from fissura.results.run_data import RunData
from fissura.results.xarrays import Fields, dataset_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Views(RunData):
    """What can be made of the results of a run; see `Result`."""

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
        return frame(self.curve, "step")

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
