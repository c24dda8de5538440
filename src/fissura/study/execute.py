"""One run of a study, to its record."""

import time
import traceback
from typing import Any

from fissura.case import case_from_dict
from fissura.errors import FissuraError, InputError, RunStopped
from fissura.results.curve import Row, columns, row
from fissura.results.summary import build_summary, peak_memory
from fissura.simulation.loop import Simulation
from fissura.simulation.memory import require_memory
from fissura.simulation.observer import watched
from fissura.simulation.state import State
from fissura.simulation.step import Step
from fissura.study.definition import FULL, Task
from fissura.study.indicators import Observer
from fissura.study.record import Record


def failed(task: Task, error: BaseException) -> Record:
    """Record of a task of which nothing is left but an error."""
    return Record(**_head(task), status="failed", message=str(error) or type(error).__name__)


def _head(task: Task) -> dict[str, Any]:
    """What a record says of its task."""
    case = task.case.model_dump(mode="json", exclude={"source"})
    return {"specimen": task.specimen, "seed": task.seed, "variation": task.variation, "case": case}


def execute(task: Task) -> Record:
    """Run a task; whatever goes wrong in it becomes part of the record.

    Processor times are those of building the simulation and of its steps; observing them is left out.

    Parameters
    ----------
    task : Task
        What to run.

    Raises
    ------
    KeyboardInterrupt
        The user interrupts.
    """
    head = _head(task)
    rows: list[Row] = []
    observer: Observer | None = None
    cpu, wall = time.process_time(), time.perf_counter()
    aside_cpu = aside_wall = 0.0
    simulation = None
    status, message = "finished", ""

    def watch(_: State, step: Step) -> None:
        nonlocal aside_cpu, aside_wall
        seen_cpu, seen_wall = time.process_time(), time.perf_counter()
        rows.append(row(step, seen_cpu - cpu - aside_cpu, seen_wall - wall - aside_wall))
        if observer is not None:
            observer.add(step)
        aside_cpu += time.process_time() - seen_cpu
        aside_wall += time.perf_counter() - seen_wall

    try:
        require_memory(task.case, full=task.full)
        simulation = Simulation(task.case, full=task.full)
        observer = Observer(task.case.material.f_t, full=task.full)
        watched(simulation, watch)
    except RunStopped as error:
        status, message = "stopped", str(error)
    except InputError as error:
        status, message = "refused", str(error)
    except MemoryError:
        status, message = "stopped", "out of memory"
    except Exception as error:  # a study goes on, whatever one of its runs meets
        status, message = "failed", "".join(traceback.format_exception(error))
    if simulation is None or observer is None or not rows:
        return Record(**head, status="failed" if status == "finished" else status, message=message or "has no steps")
    curve = columns(rows)
    summary = build_summary(
        simulation,
        curve,
        status=status,
        message=message,
        cpu_s=time.process_time() - cpu - aside_cpu,
        wall_s=time.perf_counter() - wall - aside_wall,
        memory=peak_memory(),
    )
    return Record(
        **head,
        status=status,
        message=message,
        summary=summary,
        curve=curve,
        energies=observer.energies(),
        indicators=observer.indicators(),
    )


def warm_up() -> None:
    """Load all kernels, so that the first run of a process is not charged with it."""
    beam: dict[str, Any] = {
        "specimen": {"size": [0.14, 0.04, 0.02]},
        "notch": {"face": "bottom", "position": 0.07, "depth": 0.01},
        "supports": [
            {"type": "pin", "face": "bottom", "at": 0.02},
            {"type": "roller", "face": "bottom", "at": 0.12},
        ],
        "load": {"face": "top", "at": 0.07},
        "gauge": {"a": {"face": "bottom", "at": 0.065}, "b": {"face": "bottom", "at": 0.075}},
        "material": {"E": 60e9, "alpha": 0.29, "f_t": 2.2e6, "G_t": 35.0},
        "discretization": {"l_f": 0.01, "l_c": 0.02},
        "adaptivity": {"r_f": 0.01, "r_c": 0.02, "notch_tips": False},
        "control": {"target": 4e-5, "type": "dissipation", "stop_load": 0.8},
    }
    for solver in ("direct", "two-level"):
        case = case_from_dict({**beam, "solver": {"linear": solver}})
        for variation in (FULL, "default"):
            record = execute(Task("warm-up", 1, variation, case))
            if record.status == "failed":
                raise FissuraError(f"a tiny beam cannot be run: {record.message}")
