"""Errors that a user can cause or meet, and warnings about what is allowed but looks wrong."""

import re
from dataclasses import dataclass

#: Most characters of a key, and of what is wrong and allowed, in a message.
_LONGEST_KEY, _LONGEST_TEXT = 300, 1000

_BREAK = re.compile(r"\s*[^\S ]\s*")


def one_line(text: str, longest: int) -> str:
    r"""A text as one line that any terminal and any file can show: other characters escaped, its middle left out.

    Parameters
    ----------
    text : str
        Any text; parts of it may come from a file.
    longest : int
        Most characters of the result, at least 10.

    Examples
    --------
    >>> one_line("a\nb" + 100 * "c", 10)
    'a b...cccc'
    """
    if len(text) > 4 * longest:  # what comes next should not go through millions of characters
        text = text[: 2 * longest] + text[-2 * longest :]
    text = _BREAK.sub(" ", text).strip()
    if not text.isprintable():
        text = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
    head = (longest - 3) // 2
    return text if len(text) <= longest else f"{text[:head]}...{text[len(text) - (longest - 3 - head) :]}"


@dataclass(frozen=True)
class Notice:
    """A warning: something is allowed but looks wrong, or a result should be read with care.

    ``fissura check`` and ``fissura run`` print it, and ``summary.json`` keeps it under ``warnings``.

    Attributes
    ----------
    key : str
        Where: dotted key in the case file (``"notch.depth"``), command-line option or file.
    problem : str
        What looks wrong, with the value.
    advice : str
        What to do about it.

    Examples
    --------
    >>> print(Notice("material.E", "60 kPa is very soft", "give the unit, such as GPa"))
    material.E: 60 kPa is very soft (what to do: give the unit, such as GPa)
    """

    key: str
    problem: str
    advice: str

    def __str__(self) -> str:
        return f"{self.key}: {self.problem} (what to do: {self.advice})"


class FissuraError(Exception):
    """Base of every error that Fissura raises on purpose."""


class InputError(FissuraError):
    """Something in the case file, the command line or a file named there is wrong.

    Parameters
    ----------
    key : str
        Where: dotted key in the case file (``"notch.depth"``), command-line option or file.
    problem : str
        What is wrong, with the offending value.
    allowed : str, optional
        What would be right.

    Notes
    -----
    The attributes of these names are one line each and not too long, whatever a file or a caller says.

    Examples
    --------
    >>> try:
    ...     case.with_({"material.f_t": "3 mm"})
    ... except fissura.InputError as error:
    ...     print(error.key)
    material.f_t
    """

    def __init__(self, key: str, problem: str, allowed: str = "") -> None:
        self.key = one_line(key, _LONGEST_KEY)
        self.problem = one_line(problem, _LONGEST_TEXT)
        self.allowed = one_line(allowed, _LONGEST_TEXT)
        super().__init__(f"{self.key}: {self.problem}" + (f" (allowed: {self.allowed})" if self.allowed else ""))


class RunStopped(FissuraError):
    """A run that cannot go on; every accepted step before it is valid.

    Parameters
    ----------
    reason : str
        Why the run ended, in a sentence.
    step : int
        Number of the step that could not be completed.
    gauge : float
        Value of the controlled quantity [m or N] at which the run ended.
    unit : str, optional
        Its unit.

    Examples
    --------
    What was computed before is in the attribute ``result`` of what `fissura.run` raises:

    >>> try:
    ...     result = fissura.run(case)
    ... except fissura.RunStopped as stop:
    ...     result = stop.result
    >>> result.steps > 0
    True
    """

    def __init__(self, reason: str, step: int, gauge: float, unit: str = "m") -> None:
        self.reason = reason
        self.step = step
        self.gauge = gauge
        super().__init__(f"stopped at step {step}, control value {gauge:.6g} {unit}: {reason}")


class EnsembleStopped(FissuraError):
    """An ensemble, calibration or study that cannot go on; every run that has ended is on disk, and it can be resumed.

    Examples
    --------
    >>> issubclass(EnsembleStopped, FissuraError)
    True
    """
