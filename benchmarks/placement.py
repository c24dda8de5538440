"""Nuclei in blocks against nuclei placed all at once: time, structure, stiffness and peaks; and what a region asks for.

Bulk values are of cubes without their outer four spacings. Layers are those of the grid of blocks: how much the number
of nuclei in them scatters, over its mean. Prisms and notched beams are at full resolution.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from statistics import mean, stdev
from typing import Any

import numpy as np

from common import Report, cpu_time, example, main, options, say, shown, table
from fissura import Simulation
from fissura.adaptivity import RefinedRegion
from fissura.case import case_from_dict
from fissura.specimen import Domain
from fissura.specimen.assemble import complex_of
from fissura.specimen.shapes.prism import box
from fissura.tessellation import Nuclei, discretize
from fissura.tessellation.limits import MOST_IN_BLOCK

PLACEMENTS = ("saturated", "blocks")
SPACING = 0.01
SIDE = 40

#: Length, depth and thickness of a beam with 10 million nuclei, and lengths of a region in its middle [m].
LARGE, REGION = (10.5, 3.0, 0.45), (0.2, 0.2, 0.16)

PRISM: dict[str, Any] = {
    "specimen": {"size": [0.24, 0.12, 0.12]},
    "supports": [{"type": "clamp", "face": "left"}],
    "load": {"face": "right", "direction": [1, 0, 0]},
    "material": {"E": 60e9, "alpha": 0.29, "f_t": 2.2e6, "G_t": 35.0},
    "discretization": {"l_f": SPACING},
    "control": {"type": "displacement", "target": 1e-5},
}


def produce(found: argparse.Namespace) -> Report:
    """Run what is asked for."""
    rows: list[dict[str, Any]] = []
    for name, row_of in {"bulk": _bulk, "prism": _stiffness, "beam": _peaks}.items():
        if name in found.cases:
            for placement in PLACEMENTS:
                say(f"{name}, {placement}")
                rows.append(row_of(placement, found.seeds))
    if "region" in found.cases:
        rows.append(_region(found.seeds[0]))
    return Report("placement", rows, _markdown(rows))


def _box(size: tuple[float, ...]) -> Domain:
    return Domain(*complex_of(box(size)))


def _nuclei(placement: str, domain: Domain, seed: int) -> Nuclei:
    if placement == "blocks":
        return Nuclei.in_blocks(domain.complex, SPACING, seed).complete()
    return Nuclei.placed(domain.complex, SPACING, np.random.default_rng(seed))


def _bulk(placement: str, seeds: list[int]) -> dict[str, Any]:
    """Structure far from the surface, and the time of placement."""
    domain = _box((SIDE * SPACING,) * 3)
    _nuclei(placement, _box((4 * SPACING,) * 3), 0)  # compiled
    density, contacts, times, layers = [], [], [], np.zeros(32)
    for seed in seeds[:4]:
        nuclei, seconds = cpu_time(lambda seed=seed: _nuclei(placement, domain, seed))
        x = nuclei.x / SPACING
        bulk = ((x > 4) & (x < SIDE - 4)).all(axis=1)
        bodies = discretize(nuclei, domain, np.zeros(len(nuclei))).contacts.bodies
        density.append(bulk.sum() / (SIDE - 8) ** 3)
        contacts.append(float(np.bincount(bodies.ravel(), minlength=len(x))[bulk].mean()))
        times.append(seconds / len(x))
        layers += np.histogram(np.mod(x[bulk], 8), 32, (0, 8))[0]
    wide = layers.reshape(8, 4).sum(axis=1)
    return {
        "what": "bulk",
        "placement": placement,
        "us": 1e6 * mean(times),
        "density": density,
        "contacts": contacts,
        "quarter": float(layers.std() / layers.mean()),
        "layer": float(wide.std() / wide.mean()),
    }


def _stiffness(placement: str, seeds: list[int]) -> dict[str, Any]:
    """Load over the displacement of the end of a prism, over that of a continuous one with the modulus of contacts."""
    case = case_from_dict({**PRISM, "discretization": {"l_f": SPACING, "placement": placement}})
    whole = 60e9 * 0.12**2 / 0.24
    found = [Simulation(case.with_({"seed": seed}), full=True).start().start.stiffness / whole for seed in seeds]
    return {"what": "prism", "placement": placement, "stiffness": found}


def _peaks(placement: str, seeds: list[int]) -> dict[str, Any]:
    """Peak loads of the notched beam of 100 mm."""
    peaks, energies = [], []
    for seed in seeds:
        case = example("beam_d100", seed).with_({"discretization.placement": placement})
        steps = list(Simulation(case, full=True).steps())
        peaks.append(max(step.load for step in steps))
        energies.append(1e3 * steps[-1].dissipated)
    return {"what": "beam", "placement": placement, "peak": peaks, "energy": energies}


def _region(seed: int) -> dict[str, Any]:
    """What a box in the middle of a large beam asks for, alone and with a coarse part around it."""
    domain = _box(LARGE)
    middle = 0.5 * np.array(LARGE)
    half = 0.5 * np.array(REGION)
    region = RefinedRegion(SPACING, 1e3, 0.0, 0.0, lower=middle[None] - half, upper=middle[None] + half)
    none = Nuclei.in_blocks(domain.complex, SPACING, seed)
    alone, seconds = cpu_time(lambda: none.known_for(region.spacing))
    coarse = replace(region, l_c=4 * SPACING, ramp=8 * SPACING)
    whole, seconds_whole = cpu_time(lambda: none.known_for(coarse.spacing))
    assert none.blocks is not None
    assert alone.blocks is not None
    levels = none.blocks.levels
    number = levels.level_of(MOST_IN_BLOCK * alone.blocks.known)
    return {
        "what": "region",
        "blocks": np.bincount(number, minlength=5).tolist(),
        "of": levels.shape.prod(axis=1).tolist(),
        "asked": [len(index) for index in levels.asked(region.spacing)],
        "nuclei": len(alone),
        "s": seconds,
        "nuclei_coarse": len(whole),
        "s_coarse": seconds_whole,
    }


def _error(values: list[float], digits: int) -> str:
    return f"{mean(values):.{digits}f} ± {stdev(values) / len(values) ** 0.5:.{digits}f}"


def _markdown(rows: list[dict[str, Any]]) -> str:
    parts = []
    of = {(row["what"], row.get("placement")): row for row in rows}
    bulk = [of["bulk", name] for name in PLACEMENTS if ("bulk", name) in of]
    if bulk:
        heads = ["placement", "µs a nucleus", "N l³/V", "contacts a body", "scatter, layers of l/4", "of l"]
        lines = [
            [
                row["placement"],
                f"{row['us']:.0f}",
                shown(row["density"], 4),
                shown(row["contacts"], 3),
                f"{100 * row['quarter']:.1f} %",
                f"{100 * row['layer']:.1f} %",
            ]
            for row in bulk
        ]
        parts.append(table(heads, lines))
    lines = []
    for name in PLACEMENTS:
        prism, beam = of.get(("prism", name), {}), of.get(("beam", name), {})
        lines.append([name, *(_error(row[key], digits) if row else "-" for row, key, digits in (
            (prism, "stiffness", 4), (beam, "peak", 0), (beam, "energy", 2)))])  # fmt: skip
    if ("prism", "blocks") in of or ("beam", "blocks") in of:
        heads = ["placement", "stiffness of a prism / E A/l", "peak of `beam_d100` [N]", "energy [mJ]"]
        parts.append(table(heads, lines) + "\n\nMeans and their standard errors.")
    if ("region", None) in of:
        row = of["region", None]
        heads = ["level", *(f"{2**level} l_f" for level in range(5))]
        lines = [[name, *(f"{value}" for value in row[key])] for name, key in (
            ("asked for", "asked"), ("with those they depend on", "blocks"), ("in the specimen", "of"))]  # fmt: skip
        parts.append(
            f"Blocks for a fine box of 20 x 20 x 16 `l_f` in a beam of 10.5 x 3 x 0.45 m:\n\n{table(heads, lines)}\n\n"
            f"{row['nuclei']} nuclei in {row['s']:.2f} s, and {row['nuclei_coarse']} in {row['s_coarse']:.2f} s"
            " with a coarse part of 4 `l_f`."
        )
    return "\n\n".join(["## Nuclei in blocks", *parts])


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["bulk", "prism", "beam", "region"], range(1, 25))))
