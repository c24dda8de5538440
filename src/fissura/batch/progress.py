"""Live progress of many runs: how many have ended, and about how long the others take."""

import time

from rich.console import Console

from fissura.progress.live import EVERY_SECONDS, Live, duration


class ManyProgress(Live):
    """Shows how many of many runs have ended, and about how long the others take at the pace of these.

    Parameters
    ----------
    console : Console
        Where to write; a moving line if it is a terminal or a notebook.
    """

    def __init__(self, console: Console) -> None:
        super().__init__(console, "{task.completed:.0f} of {task.total:.0f} runs")
        self._start = self._shown = time.monotonic()
        self._total = self._before = self._done = 0
        self._bad: dict[str, int] = {}

    def begin(self, what: str, missing: int, there: int = 0, first: str = "starting workers") -> None:
        """Say what is about to run, and start the clock.

        Parameters
        ----------
        what : str
            What it is.
        missing, there : int
            Number of runs to do, and of those done before.
        first : str, optional
            What happens until the first of them ends.
        """
        self.say(what + (f", {there} of them there already" if there else ""))
        self._start = self._shown = time.monotonic()
        self._total, self._before, self._done = missing + there, there, 0
        if self._line is not None and missing:
            self._line.begin(first, done=there, total=self._total)

    def ended(self, status: str, message: str, last: str) -> None:
        """Show that a run has ended.

        Parameters
        ----------
        status : str
            How; all but ``"finished"`` are counted.
        message : str
            What to say at once, and not only in passing; may be empty.
        last : str
            About this run, in passing; may be empty.
        """
        now = time.monotonic()
        self._done += 1
        if status != "finished":
            self._bad[status] = self._bad.get(status, 0) + 1
        if message:
            self.say(message)
        parts = [*(f"{count} {name}" for name, count in self._bad.items()), *([last] if last else [])]
        parts.append(f"{duration(now - self._start)} elapsed")
        left = self._total - self._before - self._done
        if left:
            parts.append(f"about {duration(left * (now - self._start) / self._done)} left")
        text = ", ".join(parts)
        if self._line is not None:
            self._line.change(text, self._before + self._done)
        elif now - self._shown >= EVERY_SECONDS or not left:
            self._shown = now
            self.say(f"{self._before + self._done} of {self._total} runs, {text}")
