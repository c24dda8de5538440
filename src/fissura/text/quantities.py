"""Quantities as short text for tables, messages and pictures."""

import math
from collections.abc import Callable

Formatter = Callable[[float], str]
"""What turns a quantity in SI units into text."""


def length(metres: float) -> str:
    """Small length: micrometres below 1 mm, else millimetres."""
    if abs(metres) < 1e-3:
        return _number(metres * 1e6, "µm")
    return _number(metres * 1e3, "mm")


def force(newtons: float) -> str:
    """Force: newtons below 1 kN, kilonewtons below 1 MN, else meganewtons."""
    if abs(newtons) < 1e3:
        return _number(newtons, "N")
    if abs(newtons) < 1e6:
        return _number(newtons / 1e3, "kN")
    return _number(newtons / 1e6, "MN")


def energy(joules: float) -> str:
    """Energy: millijoules below 1 J, else joules."""
    if abs(joules) < 1.0:
        return _number(joules * 1e3, "mJ")
    return _number(joules, "J")


def stiffness(newtons_per_metre: float) -> str:
    """Stiffness in kN/mm."""
    return _number(newtons_per_metre / 1e6, "kN/mm")


def seconds(value: float) -> str:
    """Time in seconds."""
    return _number(value, "s")


def per_cent(fraction: float, *, signed: bool = False) -> str:
    """Fraction as per cent with two decimals."""
    if not math.isfinite(fraction):
        return "-"
    return f"{100 * fraction:{'+' if signed else ''}.2f} %"


def ratio(value: float) -> str:
    """Ratio with two decimals."""
    return f"{value:.2f}" if math.isfinite(value) else "-"


def count(value: float) -> str:
    """Whole number; thousands separated by blanks from 10 000 on."""
    if not math.isfinite(value):
        return "-"
    return f"{int(value):,}".replace(",", " ") if abs(value) >= 10_000 else str(int(value))


def counted(number: int, thing: str) -> str:
    """Number and name of things, such as ``1 step`` or ``3 steps``."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


def _number(value: float, unit: str) -> str:
    """Three significant digits, trailing zeros kept; all digits before the point."""
    if not math.isfinite(value):
        return "-"
    if value == 0.0:
        return f"0 {unit}"
    decimals = max(2 - math.floor(math.log10(abs(value))), 0)
    return f"{value:.{min(decimals, 6)}f} {unit}"
