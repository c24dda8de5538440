"""Two runs beside each other: their differences as data, table, pictures and files."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fissura.arrays import FloatArray
from fissura.case import Quantity
from fissura.errors import Notice
from fissura.results.dataframe import frame
from fissura.results.load_path import NAMES
from fissura.text import quantities as text
from fissura.text.rows import Described

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fissura.results.result import Result

ENERGY = "dissipated energy"


@dataclass(frozen=True, repr=False, eq=False)
class Comparison(Described):
    """Run A (by convention the adaptive one) against run B (the reference).

    Differences are fractions of the value of B, positive where A is larger; nan where B's value is zero or
    unknown.

    Attributes
    ----------
    a, b : Result
        The runs.
    over : str
        What both runs have in common where their loads are compared: ``"gauge"`` or ``"displacement of the load"``, or
        ``"dissipated energy"`` if that of either turns back.
    quantity : str
        Which of the first two it is, or is until it turns back: "gauge" or "displacement"; see
        `fissura.results.comparable.common_quantity`.
    abscissa : (k,) array
        Values of that of both runs together, up to the smaller of their ends [m or J]: gauges and displacements from 0
        on, energies from the first step on at which both have dissipated any.
    load_a, load_b : (k,) array
        Loads there, interpolated linearly, over the quantity from ``(0, 0)`` on [N]. Over energy, loads until the
        quantity of either first turns back are those at the same value of it, and the abscissa has the energy of B at
        it: where damage begins the load over energy is so steep that steps of other lengths would count as a
        difference of the runs.
    max_load_difference : float
        Largest absolute load difference over ``abscissa``, over the magnitude of the peak of B.
    at_max_difference : float
        Where that is [m or J].
    peaks, gauges_at_peak : (float, float)
        Loads of largest magnitude of A and B up to the common end [N], and the quantities at which they occur [m].
    peak_difference, gauge_at_peak_difference : float
        Of these.
    energies : (float, float)
        Energies that A and B dissipated up to the common end, or up to the ends of the runs where these are compared
        over energy [J].
    energy_difference : float
        Of these.
    stiffness_difference : float
        Of the initial stiffnesses; nan if the runs control different quantities, whose stiffnesses these are.
    cpu_ratio : float
        Processor time of B over that of A: above 1, A was faster.
    notices : tuple of Notice
        Warnings: in what the specimens differ, or what does not mean the same in both runs.

    Examples
    --------
    >>> both.over
    'gauge'
    >>> both.max_load_difference < 0.1
    True
    """

    a: Result
    b: Result
    over: str
    quantity: Quantity
    abscissa: FloatArray
    load_a: FloatArray
    load_b: FloatArray
    max_load_difference: float
    at_max_difference: float
    peaks: tuple[float, float]
    gauges_at_peak: tuple[float, float]
    peak_difference: float
    gauge_at_peak_difference: float
    energies: tuple[float, float]
    energy_difference: float
    stiffness_difference: float
    cpu_ratio: float
    notices: tuple[Notice, ...] = ()

    @property
    def by_energy(self) -> bool:
        """Whether loads are compared over dissipated energy."""
        return self.over == ENERGY

    def _rows(self) -> list[tuple[str, str]]:
        show = text.energy if self.by_energy else text.length
        start, end = ("0" if x == 0.0 else show(float(x)) for x in self.abscissa[[0, -1]])
        why = f"; the {NAMES[self.quantity]} turns back" if self.by_energy else ""
        worst, slower = text.per_cent(self.max_load_difference), 0.0 < self.cpu_ratio < 1.0
        times = text.ratio(1.0 / self.cpu_ratio if slower else self.cpu_ratio)
        cpu = f"{_pair(text.seconds, *self._ends('cpu_s'))}: {times} times {'slower' if slower else 'faster'}"
        stiffness = (self.a.initial_stiffness, self.b.initial_stiffness, self.stiffness_difference)
        at_peak = _pair(text.length, *self.gauges_at_peak, self.gauge_at_peak_difference)
        return [
            (f"common {self.over} range", f"{start} to {end}{why}"),
            ("largest load difference", f"{worst} of the peak, at {show(self.at_max_difference)}"),
            ("peak load", _pair(text.force, *self.peaks, self.peak_difference)),
            (f"{NAMES[self.quantity]} at peak", at_peak),
            (f"{ENERGY} at the ends" if self.by_energy else ENERGY, text.per_cent(self.energy_difference, signed=True)),
            ("initial stiffness", _pair(text.stiffness, *stiffness)),
            ("bodies at the end", _pair(text.count, *self._ends("bodies"))),
            ("processor time", cpu),
            ("wall time", _pair(text.seconds, *self._ends("wall_s"))),
        ]

    def _ends(self, column: str) -> tuple[float, float]:
        """Last values of a column of the curves of A and B."""
        return float(self.a.curve[column][-1]), float(self.b.curve[column][-1])

    def numbers(self) -> dict[str, tuple[float, float, float]]:
        """What the runs have to compare, as numbers in SI units.

        Returns
        -------
        dict of str to (float, float, float)
            Of A, of B, and their difference over that of B; nan where it is not known. Loads and energies are those up
            to the common end, ``load_N`` is that where the loads differ most, and its difference is over the peak.

        Examples
        --------
        >>> list(both.numbers())[:2]
        ['load_N', 'peak_load_N']
        """
        worst = int(np.abs(self.load_a - self.load_b).argmax())
        loads = float(self.load_a[worst]), float(self.load_b[worst])
        share = math.copysign(self.max_load_difference, (loads[0] - loads[1]) * self.peaks[1])
        at_peak = "gauge_at_peak_m" if self.quantity == "gauge" else "load_displacement_at_peak_m"
        stiffness = (self.a.initial_stiffness, self.b.initial_stiffness)
        bodies, cpu = self._ends("bodies"), self._ends("cpu_s")
        return {
            "load_N": (*loads, share),
            "peak_load_N": (*self.peaks, self.peak_difference),
            at_peak: (*self.gauges_at_peak, self.gauge_at_peak_difference),
            "dissipated_energy_J": (*self.energies, self.energy_difference),
            "initial_stiffness_N_per_m": (*stiffness, self.stiffness_difference),
            "bodies_end": (*bodies, difference(*bodies)),
            "cpu_s": (*cpu, difference(*cpu)),
        }

    def to_dataframe(self) -> Any:
        """The `numbers` as a ``pandas.DataFrame``: columns ``a``, ``b`` and ``difference``, one row for each.

        Returns
        -------
        pandas.DataFrame
            SI units stand in the names of the rows; differences are fractions of the value of B.

        Raises
        ------
        InputError
            Pandas is not installed.

        Examples
        --------
        >>> list(both.to_dataframe().columns)
        ['a', 'b', 'difference']
        """
        numbers = self.numbers()
        names, values = np.array(list(numbers)), np.array(list(numbers.values()))
        return frame({"quantity": names, "a": values[:, 0], "b": values[:, 1], "difference": values[:, 2]}, "quantity")

    def plot(self) -> tuple[Axes, Axes]:
        """Draw both curves, and below them the difference of their loads, in a new figure.

        Returns
        -------
        upper : matplotlib Axes
            Where the curves are.
        lower : matplotlib Axes
            Where their difference is.

        Examples
        --------
        >>> upper, lower = both.plot()
        """
        from matplotlib import pyplot

        from fissura.pictures.curves import comparison_figure

        upper, lower = comparison_figure(self, pyplot.figure).axes
        return upper, lower

    def plot_bodies(self, *, stress: bool = False) -> list[Axes]:
        """Draw bodies and cracks of both runs beside each other at the moments of A, in a new figure.

        Parameters
        ----------
        stress : bool, optional
            Colour bodies by their largest principal stress instead of showing which are fine.

        Returns
        -------
        list of matplotlib Axes
            Those of A and B in turn, moment after moment.

        Raises
        ------
        InputError
            A run was read from a folder without sections.

        Examples
        --------
        >>> axes = both.plot_bodies()
        """
        from matplotlib import pyplot

        from fissura.pictures.moments import bodies_figure

        return bodies_figure(self, stress=stress, make=pyplot.figure)[1]

    def save(self, path: str | Path) -> Path:
        """Write the picture of `plot`, or the `numbers`, as the ending of the name says.

        Parameters
        ----------
        path : path
            File to write: ``.csv`` and ``.json`` hold the numbers, ``.png``, ``.pdf``, ``.svg`` and others that
            matplotlib knows the picture.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            The ending is not known.
        OSError
            The file cannot be written.

        Examples
        --------
        >>> path = both.save("compare.png")
        """
        from fissura.pictures.comparison_files import saved

        return saved(self, Path(path))

    def _repr_html_(self) -> str:
        from fissura.pictures.html import comparison_html

        return comparison_html(self)


def _pair(show: text.Formatter, a: float, b: float, share: float | None = None) -> str:
    told = "" if share is None else f" ({text.per_cent(share, signed=True)})"
    return f"{show(float(a))} against {show(float(b))}{told}"


def difference(a: float, b: float) -> float:
    """Difference of A from B over the value of B; nan where that is 0."""
    return float((a - b) / b) if b else math.nan
