"""One elastic solution of a half-notched beam at full resolution, in stages: time, memory, iterations.

Each stage is told the memory that the process has at most while it lasts. From time and iterations follows what a whole
run would need.
"""

import argparse
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from common import Check, Report, main, options, say, table
from fissura.adaptivity import limits
from fissura.case import Case, case_from_dict
from fissura.equilibrium import System
from fissura.linear.two_level import TwoLevel
from fissura.machine.kernel_threads import KernelThreads
from fissura.results.summary import peak_memory
from fissura.simulation.described import described
from fissura.simulation.memory import estimate_bodies, estimate_elastic_memory, estimate_memory
from fissura.tessellation import discretize, nuclei_from_case

#: Length, depth and spacing [m]; the thickness follows from the number of bodies.
LENGTH, DEPTH, L_F = 5.6, 1.6, 0.01
#: Memory that one solution may take [GB].
LIMIT = 24.0
#: Linear iterations of a step, and steps of a whole run: `beam_d400` at full resolution in `benchmarks/since.py`.
PER_STEP, STEPS = 32.0, 53

TEXT = """\
Half-notched beam of {size} m with `l_f` = 10 mm, one process with {threads}. *Memory* is the most that the process has
had while the stage lasts, with what earlier stages left. The solution under the unit load has an error of {tolerance:g}
in the energy norm, as that of calibration below 50 000 bodies; the crack mouth opening is {compliance:.6g} m/N.
"""

RUN = """\
A whole run at full resolution would need {memory:.0f} GB ({each:.0f} kB a body, `simulation/limits.py`). For this
solution {told:.1f} GB were estimated. One linear iteration takes {iteration:.2f} s ({body:.2f} µs a body). With
{per_step:.0f} linear iterations a step, as the run of `beam_d400` at full resolution has, a step takes {step:.0f} s,
and {steps} steps {whole:.1f} h.
"""


def _case(bodies: float) -> Case:
    def of(thickness: float) -> Case:
        gauge = {end: {"face": "bottom", "at": 0.5 * LENGTH + way} for end, way in (("a", -0.005), ("b", 0.005))}
        supports = [
            {"type": kind, "face": "bottom", "at": at}
            for kind, at in zip(("pin", "roller"), (0.5 * DEPTH, LENGTH - 0.5 * DEPTH), strict=True)
        ]
        return case_from_dict(
            {
                "specimen": {"size": [LENGTH, DEPTH, thickness]},
                "notch": {"face": "bottom", "position": 0.5 * LENGTH, "depth": 0.5 * DEPTH},
                "supports": supports,
                "load": {"face": "top", "at": 0.5 * LENGTH},
                "gauge": gauge,
                "material": {"E": "60 GPa", "alpha": 0.29, "f_t": "2.2 MPa", "G_t": "35 J/m^2"},
                "discretization": {"l_f": L_F, "l_c": 4 * L_F},
                "control": {"target": "0.4 mm"},
            }
        )

    low, high = 0.02, 10.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if estimate_bodies(of(middle)) < bodies else (low, middle)
    return of(round(high, 4))


class Stages:
    """Time and memory of one stage after the other."""

    def __init__(self) -> None:
        self.rows: list[dict[str, Any]] = []
        self._begin()

    def _begin(self) -> None:
        with suppress(OSError):
            Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
        self._wall, self._cpu = time.perf_counter(), time.process_time()

    def end(self, name: str) -> dict[str, Any]:
        """A stage is over, and another one begins."""
        row = {"stage": name, "wall_s": time.perf_counter() - self._wall, "cpu_s": time.process_time() - self._cpu}
        row["peak_GB"] = peak_memory() / 1e9
        say(f"{name}: {row['wall_s']:.1f} s, {row['peak_GB']:.2f} GB")
        self.rows.append(row)
        self._begin()
        return row


def produce(found: argparse.Namespace) -> Report:
    case = _case(found.bodies)
    given = described(case)
    stages = Stages()
    nuclei = nuclei_from_case(case, given.domain)
    stages.end("nuclei")
    bodies = len(nuclei)
    tessellation = discretize(nuclei, given.domain, np.zeros(bodies)).without_shapes()
    del nuclei
    stages.end("tessellation")
    contacts = len(tessellation.contacts)
    threads = KernelThreads()
    system = System(tessellation, given.materials, given.law, given.conditions, "two-level", threads=threads)
    del tessellation
    stages.end("equations")
    system.symmetric.factor_contacts(system.geometry, system.moduli)
    stages.end("factor")
    u = system.symmetric.solve(system.load, limits.TOLERANCE)
    solved = stages.end("solve")
    solver = system.symmetric._chosen
    assert isinstance(solver, TwoLevel)
    assert not system.symmetric.took_over
    numbers = {
        "bodies": bodies,
        "contacts": contacts,
        "iterations": solver.iterations,
        "iteration_s": solved["wall_s"] / solver.iterations,
        "compliance": float(system.control @ u),
        "size": " x ".join(f"{size:g}" for size in given.domain.size),
        "threads": f"{threads.count} threads" if threads.count > 1 else "one thread",
        "step_iterations": found.step_iterations,
    }
    rows = [numbers, *stages.rows]
    peak = max(row["peak_GB"] for row in stages.rows)
    return Report("million", rows, _markdown(numbers, stages.rows), [Check("peak memory [GB]", peak, LIMIT)])


def _markdown(numbers: dict[str, Any], rows: list[dict[str, Any]]) -> str:
    bodies = numbers["bodies"]
    lines = [[row["stage"], f"{row['wall_s']:.1f}", f"{row['cpu_s']:.1f}", f"{row['peak_GB']:.1f}"] for row in rows]
    lines[-1][0] += f", {numbers['iterations']} iterations"
    heads = ["stage", "time [s]", "processor time [s]", "memory [GB]"]
    text = TEXT.format(**numbers, tolerance=limits.TOLERANCE)
    memory, step = estimate_memory(bodies), numbers["iteration_s"] * numbers["step_iterations"]
    run = RUN.format(
        memory=memory / 1e9,
        each=memory / bodies / 1e3,
        told=estimate_elastic_memory(bodies) / 1e9,
        iteration=numbers["iteration_s"],
        body=1e6 * numbers["iteration_s"] / bodies,
        per_step=numbers["step_iterations"],
        step=step,
        steps=STEPS,
        whole=step * STEPS / 3600,
    )
    head = f"{bodies} bodies with {numbers['contacts']} contacts.\n"
    return "\n".join(["## A million bodies", text, head, table(heads, lines), "", run])


def _more(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--bodies", type=float, default=1e6, help="bodies at full resolution, about")
    parser.add_argument(
        "--step-iterations", type=float, default=PER_STEP, help="linear iterations of a step, as since.py has them"
    )


if __name__ == "__main__":
    sys.exit(main(produce, options(__doc__, [], [], more=_more)))
