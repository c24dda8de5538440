"""What mirrored nuclei ahead of a notch do to strength: peak and energy against how far above the tip they reach.

Mirrored pairs make the notch plane a boundary of bodies, above the tip too as far as they reach; the first facets of
the ligament are flat there and break more easily than facets of random directions.
"""

from __future__ import annotations

import sys
from statistics import mean, stdev
from typing import Any

from common import Check, Report, example, main, measured, options, say, table
from fissura.tessellation import mirror

REACHES = (1.3, 1.5, 2.5)
SMALLEST = 1.28  # below it points of the notch plane may belong to a body above the tip


def produce(found: Any) -> Report:
    """Run every case and seed with each reach; adaptive runs, since these follow full resolution."""
    rows, sections = [], []
    standard = mirror.REACH
    for name in found.cases:
        lines = []
        for reach in REACHES:
            mirror.REACH = reach
            results = [measured(example(name, seed)).result for seed in found.seeds]
            peaks = [r.peak_load for r in results]
            energies = [1e3 * r.summary["dissipated_energy_J"] for r in results]
            error = len(peaks) ** -0.5
            row = {
                "case": name,
                "reach": reach,
                "peak_N": mean(peaks),
                "peak_error_N": stdev(peaks) * error,
                "energy_mJ": mean(energies),
                "energy_error_mJ": stdev(energies) * error,
            }
            rows.append(row)
            say(f"{name}, reach {reach:g} l_f: peak {row['peak_N']:.0f} N")
            lines.append(
                (
                    f"{reach:g}" + (" (used)" if reach == standard else ""),
                    f"{row['peak_N']:.0f} ± {row['peak_error_N']:.0f}",
                    f"{row['energy_mJ']:.1f} ± {row['energy_error_mJ']:.1f}",
                )
            )
        mirror.REACH = standard
        heads = ("reach above the tip / l_f", "peak [N]", "dissipated at the end [mJ]")
        sections.append(f"### `{name}`, reach\n\n{table(heads, lines)}")
    text = f"## Mirrored nuclei above a notch\n\nMeans over seeds {found.seeds} with their standard errors.\n\n"
    return Report(
        "mirror_reach",
        rows,
        text + "\n\n".join(sections),
        [Check("reach above the tip [l_f]", standard, SMALLEST, at_least=True)],
    )


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, ["beam_d100"], [1, 2, 3, 4, 5, 6, 7, 8])))
