"""A case, and a simulation and a recorder that compute nothing, so that every way a run can end is at hand."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from typer.testing import CliRunner, Result

import fissura.running.run
from changes import TINY_BEAM
from fissura.case import Case
from fissura.cli import app
from fissura.specimen import domain_from_case

EXAMPLE = Path(__file__).parents[2] / "examples" / "beam_d100.toml"

TINY = TINY_BEAM + 'control.target = "2 um"\n'


def call(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


class FakeContacts:
    """Lengths only."""

    def __init__(self, length: Any, fine: Any) -> None:
        self.length, self.fine = length, fine

    def __len__(self) -> int:
        return len(self.length)


class FakeSimulation:
    """Twenty equal steps of a run; every fifth refines."""

    ending: BaseException | None = None
    after = 12
    built: list[Any]

    def __init__(self, case: Case, *, full: bool = False) -> None:
        self.case, self.full = case, full
        self.notices = ()
        self.state = None
        self.bodies_start, self.bodies_full, self.nuclei_given = 100, 300, 0
        self.bodies_full_estimated, self.told_full = False, "300"
        self.field = None
        self.domain = domain_from_case(case)
        lengths = np.array([0.004, 0.009, 0.012])
        self.tessellation = SimpleNamespace(contacts=FakeContacts(lengths, lengths < 0.01))
        type(self).built.append(self)

    def steps(self) -> Iterator[Any]:
        for number in range(1, 21):
            yield SimpleNamespace(
                number=number,
                controlled=self.case.control.target * number / 20,
                load=1234.0,
                bodies=100 + number,
                refinements=int(number % 5 == 0),
                iterations=4,
                control="gauge",
                done=number / 20,
                stage=1,
            )
            if self.ending is not None and number == self.after:
                raise self.ending


class FakeRecorder:
    """Keeps the numbers of the steps, and how the run ended."""

    warnings: tuple[str, ...] = ()
    fail_at = 0

    def __init__(self, simulation: FakeSimulation, folder: Path | None, begun: Any = None) -> None:
        self.folder, self.steps = folder, list[int]()

    def watch(self, state: Any, step: Any) -> None:
        self.steps.append(step.number)
        if self.folder is not None:
            (self.folder / "curve.csv").write_text(",".join(map(str, self.steps)))
        if step.number == self.fail_at:
            raise OSError(errno.ENOSPC, "No space left on device", str(self.folder and self.folder / "curve.csv"))

    def finish(self, status: str, message: str = "") -> Any:
        if self.folder is not None:
            (self.folder / "summary.json").write_text(status)
        return SimpleNamespace(
            folder=self.folder,
            status=status,
            message=message,
            curve={"step": np.array(self.steps)},
            summary={"warnings": list(self.warnings)},
            table=lambda: [("status", status), ("peak load", "1 [kN]")],
        )


def recorder() -> Any:
    return fissura.running.run.Recorder
