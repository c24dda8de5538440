"""How long a run still takes: told only where its pace has been steady, for a wrong time is worse than none."""

from bisect import bisect_right

_WINDOWS = (1.0, 0.6, 0.3, 0.15)
"""Latest parts of the time so far, over each of which the pace is taken."""

_AGREE = 1.8
"""Largest ratio of the times left by these paces at which one is told."""

_SLOW = 0.9
"""How near to the longest of them it is: runs slow down more often than they get faster."""

_SHARE, _STEPS = 0.3, 8
"""Share of a run and number of steps before which nothing is told: up to the peak steps are quick."""


class TimeLeft:
    """Estimates the time to the end of a run from when it was how far.

    The constants above are fitted to twelve recorded runs (`benchmarks/time_left.py`).
    """

    def __init__(self) -> None:
        self._times: list[float] = []
        self._shares: list[float] = []

    def after(self, time: float, share: float) -> float | None:
        """Take note of how far a run is.

        Parameters
        ----------
        time : float
            Any clock [s].
        share : float
            What is done by then, 0 to 1.

        Returns
        -------
        float or None
            Time to the end [s]; None as long as the pace is no guide.
        """
        times, shares = self._times, self._shares
        times.append(time)
        shares.append(share)
        if share >= 1.0:
            return 0.0
        if share < _SHARE or len(times) <= _STEPS:
            return None
        found = []
        for window in _WINDOWS:
            begin = min(max(bisect_right(times, time - window * (time - times[0])) - 1, 0), len(times) - 4)
            if share <= shares[begin]:
                return None
            found.append((1.0 - share) * (time - times[begin]) / (share - shares[begin]))
        if max(found) > _AGREE * min(found):
            return None
        return float(max(found) ** _SLOW * min(found) ** (1.0 - _SLOW))
