"""What a notch does to strength: no bias by the size of bodies, none by its depth.

Peak, start stiffness and dissipated energy of a half-notched beam over seeds: at two sizes of bodies, adaptive and at
full resolution, and with a notch that gets shorter, down to none.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from statistics import mean, stdev
from typing import Any

from common import Check, Report, changed, example, main, measured, options, say, table

DEPTHS = (0.5, 0.1, 0.02, 0.0)
"""Depths of the notch in depths of the beam."""


@dataclass(frozen=True)
class Mean:
    """Mean of a quantity over seeds, and its standard error."""

    value: float
    error: float

    @classmethod
    def of(cls, values: list[float]) -> Mean:
        """From one value for each seed."""
        return cls(mean(values), stdev(values) * len(values) ** -0.5)

    def text(self, digits: int) -> str:
        """For a table."""
        return f"{self.value:.{digits}f} ± {self.error:.{digits}f}"


def _cases(name: str, seed: int) -> dict[str, tuple[Any, bool]]:
    """What is run with a seed: a case, and whether at full resolution."""
    case = example(name, seed)
    l_f, size = case.discretization.l_f, case.specimen.size
    half = changed(case, discretization={"l_f": l_f / 2, "l_c": case.discretization.l_c})
    found = {
        "as in the example, full": (case, True),
        "as in the example": (case, False),
        "bodies half as large, full": (half, True),
    }
    (notch,) = case.notch
    for share in DEPTHS[1:]:
        shorter = (notch.model_copy(update={"depth": share * size[1]}),) if share else ()
        label = f"notch {share:g} of the depth, full" if share else "no notch, full"
        found[label] = (changed(case, notch=shorter), True)
    return found


def produce(found: Any) -> Report:
    """Run every case, seed and variation."""
    rows, sections, worst = [], [], 0.0
    for name in found.cases:
        values: dict[str, list[tuple[float, float, float]]] = {}
        for seed in found.seeds:
            for label, (case, full) in _cases(name, seed).items():
                result = measured(case, full=full).result
                energy = 1e3 * result.summary["dissipated_energy_J"]
                values.setdefault(label, []).append((result.peak_load, result.initial_stiffness / 1e6, energy))
            say(f"{name}, seed {seed}: peak {values['as in the example, full'][-1][0]:.0f} N at full resolution")
        lines = []
        for label, all_of in values.items():
            peak, stiffness, energy = (Mean.of(list(column)) for column in zip(*all_of, strict=True))
            rows.append({"case": name, "what": label, "peak_N": peak.value, "peak_error_N": peak.error})
            lines.append((label, peak.text(0), stiffness.text(1), energy.text(1)))
        heads = ("what", "peak [N]", "start stiffness [N/µm]", "dissipated at the end [mJ]")
        sections.append(f"### `{name}`, notch\n\n{table(heads, lines)}")
        pair = zip(values["as in the example"], values["as in the example, full"], strict=True)
        worst = max(worst, *(100.0 * abs(adaptive[1] / full[1] - 1.0) for adaptive, full in pair))
    text = f"## Notches\n\nMeans over seeds {found.seeds} with their standard errors.\n\n"
    return Report(
        "notches",
        rows,
        text + "\n\n".join(sections),
        [Check("start stiffness, adaptive against full [%]", worst, 1.0)],
    )


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["beam_d100"], [1, 2, 3, 4, 5, 6, 7, 8, 9, 10])))
