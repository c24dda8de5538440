"""How much of a run is done, as one number that never falls."""

from fissura.case import Case


class Done:
    """Share of a run that is done: the largest so far of two, for a run ends by either.

    One is the share of the ways to the targets that the controlled quantity has gone. The other, where there is one
    target, and dissipated energy leads by choice or ``stop_load`` is above 0, is the share of the load's fall from its
    peak to ``stop_load``.

    Parameters
    ----------
    case : Case
        What is run.
    """

    def __init__(self, case: Case) -> None:
        main = case.main
        self._stop_load = main.stop_load
        self._by_load = len(case.stages) == len(main.targets) == 1 and (main.energy or main.stop_load > 0.0)
        self.peak = 0.0
        self.share = 0.0

    def after(self, done: float, load: float) -> float:
        """Take note of an accepted step, by the share of the programme that is done, and its load [N].

        Attributes ``peak`` (largest magnitude of the load so far [N]) and ``share`` are up to date then.

        Returns
        -------
        float
            The share after this step, from 0 to 1.
        """
        load = abs(load)
        self.peak = max(self.peak, load)
        shares = [self.share, done]
        if self._by_load and load < self.peak:
            lost, all_of_it = 1.0 - load / self.peak, 1.0 - self._stop_load
            shares.append(lost / all_of_it if lost < all_of_it else 1.0)
        self.share = min(max(shares), 1.0)
        return self.share
