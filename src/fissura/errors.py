"""Errors that a user can cause or meet, and warnings about what is allowed but looks wrong."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["EnsembleStopped", "FissuraError", "InputError", "Notice", "RunStopped"]


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
    """

    def __init__(self, key: str, problem: str, allowed: str = "") -> None:
        self.key = key
        self.problem = problem
        self.allowed = allowed
        super().__init__(f"{key}: {problem}" + (f" (allowed: {allowed})" if allowed else ""))


class RunStopped(FissuraError):
    """A run that cannot go on; every accepted step before it is valid.

    Parameters
    ----------
    reason : str
        Why the run ended, in a sentence.
    step : int
        Number of the step that could not be completed.
    gauge : float
        Value of the controlled quantity [m] at which the run ended.
    """

    def __init__(self, reason: str, step: int, gauge: float) -> None:
        self.reason = reason
        self.step = step
        self.gauge = gauge
        super().__init__(f"stopped at step {step}, control value {gauge:.6g} m: {reason}")


class EnsembleStopped(FissuraError):
    """An ensemble that cannot go on; every realisation that has ended is on disk, and the ensemble can be resumed."""
