"""Values that are allowed but look wrong: what a case alone can tell, before anything is built."""

import math
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass

from fissura.case.material import Material
from fissura.case.model import Case
from fissura.case.units import DENSITY, ENERGY_PER_AREA, LENGTH, STRESS, Dimension, told
from fissura.errors import Notice

#: Share of `E` above which a strength is no strength of a brittle material: strain at failure is 40 to 100 millionths.
MOST_STRAIN = 0.01

#: Share of the specimen's largest dimension up to which displacements count as small.
MOST_DISPLACEMENT = 0.05


#: Correlation length over the specimen's largest dimension from which on a random field is the same everywhere in it.
MOST_LENGTH = 100.0


@dataclass(frozen=True)
class _Usual:
    """Values that a key usually has.

    Attributes
    ----------
    least, most : float
        Range in SI units.
    dimension : Dimension
        Of the key.
    example : str
        What a case file may say.
    low, high : str
        What a value outside is called.
    """

    least: float
    most: float
    dimension: Dimension
    example: str
    low: str = "small"
    high: str = "large"

    def notice(self, key: str, value: float) -> Notice | None:
        """What to say about a value; None where it is usual."""
        if self.least <= value <= self.most:
            return None
        unit = self.dimension.unit
        too, end = (self.low, self.least) if value < self.least else (self.high, self.most)
        side = "below" if value < self.least else "above"
        return Notice(
            key,
            f"{told(value, self.dimension)} is very {too} for concrete, {side} {told(end, self.dimension)}",
            f'see whether a unit is missing: numbers without one are in {unit}; write such as "{self.example}"',
        )


_MODULUS = _Usual(1e9, 1e12, STRESS, "60 GPa", "soft", "stiff")
_STRENGTH = _Usual(1e4, 1e9, STRESS, "2.2 MPa", "weak", "strong")
_COMPRESSIVE = _Usual(1e4, 1e11, STRESS, "35 MPa", "weak", "strong")
_ENERGY = _Usual(0.1, 1e4, ENERGY_PER_AREA, "35 J/m^2", "brittle", "tough")
_DENSITY = _Usual(100.0, 2.5e4, DENSITY, "2400 kg/m^3", "light", "heavy")
_SHEAR_ENERGY = _Usual(0.1, 1e6, ENERGY_PER_AREA, "560 J/m^2", "brittle", "tough")


def _material(case: Case) -> Iterable[Notice]:
    """Constants by the thousand or million off: a unit is missing, or they are in MPa and mm."""
    yield from _constants(case.material, case.material.model_fields_set, "material")
    for k, (region, part) in enumerate(zip(case.materials, case.resolved_materials, strict=True)):
        yield from _constants(part, region.constants.keys(), f"materials[{k}]")


def _constants(part: Material, given: Collection[str], table: str) -> Iterable[Notice]:
    """The same for the constants that a table gives."""
    for name, usual in (
        ("E", _MODULUS),
        ("f_t", _STRENGTH),
        ("G_t", _ENERGY),
        ("f_s", _STRENGTH),
        ("f_c", _COMPRESSIVE),
        ("G_s", _SHEAR_ENERGY),
        ("K_c", _MODULUS),
    ):
        if name not in given:
            continue  # a default goes with what it comes from
        key = f"{table}.macro.E" if name == "E" and "macro" in given else f"{table}.{name}"
        notice = usual.notice(key, getattr(part, name))
        if notice is not None:
            yield notice
    if part.f_t > MOST_STRAIN * part.E and ("f_t" in given or "E" in given):
        yield Notice(
            f"{table}.f_t",
            f"{told(part.f_t, STRESS)} is {part.f_t / part.E:.2g} of E = {told(part.E, STRESS)}:"
            " concrete cracks at less than 0.0002",
            "see whether the units of f_t and E are right",
        )


def _specimen(case: Case) -> Iterable[Notice]:
    """Specimens as large as a mountain: millimetres were meant."""
    largest = case.specimen.largest
    if largest is None:
        return  # a mesh: whoever reads it knows
    where = told(largest, LENGTH)
    advice = 'see whether a unit is missing: numbers without one are in m; write such as "350 mm"'
    if largest > 100.0:
        yield Notice(case.specimen.key, f"{where} is very large for a specimen, above 100 m", advice)
    elif largest < 1e-3:
        yield Notice(case.specimen.key, f"{where} is very small for a specimen, below 1 mm", advice)


def _target(case: Case) -> Iterable[Notice]:
    """Ends of a run that are too far for small displacements, or too near for any crack."""
    largest, material, l_f = case.specimen.largest or math.inf, case.material, case.discretization.l_f
    # A contact of length l_f is at its strength when it has opened by l_f f_t/E.
    opening = l_f * material.f_t / material.E
    for stage in case.stages:
        target = abs(stage.target)
        if stage.quantity == "force" or math.isnan(target) or target == 0.0:
            continue
        if target > MOST_DISPLACEMENT * largest:
            yield Notice(
                stage.target_key,
                f"{told(target, LENGTH)} is {target / largest:.2g} of the specimen's {told(largest, LENGTH)};"
                " displacements count as small",
                'a smaller target; numbers without a unit are in m, write such as "0.1 mm"',
            )
        if target < 0.1 * opening:
            yield Notice(
                stage.target_key,
                f"{told(target, LENGTH)} is less than a tenth of l_f f_t/E = {told(opening, LENGTH)},"
                " with which a contact begins to crack",
                'a larger target; numbers without a unit are in m, write such as "0.1 mm"',
            )


def _weight(case: Case) -> Iterable[Notice]:
    """Densities in t/m^3 or g/cm^3, without their unit."""
    if case.gravity is not None:
        notice = _DENSITY.notice("gravity.density", case.gravity.density)
        if notice is not None:
            yield notice


def _spacings(case: Case) -> Iterable[Notice]:
    """Lengths of the discretization beyond the specimen: a unit is missing. Defaults in terms of `l_f` may be so."""
    largest = case.specimen.largest or math.inf
    for part, name, what in (
        ("discretization", "l_c", "coarse bodies are as large as l_c where they can be"),
        ("adaptivity", "r_f", "everything is fine as soon as one body is critical"),
    ):
        value = getattr(getattr(case, part), name)
        if name in getattr(case, part).model_fields_set and value > largest:
            yield Notice(
                f"{part}.{name}",
                f"{told(value, LENGTH)} is larger than the specimen, {told(largest, LENGTH)}: {what}",
                'see whether a unit is missing: numbers without one are in m; write such as "40 mm"',
            )


def _field(case: Case) -> Iterable[Notice]:
    """Random fields that scatter by more than their mean, or faster than bodies can follow."""
    part, l_f = case.field, case.discretization.l_f
    if part is None:
        return
    for key, cov in (("field.cov", part.cov), ("field.energy.cov", 0.0 if part.energy is None else part.energy.cov)):
        if cov > 1.0:
            yield Notice(
                key,
                f"{cov:g} means a scatter of {cov:.0%} of the mean",
                'a share such as 0.25, or per cent such as "25 %"',
            )
    largest = case.specimen.largest or math.inf
    if min(part.length) > MOST_LENGTH * largest:
        yield Notice(
            "field.length",
            f"{told(min(part.length), LENGTH)} is far more than the specimen's {told(largest, LENGTH)}: the field is"
            " the same everywhere in it",
            'see whether a unit is missing: numbers without one are in m; write such as "50 mm"',
        )
    if min(part.length) < l_f:
        yield Notice(
            "field.length",
            f"{told(min(part.length), LENGTH)} is less than l_f = {told(l_f, LENGTH)}, so that contacts do not see how"
            " the field varies",
            "a length of l_f or more",
        )


#: Each looks at a case and returns what looks wrong; a new check is a function here.
CHECKS: tuple[Callable[[Case], Iterable[Notice]], ...] = (_material, _specimen, _weight, _spacings, _target, _field)


def case_notices(case: Case) -> tuple[Notice, ...]:
    """What looks wrong in a case, although it is allowed.

    Parameters
    ----------
    case : Case
        Case to look at.
    """
    return tuple(notice for check in CHECKS for notice in check(case))


def suspect(case: Case, part: str) -> Notice | None:
    """The first thing that looks wrong in a part of a case: what to name where the case cannot be used.

    Parameters
    ----------
    case : Case
        Case to look at.
    part : str
        Table or key, such as ``"material"``.
    """
    return next((notice for notice in case_notices(case) if f"{notice.key}.".startswith(f"{part}.")), None)
