"""Everything a study has found so far."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from fissura.study.definition import SpecimenEntry, Study, Task
from fissura.study.measures import Measures, measure
from fissura.study.record import Record


@dataclass(frozen=True)
class StudyResult:
    """Measures of all adaptive runs that have a twin at full resolution.

    Attributes
    ----------
    study : Study
    found : tuple of Measures
    full : dict of str to (int, int)
        Runs at full resolution, and those of them that did not finish, by specimen.
    free : tuple of str
        Specimens without a notch, whose cracks may run anywhere.
    left : int
        Runs that are still to be done.
    """

    study: Study
    found: tuple[Measures, ...]
    full: dict[str, tuple[int, int]]
    free: tuple[str, ...]
    left: int

    def specimen(self, name: str) -> SpecimenEntry:
        """Specimen of a name."""
        return next(entry for entry in self.study.specimens if entry.name == name)

    def types(self) -> dict[str, list[str]]:
        """Names of specimens by their type, which is their own name where the study gives none."""
        groups: dict[str, list[str]] = {}
        for entry in self.study.specimens:
            groups.setdefault(entry.type or entry.name, []).append(entry.name)
        return groups

    def of(self, specimens: Iterable[str] | None = None, variation: str | None = None) -> list[Measures]:
        """Measures of some specimens (all), with one variation (all)."""
        names = None if specimens is None else set(specimens)
        return [
            m
            for m in self.found
            if (names is None or m.specimen in names) and (variation is None or m.variation == variation)
        ]

    @classmethod
    def comparing(cls, study: Study, done: Iterable[tuple[Task, Record]], left: int = 0) -> StudyResult:
        """Compare all runs that are done with their twins at full resolution."""
        records = {(task.specimen, task.seed, task.variation): (task, record) for task, record in done}
        twin = {(s, seed): record for (s, seed, _), (task, record) in records.items() if task.full}
        order = [variation.name for variation in study.variations]
        names = [entry.name for entry in study.specimens]
        found = [
            measure(record, twin[task.specimen, task.seed])
            for task, record in (pair for pair in records.values() if not pair[0].full)
            if (task.specimen, task.seed) in twin
        ]
        found.sort(key=lambda m: (order.index(m.variation), names.index(m.specimen), m.seed))
        full: dict[str, tuple[int, int]] = {}
        for (specimen, _), record in twin.items():
            count, failed = full.get(specimen, (0, 0))
            full[specimen] = count + 1, failed + (record.status != "finished")
        free = {task.specimen for task, _ in records.values() if not task.case.notch}
        return cls(study, tuple(found), full, tuple(name for name in names if name in free), left)
