"""The compliance at full resolution, extrapolated from coarser discretizations, against solutions there.

`--layer` measures the stiffness of the surface first, which the extrapolation needs (`LAYER` in
`src/fissura/adaptivity/limits.py`).
"""

import argparse
import sys
import time
from itertools import product
from statistics import mean, stdev
from typing import Any

import numpy as np

from common import Check, Report, main, middle, options, say, table, worst
from fissura.adaptivity import RefinedRegion, extrapolated_compliance, gauge_compliance, limits, region_from_case
from fissura.adaptivity.homogeneous import homogeneous
from fissura.arrays import FloatArray
from fissura.case import Case, case_from_dict
from fissura.equilibrium import System
from fissura.linear.krylov import gmres
from fissura.material import Regions
from fissura.simulation.described import Described, described
from fissura.tessellation import Nuclei, discretize, nuclei_from_case

L_F = 0.01
#: Largest difference of the extrapolated compliance of large specimens, and from which depth on they are large.
LIMIT, LARGE = 0.3, 400
#: What takes 4 GB and some minutes at full resolution is done for the first seed alone.
ONCE = ("notched_1600",)
#: Plate pulled along its length, in `l_f`; strain is that of the middle half.
PLATE = (60.0, 40.0, 5.0)
ALPHAS = (0.01, 0.05, 0.1, 0.2, 0.29, 0.4, 0.6, 0.8, 1.0)

TEXT = """\
The depth of beams is in their name, in mm; they are 50 mm thick with `l_f` = 10 mm, 3.5 times as long as deep, the span
2.5 depths. `notched` ones are notched to half their depth and controlled by the crack mouth opening, `plain` ones have
no notch and are controlled by the displacement of the load at midspan, `thick` ones are a fifth of the depth thick;
bars are clamped at one end and pulled at the other. *Random* is the finest discretization of the sequence with contacts
of the material everywhere. Differences from the solution at full resolution in per cent, mean over the seeds, and the
largest size in brackets. *Estimated* is the error that the run tells.
"""

LAYER = """\
Stiffness of the surface layer over that of the bulk in a layer of one `l_f`, such that a plate of {plate} `l_f` with a
homogeneous material is as stiff as with contacts of the material; mean over {seeds} seeds ± standard error.
"""


def _beam(depth: float, width: float = 50.0, **more: Any) -> dict[str, Any]:
    span = [0.5 * depth, 3.0 * depth]
    return {
        "specimen": {"size": [f"{3.5 * depth} mm", f"{depth} mm", f"{width} mm"]},
        "supports": [
            {"type": kind, "face": "bottom", "at": f"{at} mm"} for kind, at in zip(("pin", "roller"), span, strict=True)
        ],
        "load": {"face": "top", "at": f"{1.75 * depth} mm"},
        "control": {"type": "displacement", "target": "0.2 mm"},
        **more,
    }


def _notched(depth: float, width: float = 50.0) -> dict[str, Any]:
    middle_ = 1.75 * depth
    gauge = {end: {"face": "bottom", "at": f"{middle_ + way} mm"} for end, way in (("a", -5.0), ("b", 5.0))}
    notch = {"face": "bottom", "position": f"{middle_} mm", "depth": f"{0.5 * depth} mm"}
    return _beam(depth, width, notch=notch, gauge=gauge, control={"target": "0.2 mm"})


def _bar(depth: float, width: float = 50.0) -> dict[str, Any]:
    return {
        "specimen": {"size": [f"{4 * depth} mm", f"{depth} mm", f"{width} mm"]},
        "supports": [{"type": "clamp", "face": "left"}],
        "load": {"face": "right", "direction": [1, 0, 0]},
        "control": {"type": "displacement", "target": "0.1 mm"},
    }


KINDS = {"notched": _notched, "plain": _beam, "bar": _bar}


def _case(name: str, seed: int, alpha: float = 0.29) -> Case:
    *thick, kind, depth = name.split("_")
    width = 0.2 * float(depth) if thick else 50.0
    rest = {
        "seed": seed,
        "material": {"E": "60 GPa", "alpha": alpha, "f_t": "2.2 MPa", "G_t": "1000 J/m^2"},
        "discretization": {"l_f": L_F, "l_c": 4 * L_F},
    }
    return case_from_dict({**KINDS[kind](float(depth), width), **rest})


class Structure:
    """A specimen with its nuclei."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.found: Described = described(case)
        self.nuclei: Nuclei = nuclei_from_case(case, self.found.domain)

    def system(self, spacing: FloatArray) -> System:
        found = self.found
        bodies = discretize(self.nuclei, found.domain, spacing).without_shapes()
        return System(bodies, found.materials, found.law, found.conditions, elastic=Regions.everywhere())

    def at(self, region: RefinedRegion) -> System:
        return self.system(region.spacing(self.nuclei.x))


def produce(found: argparse.Namespace) -> Report:
    pairs = [(name, seed) for name, seed in product(found.cases, found.seeds) if name not in ONCE or seed == 1]
    rows = [_extrapolated(name, seed, found.alpha) for name, seed in pairs]
    layers = [_layer(alpha, found.layer) for alpha in ALPHAS] if found.layer else []
    return Report("calibration_sequence", [*rows, *layers], _markdown(rows, layers, found.layer), _checks(rows))


def _extrapolated(name: str, seed: int, alpha: float) -> dict[str, Any]:
    say(f"{name}, seed {seed}")
    structure = Structure(_case(name, seed, alpha))
    bodies = len(structure.nuclei)
    last: list[System] = []

    def at(region: RefinedRegion) -> System:
        last[:] = [structure.at(region)]
        return last[0]

    region = region_from_case(structure.case, structure.found.domain, full=False)
    start = time.perf_counter()
    out = extrapolated_compliance(at, region, structure.found.conditions.points, bodies)
    spent = time.perf_counter() - start
    assert out is not None
    random = gauge_compliance(last[0])
    start = time.perf_counter()
    full = gauge_compliance(structure.system(np.zeros(bodies)))
    row = {"case": name, "seed": seed, "alpha": alpha, "bodies_full": bodies, "largest": max(out.bodies)}
    row |= {"random": 100 * (random / full - 1), "difference": 100 * (out.compliance / full - 1)}
    row |= {"estimated": 100 * out.error, "radius": out.radius / L_F, "wall_s": spent}
    row["wall_full_s"] = time.perf_counter() - start
    return row | {
        "spacings": [float(s / L_F) for s in out.spacings],
        "sequence": [float(100 * (value / full - 1)) for value in out.values],
    }


def _strain(system: System, u: FloatArray) -> float:
    """Mean strain along the middle half of a plate."""
    x, length = system.tessellation.x, PLATE[0] * L_F
    inner = np.abs(x[:, 0] - 0.5 * length) < 0.25 * length
    form = np.column_stack([x[inner], np.ones(int(inner.sum()))])
    return float(np.linalg.lstsq(form, u.reshape(-1, 6)[inner, 0])[0][0])


def _homogeneous_strain(system: System, layer: float) -> float:
    """The same, with a homogeneous material and a surface of that stiffness."""
    limits.LAYER = tuple(layer for _ in limits.LAYER_AT)
    equations = homogeneous(system, L_F)
    system.symmetric.factor_contacts(system.geometry, equations.moduli)

    def operator(residual: FloatArray) -> tuple[FloatArray, FloatArray]:
        u, forces = system.symmetric.apply_with_product(residual)
        return u, forces + equations.volumetric(u)

    return _strain(system, gmres(operator, system.load, 1e-5, limits.MOST_VECTORS).solution)


def _layer(alpha: float, seeds: int) -> dict[str, Any]:
    found = []
    for seed in range(1, seeds + 1):
        plain = _bar(PLATE[1] * 10.0) | {"specimen": {"size": [size * L_F for size in PLATE]}}
        structure = Structure(
            case_from_dict(
                {
                    **plain,
                    "seed": seed,
                    "material": {"E": "60 GPa", "alpha": alpha, "f_t": "2.2 MPa", "G_t": "1000 J/m^2"},
                    "discretization": {"l_f": L_F, "l_c": 4 * L_F},
                }
            )
        )
        system = structure.system(np.full(len(structure.nuclei), L_F * (1.0 - 1e-9)))
        system.symmetric.factor_contacts(system.geometry, system.moduli)
        true = 1.0 / _strain(system, system.symmetric.solve(system.load, 1e-5))
        without, with_ = (1.0 / _homogeneous_strain(system, layer) for layer in (0.0, 0.02))
        found.append(0.02 * (true - without) / (with_ - without))
    error = stdev(found) / len(found) ** 0.5 if len(found) > 1 else float("nan")
    say(f"alpha {alpha:g}: layer {mean(found):.4f} ± {error:.4f}")
    return {"alpha": alpha, "layer": mean(found), "layer_error": error}


def _of(rows: list[dict[str, Any]], key: str) -> str:
    return f"{mean(row[key] for row in rows):+.2f} ({worst(rows, key):.2f})"


def _markdown(rows: list[dict[str, Any]], layers: list[dict[str, Any]], seeds: int) -> str:
    heads = ["case", "seeds", "bodies", "in the largest solution", "random [%]", "sequence over `l`/`l_f` [%]"]
    heads += ["extrapolated [%]", "estimated [%]", "time [s] (full)"]
    lines = []
    for name in dict.fromkeys(row["case"] for row in rows):
        own = [row for row in rows if row["case"] == name]
        levels = zip(own[0]["spacings"], np.mean([row["sequence"] for row in own], axis=0), strict=True)
        lines.append(
            [
                f"`{name}`",
                str(len(own)),
                f"{middle(own, 'bodies_full'):.0f}",
                f"{middle(own, 'largest'):.0f}",
                _of(own, "random"),
                ", ".join(f"{level:.3g}: {value:+.2f}" for level, value in levels),
                _of(own, "difference"),
                f"{mean(row['estimated'] for row in own):.2f}",
                f"{middle(own, 'wall_s'):.0f} ({middle(own, 'wall_full_s'):.0f})",
            ]
        )
    parts = ["## Calibration without full resolution", TEXT, table(heads, lines)]
    if layers:
        cells = [[f"{row['alpha']:g}", f"{row['layer']:+.4f} ± {row['layer_error']:.4f}"] for row in layers]
        size = " x ".join(f"{size:g}" for size in PLATE)
        parts += ["", LAYER.format(plate=size, seeds=seeds), table(["`alpha`", "stiffness of the layer"], cells)]
    return "\n".join(parts)


def _checks(rows: list[dict[str, Any]]) -> list[Check]:
    large = [row for row in rows if float(row["case"].rpartition("_")[2]) >= LARGE]
    found = [Check("largest difference of large specimens [%]", worst(large, "difference"), LIMIT)] if large else []
    held = mean(abs(row["difference"]) <= row["estimated"] for row in rows)
    return [*found, Check("share of errors within what is estimated", float(held), 0.9, at_least=True)]


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--layer", type=int, default=0, metavar="SEEDS", help="measure the surface layer, too")
    parser.add_argument("--alpha", type=float, default=0.29, help="tangential over normal stiffness of contacts")


CASES = ["notched_400", "notched_800", "notched_1600", "plain_400", "thick_plain_300", "bar_200"]

if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, CASES, [1, 2, 3], more=_more)))
