"""How stiff thin parts are: prisms a few bodies thick against beam theory, short ligaments against Tada's formula.

Undamaged structures at full resolution.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from itertools import product
from statistics import mean
from typing import Any

import numpy as np
from numpy.typing import NDArray

from common import Check, Report, main, options, say, shown, table
from fissura.adaptivity import gauge_compliance
from fissura.case import Case, case_from_dict
from fissura.case.macroscopic import macroscopic_elasticity
from fissura.contact import CusatisCedolin
from fissura.equilibrium import System
from fissura.material import material_from_case
from fissura.specimen import Conditions, Functional, conditions_from_case, domain_from_case
from fissura.tessellation import discretize, nuclei_from_case

FloatArray = NDArray[np.float64]

L_F = 0.01
E, ALPHA = 60e9, 0.29
#: Thickness of square prisms, in spacings; their length and what is left out at both ends, in thicknesses.
PRISMS = (1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 8.0)
LENGTH, END = 8.0, 1.5
WAYS = ("tension", "bending", "twist")
#: Ligaments in spacings; depth and thickness of the beam, its span being 4 depths.
LIGAMENTS = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0)
DEPTH, WIDTH = 10.0, 5.0

TEXT = """\
Stiffness over that of theory with the bulk values of `E` and ν ([elastic.md](elastic.md)), mean over {seeds} seeds ±
standard deviation. Bodies have the spacing `l_f`. Prisms are square, clamped at one end, and pulled, bent or twisted at
the other; strain, curvature and twist are those of the bodies farther than {end:g} thicknesses from the ends, of
{length:g} thicknesses in all. Beams in three-point bending (depth {depth:g} `l_f`, span 4 depths, thickness {width:g}
`l_f`) have an ideal notch that leaves the ligament; load over crack mouth opening is compared with Tada's formula
(Tada, Paris & Irwin, *The stress analysis of cracks handbook*; plane stress, with the opening of the uncracked part at
the gauge left out, as it is there).

Contacts act at one point of each facet. Where a single facet spans a part it is therefore a hinge: a prism of one
thickness `l_f` is a chain of bodies without any stiffness against bending and twist, and a ligament below `l_f` carries
next to nothing. Two bodies across a part leave its bending 12 % too soft and its twist 25 %, three leave 4 % and 12 %.
That is why `check` and `run` refuse parts thinner than `l_f`, and warn of parts thinner than 3 `l_f`
(`specimen/thin.py`). The 10 % that a ligament of 6 `l_f` lacks are due to the size of the bodies at the notch's tip,
and shrink with `l_f`.
"""


def produce(found: argparse.Namespace) -> Report:
    rows: list[dict[str, Any]] = []
    for name, seed in product(found.cases, found.seeds):
        say(f"{name}, seed {seed}")
        rows += _prisms(seed) if name == "prisms" else _ligaments(seed)
    return Report("thin_parts", rows, _markdown(rows, len(found.seeds)), _checks(rows))


def _case(**tables: Any) -> Case:
    return case_from_dict(
        {
            "material": {"E": E, "alpha": ALPHA, "f_t": 2.2e6, "G_t": 35.0},
            "discretization": {"l_f": L_F},
            "control": {"target": 1e-4},
            **tables,
        }
    )


def _system(case: Case, conditions: Conditions | None = None) -> System:
    """Equations at full resolution; thin parts are not refused here."""
    domain = domain_from_case(case)
    nuclei = nuclei_from_case(case, domain)
    conditions = conditions_from_case(case, domain) if conditions is None else conditions
    return System(
        discretize(nuclei, domain, np.zeros(len(nuclei))), material_from_case(case), CusatisCedolin, conditions
    )


def _prisms(seed: int) -> list[dict[str, Any]]:
    modulus, poisson = macroscopic_elasticity().macroscopic(E, ALPHA)
    rows = []
    for spacings in PRISMS:
        side = spacings * L_F
        theory = {
            "tension": modulus * side**2,
            "bending": modulus * side**4 / 12.0,
            "twist": 0.1406 * modulus / (2.0 * (1.0 + poisson)) * side**4,
        }
        for way, system in _loaded(side, seed):
            system.symmetric.factor_contacts(system.geometry, system.moduli)
            u = system.symmetric.solve(system.load, 1e-9).reshape(-1, 6)
            found = 1.0 / _strain(way, system.tessellation.x, u[:, :3], side)
            rows.append({"case": way, "seed": seed, "spacings": spacings, "ratio": found / theory[way]})
    return rows


def _loaded(side: float, seed: int) -> Iterator[tuple[str, System]]:
    """A prism under a unit force, and under unit moments that bend and twist it."""
    case = _case(
        seed=seed,
        specimen={"size": [LENGTH * side, side, side]},
        supports={"type": "clamp", "face": "left"},
        load={"face": "right", "direction": [1, 0, 0]},
        control={"type": "displacement", "target": 1e-4},
    )
    given = conditions_from_case(case, domain_from_case(case))
    (only,) = given.loads
    arm = only.points - only.points.mean(axis=0)
    for way in WAYS:
        load = only
        if way != "tension":
            lever = np.cross(np.eye(3)[2 if way == "bending" else 0], arm)
            load = Functional(load.points, lever / np.sum(lever**2), load.cells)
        yield way, _system(case, Conditions.single(given.supports, load))


def _strain(way: str, x: FloatArray, u: FloatArray, side: float) -> float:
    """Mean strain, curvature or twist per length of bodies away from the ends, by least squares."""
    inside = (x[:, 0] > END * side) & (x[:, 0] < (LENGTH - END) * side)
    (a, b, c), (v, w, t), one = (x[inside] - 0.5 * side).T, u[inside].T, np.ones(int(inside.sum()))
    if way == "tension":
        return float(np.linalg.lstsq(np.stack([a, one], axis=1), v)[0][0])
    if way == "bending":  # about z: v = -(k a + r) b + ..., w = k a^2 / 2 + r a + ...
        of_v = np.stack([-a * b, -b, c, one, 0 * one, 0 * one], axis=1)
        of_w = np.stack([0.5 * a**2, a, 0 * one, 0 * one, c, one], axis=1)
        return float(np.linalg.lstsq(np.concatenate([of_v, of_w]), np.concatenate([v, w]))[0][0])
    of_w = np.stack([-a * c, -c, a, one, 0 * one, 0 * one], axis=1)  # about x: w = -(k a + r) c + ..., t = (k a + r) b
    of_t = np.stack([a * b, b, 0 * one, 0 * one, a, one], axis=1)
    return float(np.linalg.lstsq(np.concatenate([of_w, of_t]), np.concatenate([w, t]))[0][0])


def _ligaments(seed: int) -> list[dict[str, Any]]:
    depth, width, span = DEPTH * L_F, WIDTH * L_F, 4.0 * DEPTH * L_F
    middle = 0.5 * span + L_F
    rows = []
    for spacings in LIGAMENTS:
        notch = depth - spacings * L_F
        case = _case(
            seed=seed,
            specimen={"size": [2.0 * middle, depth, width]},
            notch={"position": middle, "depth": notch},
            supports=[
                {"type": "pin", "face": "bottom", "at": L_F},
                {"type": "roller", "face": "bottom", "at": 2.0 * middle - L_F},
            ],
            load={"face": "top", "at": middle},
            gauge={
                "a": {"face": "bottom", "at": middle - 0.5 * L_F},
                "b": {"face": "bottom", "at": middle + 0.5 * L_F},
            },
        )
        found = 1.0 / gauge_compliance(_system(case))
        rows.append(
            {"case": "ligament", "seed": seed, "spacings": spacings, "ratio": found / _tada(notch / depth, width)}
        )
    return rows


def _tada(share: float, width: float) -> float:
    """Load over crack mouth opening of a beam with span of four depths [N/m]."""
    modulus, _ = macroscopic_elasticity().macroscopic(E, ALPHA)
    shape = 0.76 - 2.28 * share + 3.87 * share**2 - 2.04 * share**3 + 0.66 / (1.0 - share) ** 2
    return modulus * width / (24.0 * share * shape)


def _markdown(rows: list[dict[str, Any]], seeds: int) -> str:
    text = TEXT.format(seeds=seeds, end=END, length=LENGTH, depth=DEPTH, width=WIDTH)
    names = [name for name in (*WAYS, "ligament") if any(row["case"] == name for row in rows)]
    sizes = sorted({row["spacings"] for row in rows})
    lines = []
    for size in sizes:
        cells = []
        for name in names:
            values = [row["ratio"] for row in rows if (row["case"], row["spacings"]) == (name, size)]
            cells.append(shown(values, 2) if values else "–")
        lines.append([f"{size:g}", *cells])
    return "\n".join(["## Thin parts", text, table(["thickness / `l_f`", *names], lines)])


def _checks(rows: list[dict[str, Any]]) -> list[Check]:
    checks = []
    for name in (*WAYS, "ligament"):
        values = [row["ratio"] for row in rows if row["case"] == name and row["spacings"] == 6.0]
        if values:
            checks.append(Check(f"{name}, 6 l_f thick: mean stiffness over theory", mean(values), 0.85, at_least=True))
    return checks


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["prisms", "ligaments"], [1, 2, 3, 4, 5])))
