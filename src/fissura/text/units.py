"""Units in names of columns, and those in which axes and pages show values; brings no large library."""

from math import inf

SCALES: dict[str, tuple[tuple[float, float, str], ...]] = {
    "m": ((1e-3, 1e6, "µm"), (inf, 1e3, "mm")),
    "N": ((1e3, 1.0, "N"), (1e6, 1e-3, "kN"), (inf, 1e-6, "MN")),
    "Nm": ((1e3, 1.0, "N m"), (1e6, 1e-3, "kN m"), (inf, 1e-6, "MN m")),
    "J": ((1.0, 1e3, "mJ"), (inf, 1.0, "J")),
    "s": ((inf, 1.0, "s"),),
}
"""Of each unit in names of columns: below which value, with which factor, in which unit it is shown."""


def split_unit(column: str) -> tuple[str, str]:
    """Name of a column without its unit, and the unit, which may be empty.

    Examples
    --------
    >>> split_unit("support_0_moment_x_Nm")
    ('support_0_moment_x', 'Nm')
    """
    stem, _, last = column.rpartition("_")
    return (stem, last) if stem and last in SCALES else (column, "")


def scale_of(unit: str, largest: float) -> tuple[float, str]:
    """Factor on values in one of the units of `SCALES`, up to this size, and the unit in which they are shown then.

    Examples
    --------
    >>> scale_of("N", 1530.0)
    (0.001, 'kN')
    """
    return next(((factor, text) for below, factor, text in SCALES[unit] if largest < below), SCALES[unit][-1][1:])
