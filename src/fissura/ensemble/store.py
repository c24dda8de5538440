"""The folder of an ensemble: one folder for each realisation, there as a whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fissura.batch.resuming import check_same, head_of
from fissura.ensemble.kept import FOLDERS, Kept, kept
from fissura.ensemble.plan import Plan
from fissura.ensemble.task import Kind
from fissura.files.atomic import part_of, sync_folder, write_atomically, write_json
from fissura.files.folder import Folder
from fissura.results.curve import COLUMNS
from fissura.results.curve_writer import CurveWriter
from fissura.results.provenance import versions
from fissura.results.summary import FORMAT_VERSION, write_summary

if TYPE_CHECKING:
    from fissura.ensemble.outcome import Outcome

OWN = (
    "ensemble.json",
    "case.json",
    "runs.csv",
    "runs.parquet",
    "mean_curve.csv",
    "groups.csv",
    "statistics.json",
    "report.html",
)
"""Files that every ensemble gets, beside its realisations and pictures."""

FREE = {"runs", "companions", "keep"}
"""What may differ when an ensemble is resumed, with Monte Carlo sampling."""


def describe(plan: Plan) -> dict[str, Any]:
    """The plan as plain data, its case with all defaults resolved: what decides the numbers."""
    case = plan.case.model_dump(mode="json", exclude=dict.fromkeys(("source", "name", "output", "ensemble"), True))
    return {
        "format_version": FORMAT_VERSION,
        "mode": plan.mode,
        "sampling": plan.sampling,
        "runs": plan.runs,
        "seed": plan.master,
        "full": plan.full,
        "companions": plan.companions,
        "leading_modes": plan.leading_modes if plan.sampling == "latin-hypercube" else None,
        "keep": plan.keep,
        "vary": plan.vary or None,
        "combine": plan.combine if plan.vary else None,
        "seeds": list(plan.chosen) or None,
        "case": case,
    }


class Store:
    """Reads and writes the folder of an ensemble.

    The process that plans the ensemble is the only one to write here: results of a realisation are some ten kilobytes
    and travel back to it. So workers need no disk in common with it, and only one process can leave half a file.

    Parameters
    ----------
    folder : Path
        The folder; it must exist.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._own: Folder | None = None

    def begin(self, plan: Plan) -> None:
        """Start a new ensemble: remove the files of an earlier one, and write down the plan."""
        self._own = Folder.begun(self.folder, "ensemble")
        self._own.add(*OWN)
        source = plan.case.source
        if isinstance(source, str):
            self._own.add("case.toml")
            write_atomically(self.folder / "case.toml", source.encode())
        self._write_plan(plan)

    def resume(self, plan: Plan) -> str:
        """Make sure that the plan goes on with what is there.

        Returns
        -------
        str
            A warning if results of another version of Fissura or of its libraries are there; else ``""``.

        Raises
        ------
        InputError
            There is no ensemble, or it is another one: the message names the first key that differs.
        """
        old = head_of(self.folder, "ensemble")
        before, used, new = old.get("plan", {}), old.get("versions", {}), describe(plan)
        free = FREE if plan.sampling == "monte-carlo" else FREE - {"runs"}
        check_same(self.folder, before, new, free | {"seeds"} if _goes_on(before.get("seeds"), new["seeds"]) else free)
        self._own = Folder.kept(self.folder, "ensemble")
        self._own.add(*OWN)
        for name in FOLDERS.values():
            for part in self.folder.glob(f"{name}/.[0-9]*.part"):
                Folder(part).remove()
        self._write_plan(plan)
        now_used = versions()
        other = [
            f"{name} {used.get(name)}, now {now_used[name]}" for name in now_used if used.get(name) != now_used[name]
        ]
        return f"earlier realisations were computed with {', '.join(other)}" if other else ""

    def _write_plan(self, plan: Plan) -> None:
        resolved = plan.case.model_dump(mode="json", exclude={"source"})
        write_json(self.folder / "case.json", resolved)
        write_summary(
            self.folder / "ensemble.json",
            {"format_version": FORMAT_VERSION, "plan": describe(plan), "versions": versions()},
        )

    def place(self, kind: Kind, number: int) -> Path:
        """Folder of a realisation or companion."""
        return self.folder / FOLDERS[kind] / f"{number:04d}"

    def kept(self) -> Kept:
        """All that is there."""
        return kept(self.folder)

    def write(self, outcome: Outcome) -> dict[str, Any]:
        """Write a realisation and return its summary; a folder of its number is replaced.

        The folder is filled under another name and then moved into place. It is a result folder as `fissura.run` leaves
        it, so that `Result.load` and `fissura compare` read it.

        Raises
        ------
        OSError
            The disk is full, or the like; nothing is left of this realisation then.
        """
        task = outcome.task
        place = self.place(task.kind, task.number)
        part = part_of(place)
        part.mkdir(parents=True, exist_ok=True)
        if self._own is None:
            self._own = Folder.kept(self.folder, "ensemble")
        self._own.add(f"{FOLDERS[task.kind]}/{place.name}/")
        try:
            summary = self._fill(part, outcome)
            Folder(place).remove()
            _move(part, place)
            sync_folder(place.parent)
        except OSError:
            Folder(part).remove()
            raise
        return summary

    def _fill(self, part: Path, outcome: Outcome) -> dict[str, Any]:
        task, curve = outcome.task, outcome.curve
        own = Folder.begun(part, "run")
        own.add(*outcome.files, "curve.csv", "case.json", "summary.json", *(["error.txt"] if outcome.details else []))
        for name, data in outcome.files.items():
            write_atomically(part / name, data)
        writer = CurveWriter(part / "curve.csv", COLUMNS if curve is None else list(curve))
        if curve is not None:
            for k in range(len(curve["step"])):
                writer.write({name: values[k] for name, values in curve.items()})
        writer.close()
        case = task.case.model_dump(mode="json", exclude={"source"})
        write_json(part / "case.json", case)
        if outcome.details:
            write_atomically(part / "error.txt", outcome.details.encode(errors="replace"))
        summary = {
            "format_version": FORMAT_VERSION,
            "case": task.case.name,
            "full": task.full,
            "seed": task.case.seed,
            **outcome.summary,
            "status": outcome.status,
            "message": outcome.message,
            "realisation": {
                "kind": task.kind,
                "number": task.number,
                **(
                    {"point": task.point, "realisation": task.realisation, "values": task.values} if task.values else {}
                ),
                "field_seed": None if task.case.field is None else task.case.field.seed,
                "again": outcome.again,
                "load_at_end_N": None if curve is None or not len(curve["load_N"]) else float(curve["load_N"][-1]),
                "crack_start": outcome.crack_start,
            },
        }
        write_summary(part / "summary.json", summary)
        return summary


def _goes_on(old: list[int] | None, new: list[int] | None) -> bool:
    """Whether seeds are those of before and further ones, or the first of those."""
    return bool(old and new) and all(a == b for a, b in zip(old or (), new or (), strict=False))


def _move(part: Path, place: Path) -> None:
    """Move a folder into its place, or its files where something of the user is left there; the summary last."""
    if not place.exists():
        os.replace(part, place)
        return
    for path in sorted(part.iterdir(), key=lambda path: path.name == "summary.json"):
        os.replace(path, place / path.name)
    part.rmdir()
