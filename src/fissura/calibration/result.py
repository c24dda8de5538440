"""What a calibration has found, in memory or reloaded from its folder."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from fissura.arrays import FloatArray
from fissura.batch.result import FolderResult
from fissura.errors import InputError
from fissura.files.atomic import plain
from fissura.files.folder import FolderKind
from fissura.files.tables import read_json
from fissura.results.dataframe import frame
from fissura.text.quantities import per_cent

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_ALLOWED = "the calibration.json of a Fissura calibration"


@dataclass(frozen=True)
class Estimate:
    """What was found of one unknown; SI units.

    Attributes
    ----------
    key : str
        Key of the case.
    value, error : float
        Estimate and its standard error.
    low, high : float
        95 % interval, by Student's t.
    start, lower, upper : float
        Where the search began, and its bounds.
    from_simulated, from_measured : float
        Parts of the standard error: that of the mean of finitely many computed seeds, and that of the measured
        specimens; their squares add up.
    text : dict of str to str
        `value`, `error`, `low` and `high` with their unit.
    at_bound : bool
        Whether the estimate is at one of its bounds: its error and interval mean little then.
    """

    key: str
    value: float
    error: float
    low: float
    high: float
    start: float
    lower: float
    upper: float
    from_simulated: float
    from_measured: float
    text: dict[str, str]
    at_bound: bool = False


@dataclass(frozen=True)
class Fit:
    """How the curves of one test fit; arrays over the points that were compared.

    Attributes
    ----------
    name : str
        Of the test.
    quantity : str
        "gauge" or "displacement".
    x, measured, lower, upper : (n,) array
        Gauge or displacement [m], mean measured load, smallest and largest [N].
    computed : (n,) array
        Mean load of the seeds at the place nearest to the estimate that was run [N].
    seeds : (seeds, n) array
        Loads of the single seeds there [N].
    predicted : (n,) array
        Mean load at the estimate, from the surrogate [N].
    residual, expected : float
        Root mean squares over the measured peak: measured minus predicted loads, and what random structures alone would
        leave.
    inside : float
        Share of the points at which the computed mean is within what was measured.
    above, below : float
        How far it leaves what was measured at most, over the peak.
    specimens : int
    sensitivity : dict of str to dict
        By key: relative change of the ``peak``, and root mean square of the change of the curve over the peak,
        ``rms``, for a relative change of the unknown (for one of its range where it may be 0 or negative).
    """

    name: str
    quantity: str
    x: FloatArray
    measured: FloatArray
    lower: FloatArray
    upper: FloatArray
    computed: FloatArray
    seeds: FloatArray
    predicted: FloatArray
    residual: float
    expected: float
    inside: float
    above: float
    below: float
    specimens: int
    sensitivity: dict[str, dict[str, float]] = field(default_factory=dict)


@dataclass(frozen=True, repr=False, eq=False)
class Calibration(FolderResult):
    """Result of a calibration.

    Attributes
    ----------
    name : str
        Of the calibration.
    estimates : dict of str to Estimate
        By key.
    correlation : (m, m) array
        Of the estimates, in their order.
    fits : tuple of Fit
        One for each test.
    runs, seeds : int
        Runs of all tests, and random structures of a full round.
    freedom : int
        Degrees of freedom of the intervals.
    converged : bool
        Whether what is left to move is below half of the standard error of the mean of the seeds.
    move : float
        What is left to move, in these standard errors.
    warnings : tuple of str
        What should be read with care.
    folder : Path
        Where the files are.

    Examples
    --------
    >>> list(found.estimates)
    ['material.f_t']
    >>> found.runs <= 8
    True
    """

    name: str
    estimates: dict[str, Estimate]
    correlation: FloatArray
    fits: tuple[Fit, ...]
    runs: int
    seeds: int
    freedom: int
    converged: bool
    move: float
    warnings: tuple[str, ...]
    folder: Path
    kind: ClassVar[FolderKind] = "calibration"

    @property
    def values(self) -> dict[str, float]:
        """Estimates by key, SI units."""
        return {key: estimate.value for key, estimate in self.estimates.items()}

    @classmethod
    def load(cls, folder: str | Path) -> Calibration:
        """Read the folder of a calibration.

        Parameters
        ----------
        folder : path
            Where it is.

        Returns
        -------
        Calibration
            What was found.

        Raises
        ------
        InputError
            There is none, it has not ended, or its file is broken.

        Examples
        --------
        >>> Calibration.load(found.folder).values == found.values
        True
        """
        path = Path(folder) / "calibration.json"
        data = read_json(path, _ALLOWED, most=100_000_000).get("result")
        if data is None:
            raise InputError(str(path), "has no result: the calibration has not ended", "fissura calibrate --resume")
        try:
            arrays = ("x", "measured", "lower", "upper", "computed", "seeds", "predicted")
            fits = [fit | {name: np.array(fit[name], dtype=np.float64) for name in arrays} for fit in data["fits"]]
            return cls(
                **{
                    **data,
                    "estimates": {key: Estimate(**value) for key, value in data["estimates"].items()},
                    "correlation": np.array(data["correlation"], dtype=np.float64),
                    "fits": tuple(Fit(**fit) for fit in fits),
                    "warnings": tuple(data["warnings"]),
                    "folder": Path(folder),
                }
            )
        except (KeyError, TypeError, ValueError) as error:
            raise InputError(str(path), f"is broken ({error})", _ALLOWED) from error

    def as_dict(self) -> dict[str, Any]:
        """Plain data, as in ``calibration.json``.

        Returns
        -------
        dict
            Numbers, texts and lists by name.

        Examples
        --------
        >>> found.as_dict()["seeds"]
        2
        """
        data = asdict(self)
        del data["folder"]
        return dict(plain(data))

    def _rows(self) -> list[tuple[str, str]]:
        rows = [("calibration", self.name)]
        for key, found in self.estimates.items():
            text = found.text
            note = ", at its bound" if found.at_bound else ""
            rows.append((key, f"{text['value']} ± {text['error']} (95 %: {text['low']} to {text['high']}){note}"))
        keys = list(self.estimates)
        for i, key in enumerate(keys):
            for j in range(i):
                pair = f"{keys[j].rpartition('.')[2]}, {key.rpartition('.')[2]}"
                rows.append((f"correlation of {pair}", f"{self.correlation[i, j]:+.2f}"))
        for fit in self.fits:
            of = f" of {fit.name}" if len(self.fits) > 1 else ""
            rows += [
                (f"residual{of}", f"{per_cent(fit.residual)} of the peak; structures alone: {per_cent(fit.expected)}"),
                (
                    f"inside{of}",
                    f"{100 * fit.inside:.0f} % of the measured range; at most {per_cent(fit.above)} above"
                    f" and {per_cent(fit.below)} below",
                ),
            ]
            for key, change in fit.sensitivity.items():
                rows.append((f"peak{of} for +1 % {key.rpartition('.')[2]}", f"{change['peak']:+.2f} %"))
        end = (
            "converged"
            if self.converged
            else f"not converged: {self.move:.1f} standard errors of the seeds are left to move"
        )
        return [*rows, ("runs", f"{self.runs}, {self.seeds} seeds; {end}")]

    def to_dataframe(self) -> Any:
        """Estimates as a ``pandas.DataFrame``, one row for each unknown in SI units, keys as its index.

        Returns
        -------
        pandas.DataFrame
            Estimate, standard error, interval, start and bounds.

        Raises
        ------
        InputError
            Pandas is not installed.

        Examples
        --------
        >>> bool(found.to_dataframe().loc["material.f_t", "error"] > 0)
        True
        """
        names = ("value", "error", "low", "high", "start", "lower", "upper", "from_simulated", "from_measured")
        columns = {name: np.array([getattr(e, name) for e in self.estimates.values()]) for name in names}
        return frame({"key": np.array(list(self.estimates)), **columns}, "key")

    def plot(self, test: str | None = None, ax: Axes | None = None) -> Axes:
        """Draw computed curves over the measured ones.

        Parameters
        ----------
        test : str, optional
            Name of the test; the first one by default.
        ax : matplotlib Axes, optional
            Where; by default those of a new figure.

        Returns
        -------
        matplotlib Axes
            Where it was drawn.

        Raises
        ------
        InputError
            There is no such test.

        Examples
        --------
        >>> ax = found.plot()
        """
        from fissura.calibration.picture import draw_fit
        from fissura.pictures.plotting import new_axes

        known = {fit.name: fit for fit in self.fits}
        if test is not None and test not in known:
            raise InputError("test", f"there is no {test!r}", ", ".join(known))
        ax = new_axes((6.4, 4.2)) if ax is None else ax
        draw_fit(ax, known[test] if test is not None else self.fits[0])
        return ax

    def _notes(self) -> tuple[str, ...]:
        return self.warnings

    def _figure(self) -> tuple[Figure, str]:
        from fissura.calibration.picture import plot_calibration

        return plot_calibration(self), self.name
