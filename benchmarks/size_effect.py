"""Strength of similar beams of random material: how mean and scatter go with depth and correlation length.

Every specimen is computed twice, without the random field (deterministic) and with it. The ensembles stay in a folder,
and whatever is there already is not computed again: an interrupted study goes on where it was.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from common import ROOT, Check, Report, changed, example, main, options, say, table
from fissura import Case, EnsembleResult, run_ensemble
from fissura.ensemble.convergence import convergence
from size_effect_figure import deterministic, figure

FloatArray = NDArray[np.float64]

#: Runs end when the load has fallen to this part of its peak: only the peak counts.
AFTER_PEAK = 0.8

TEXT = """\
Three-point bending of beams in the proportions of `{case}`, all of them {thickness:g} mm thick and with bodies of
{spacing:g} mm: {runs} specimens of each depth, adaptive. Each was broken with the same strength everywhere
(deterministic: what scatters is the placing of the bodies) and with the random field (probabilistic), its correlation
length l as given, its coefficient of variation {cov:g} %. Strength is the nominal one, 1.5 F s/(t d²) with load F,
span s, thickness t, depth d. Intervals are 95 % ones.
"""


def more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--depths", nargs="+", type=float, default=[50, 100, 200], metavar="MM", help="%(default)s")
    parser.add_argument("--lengths", nargs="+", type=float, default=[20, 80], metavar="MM", help="%(default)s")
    parser.add_argument("--runs", type=int, default=30, metavar="N", help="specimens of each depth: %(default)s")
    parser.add_argument("--workers", type=int, default=2, metavar="N", help="processes: %(default)s")
    parser.add_argument("--folder", type=Path, default=ROOT / "results" / "size_effect", metavar="DIR")
    parser.add_argument("--images", type=Path, default=ROOT / "docs" / "images", metavar="DIR")


def scaled(case: Case, depth: float) -> Case:
    """The case with length and depth scaled to a depth [m]; thickness, material and bodies stay."""
    factor = depth / case.specimen.size[1]

    def part(item: Any, *names: str) -> Any:
        values = {name: getattr(item, name) for name in names}
        return item.model_copy(update={name: value * factor for name, value in values.items() if value is not None})

    gauge = case.gauge
    assert gauge is not None
    return case.model_copy(
        update={
            "specimen": case.specimen.model_copy(
                update={"size": (case.specimen.size[0] * factor, depth, case.specimen.size[2])}
            ),
            "notch": tuple(part(notch, "position", "depth") for notch in case.notch),
            "supports": tuple(part(support, "at", "width") for support in case.supports),
            "load": part(case.load, "at", "width"),
            "gauge": gauge.model_copy(update={"a": part(gauge.a, "at", "width"), "b": part(gauge.b, "at", "width")}),
            "control": part(case.control, "target", "max_step", "first_step", "min_step"),
        }
    )


def span(case: Case) -> float:
    """Distance of the supports [m]."""
    first, second = (support.at for support in case.supports)
    assert first is not None
    assert second is not None
    return second - first


def strength(case: Case, loads: FloatArray) -> FloatArray:
    """Nominal strength [Pa]: the stress of an elastic beam at its lower face."""
    _, depth, thickness = case.specimen.size
    return 1.5 * loads * span(case) / (thickness * depth**2)


def produce(found: argparse.Namespace) -> Report:
    rows: list[dict[str, Any]] = []
    (seed,) = found.seeds
    for name in found.cases:
        base = example(name, seed)
        for depth in found.depths:
            for k, length in enumerate(found.lengths):
                case = changed(
                    scaled(base, depth / 1e3), field={"length": (length / 1e3,)}, control={"stop_load": AFTER_PEAK}
                )
                folder = found.folder / f"{name}_d{depth:g}_l{length:g}"
                # The specimens of all correlation lengths are the same, so that one of them runs the companions.
                result = ensemble(found, case, folder, 1000 * seed + round(depth), "none" if k else "each")
                if k == 0:
                    rows.append(row(name, depth, None, case, result))
                rows.append(row(name, depth, length, case, result))
    for name in found.cases:
        figure([r for r in rows if r["case"] == name], found.images / f"size_effect_{name}.png")
    return Report("size_effect", rows, markdown(found, rows), checks(rows))


def ensemble(found: argparse.Namespace, case: Case, folder: Path, seed: int, companions: Any) -> EnsembleResult:
    resume = (folder / "ensemble.json").exists()
    said = f"{folder.name}: "

    def start(plan: object, missing: int, there: int) -> None:
        say(f"{said}{missing} runs to go, {there} there")

    return run_ensemble(
        case,
        found.runs,
        output=folder,
        seed=seed,
        mode="both",
        companions=companions,
        workers=found.workers,
        resume=resume,
        on_start=start,
    )


def row(name: str, depth: float, length: float | None, case: Case, result: EnsembleResult) -> dict[str, Any]:
    """Strength of one set of specimens; without a length that of the deterministic runs."""
    of = result.companions if length is None else result.runs
    counted = np.isfinite(of["peak_load_N"]) & ((of["status"] == "finished") | of["past_peak"])
    values = strength(case, of["peak_load_N"][counted]) / 1e6
    known = convergence(values)
    fits = {} if length is None else result.statistics.fits
    volume = float(np.prod(case.specimen.size)) * 1e9
    return {
        "case": name,
        "depth_mm": depth,
        "length_mm": length,
        "runs": len(of["number"]),
        "counted": int(counted.sum()),
        "unfinished": int((of["status"] != "finished").sum()),
        "mean_MPa": known.mean[-1].tolist(),
        "cov": known.cov[-1].tolist(),
        "volume_over_l3": None if length is None else volume / length**3,
        "weibull_shape": fits["Weibull"].parameters["shape"] if "Weibull" in fits else None,
        "cpu_median_s": float(np.nanmedian(of["cpu_s"])),
        "bodies_median": float(np.median(of["bodies_end"][counted])),
    }


def share(rows: list[dict[str, Any]], of: dict[str, Any]) -> float:
    """Mean strength over that without the field."""
    return float(of["mean_MPa"][0] / deterministic(rows, of)["mean_MPa"][0])


def markdown(found: argparse.Namespace, rows: list[dict[str, Any]]) -> str:
    parts = ["## What was found"]
    for name in found.cases:
        case, mine = example(name, 1), [r for r in rows if r["case"] == name]
        assert case.field is not None
        parts += [
            f"### `{name}`\n",
            TEXT.format(
                case=f"examples/{name}.toml",
                thickness=case.specimen.size[2] * 1e3,
                spacing=case.discretization.l_f * 1e3,
                runs=found.runs,
                cov=100 * case.field.cov,
            ),
            f"![Strength and its scatter over depth](images/size_effect_{name}.png)\n",
            _table(rows, mine),
            "",
            *_slopes(mine),
            "",
        ]
    return "\n".join(parts)


def _table(rows: list[dict[str, Any]], mine: list[dict[str, Any]]) -> str:
    heads = [
        "depth [mm]",
        "l [mm]",
        "V/l³",
        "counted",
        "mean strength [MPa]",
        "of deterministic [%]",
        "CoV [%]",
        "Weibull shape (90 %)",
        "processor time, median [s]",
        "bodies, median",
    ]
    lines = []
    for r in mine:
        mean, cov, shape = r["mean_MPa"], [100 * value for value in r["cov"]], r["weibull_shape"]
        lines.append(
            [
                f"{r['depth_mm']:g}",
                "deterministic" if r["length_mm"] is None else f"{r['length_mm']:g}",
                "" if r["volume_over_l3"] is None else f"{r['volume_over_l3']:.3g}",
                f"{r['counted']} of {r['runs']}",
                f"{mean[0]:.2f} ({mean[1]:.2f} to {mean[2]:.2f})",
                f"{100 * share(rows, r):.0f}",
                f"{cov[0]:.1f} ({cov[1]:.1f} to {cov[2]:.1f})",
                "" if shape is None else f"{shape[0]:.1f} ({shape[1]:.1f} to {shape[2]:.1f})",
                f"{r['cpu_median_s']:.1f}",
                f"{r['bodies_median']:.0f}",
            ]
        )
    return table(heads, lines)


def _slopes(mine: list[dict[str, Any]]) -> list[str]:
    """Exponents of mean strength over depth, by least squares in logarithms."""
    out = []
    for length in dict.fromkeys(r["length_mm"] for r in mine):
        of = [r for r in mine if r["length_mm"] == length]
        if len(of) > 1:
            x, y = np.log([r["depth_mm"] for r in of]), np.log([r["mean_MPa"][0] for r in of])
            what = "Deterministic" if length is None else f"l = {length:g} mm"
            out.append(f"* {what}: mean strength goes with depth to the power {np.polyfit(x, y, 1)[0]:+.3f}.")
    return out


def checks(rows: list[dict[str, Any]]) -> list[Check]:
    """What weakest-link theory says of beams without a notch; for others only that all ran."""
    out = [Check("runs that did not finish", sum(r["unfinished"] for r in rows), 0)]
    for name in dict.fromkeys(r["case"] for r in rows if not example(r["case"], 1).notch):
        for length in dict.fromkeys(r["length_mm"] for r in rows if r["length_mm"] is not None):
            mine = sorted(
                (r for r in rows if (r["case"], r["length_mm"]) == (name, length)), key=lambda r: r["depth_mm"]
            )
            if len(mine) > 1:
                first, last = mine[0], mine[-1]
                what = f"{name}, l = {length:g} mm, largest over smallest depth"
                out.append(Check(f"{what}: mean over deterministic mean", share(rows, last) / share(rows, first), 1.0))
                out.append(Check(f"{what}: CoV", last["cov"][0] / first["cov"][0], 1.0))
    return out


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["random_unnotched"], [1], more=more)))
