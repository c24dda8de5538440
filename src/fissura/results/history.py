"""The section in the middle of the specimen at every step of a run, as ``section.npz``: what pictures are made of.

A whole state is some megabytes, and a run has a hundred of them. The section needs a hundredth of that, for it is flat,
its lines are the same on all steps of a discretization, and a picture needs single precision only.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.files.archive import read_archive, write_archive
from fissura.results.section import Rows, Section, cut
from fissura.results.summary import read_summary, result_folder
from fissura.simulation.step import Snapshot, Step
from fissura.tessellation import Tessellation

FILE = "section.npz"
FORMAT = "fissura-section"
FORMAT_VERSION = 1

OF_STEPS = {"number": "number", "gauge": "gauge", "controlled": "value", "load": "load", "bodies": "bodies"}
"""Arrays over steps in the file, and what of a frame they hold."""

FloatArray32 = NDArray[np.float32]


@dataclass(frozen=True)
class Frame:
    """The section at one step.

    Attributes
    ----------
    number : int
        Number of the step; 0 is the unloaded structure.
    value, load : float
        Controlled quantity [m] and load [N].
    bodies : int
        Bodies of the whole structure.
    section : Section
        Bodies and lines; the same object for all frames of a discretization.
    motion : (b, 3) float32 array
        ``a, b, t`` of each body: its point (x, y) in the section moves by ``(a - t y, b + t x)`` [m].
    stress : (b,) float32 array
        Largest principal stress of each body [Pa].
    opening : (c,) float32 array
        Crack opening of the contacts that the section cuts [m].
    gauge : float
        Gauge [m].
    """

    number: int
    value: float
    load: float
    bodies: int
    section: Section
    motion: FloatArray32
    stress: FloatArray32
    opening: FloatArray32
    gauge: float = 0.0


class HistoryWriter:
    """Takes the section of every step, and writes them all at the end of a run, or in parts on the way.

    Parameters
    ----------
    z : float
        Where the plane is [m].
    frames : iterable of Frame, optional
        Steps that it begins with.
    """

    def __init__(self, z: float, frames: Iterable[Frame] = ()) -> None:
        self._z = z
        self._tessellation: Tessellation | None = None
        self._rows = Rows(np.empty(0, np.int64), np.empty(0, np.int64))
        self._frames = list(frames)

    def start(self, tessellation: Tessellation) -> None:
        """Take the unloaded structure as step 0."""
        section = self._cut(tessellation)
        bodies, lines = len(section.nucleus), section.contacts
        fields = (np.zeros((bodies, 3)), np.zeros(bodies), np.zeros(lines))
        self._add((0, 0.0, 0.0, 0.0), len(tessellation), section, *fields)

    def add(self, step: Step) -> None:
        """Take an accepted step."""
        snapshot = step.snapshot
        section, rows = self._cut(snapshot.tessellation), self._rows
        stress = np.linalg.eigvalsh(snapshot.stress[rows.bodies])[:, -1]
        values = (step.number, step.controlled, step.load, step.gauge)
        fields = (self._motion(snapshot, rows), stress, snapshot.opening[rows.contacts])
        self._add(values, len(snapshot.tessellation), section, *fields)

    @property
    def steps(self) -> int:
        """Steps so far, the unloaded structure included."""
        return len(self._frames)

    @property
    def frames(self) -> tuple[Frame, ...]:
        """All of them."""
        return tuple(self._frames)

    def write(self, path: Path, first: int = 0) -> None:
        """Write everything, or steps from a first one on; the arrays are documented in ``docs/files.md``."""
        sections, which = _numbered([frame.section for frame in self._frames])
        begun = 0 if first == 0 else which[first - 1] + 1  # sections that earlier parts have
        new, chosen = sections[begun:], self._frames[first:]
        cracks = [np.flatnonzero(frame.opening > 0.0).astype(np.int32) for frame in chosen]
        write_archive(
            path,
            FORMAT,
            FORMAT_VERSION,
            {
                "z": self._z,
                "sections.first": begun,
                "sections.nucleus": _joined([s.nucleus for s in new], np.empty(0, np.int64)),
                "sections.fine": _joined([s.fine for s in new], np.empty(0, np.bool_)),
                "sections.lines": _joined([s.lines for s in new], np.empty((0, 2, 2), np.float32)),
                "sections.sides": _joined([s.sides for s in new], np.empty((0, 2), np.int32)),
                "sections.body_offsets": _offsets(s.nucleus for s in new),
                "sections.line_offsets": _offsets(s.lines for s in new),
                **{
                    f"steps.{name}": np.array([getattr(frame, of) for frame in chosen]) for name, of in OF_STEPS.items()
                },
                "steps.section": np.array(which[first:]),
                "steps.crack_offsets": _offsets(cracks),
                "motion": np.concatenate([frame.motion for frame in chosen]),
                "stress": np.concatenate([frame.stress for frame in chosen]),
                "crack": np.concatenate(cracks),
                "opening": np.concatenate([f.opening[some] for f, some in zip(chosen, cracks, strict=True)]),
            },
        )

    def read(self, paths: Iterable[Path], steps: int, tessellation: Tessellation) -> None:
        """Take what was written before instead of a start.

        Parameters
        ----------
        paths : iterable of Path
            Files that `write` wrote. Where they hold the same step, they agree.
        steps : int
            Steps to take, the unloaded structure included.
        tessellation : Tessellation
            Of the last one of them.

        Raises
        ------
        InputError
            A file is missing or damaged, or they do not hold all of these steps.
        """
        for path in paths:
            arrays = read_archive(path, FORMAT, FORMAT_VERSION)
            try:
                known = _numbered([frame.section for frame in self._frames])[0]
                found = _frames(arrays, known)
            except (KeyError, IndexError, TypeError, ValueError) as error:
                raise InputError(str(path), f"is damaged ({error})", "the files of the run as it left them") from None
            self._frames += [frame for frame in found if self.steps <= frame.number < steps]
        if [frame.number for frame in self._frames] != list(range(steps)):
            raise InputError(
                str(path), f"has sections of {self.steps - 1} steps", f"those of {steps - 1}; or --overwrite"
            )
        self._tessellation, self._rows = tessellation, cut(tessellation, self._z)[1]

    def _cut(self, tessellation: Tessellation) -> Section:
        if tessellation is self._tessellation and self._frames:
            return self._frames[-1].section
        section, self._rows = cut(tessellation, self._z)
        self._tessellation = tessellation
        return section

    def _motion(self, snapshot: Snapshot, rows: Rows) -> NDArray[np.float64]:
        x, u = snapshot.tessellation.x[rows.bodies], snapshot.displacement[rows.bodies]
        height, (rx, ry, rz) = self._z - x[:, 2], u[:, 3:].T
        return np.stack([u[:, 0] + ry * height + rz * x[:, 1], u[:, 1] - rx * height - rz * x[:, 0], rz], axis=1)

    def _add(
        self, values: tuple[int, float, float, float], bodies: int, section: Section, *fields: NDArray[Any]
    ) -> None:
        number, controlled, load, gauge = values
        motion, stress, opening = (field.astype(np.float32) for field in fields)
        self._frames.append(Frame(number, controlled, load, bodies, section, motion, stress, opening, gauge))


def read_history(folder: str | Path) -> tuple[Frame, ...]:
    """Read the section at every step of a run that has ended.

    Parameters
    ----------
    folder : str or Path
        Folder of its results.

    Returns
    -------
    tuple of Frame
        In the order of the steps.

    Raises
    ------
    InputError
        There is no such folder, the run has not ended, or the file is missing or damaged.

    Examples
    --------
    >>> frames = read_history(folder)
    >>> frames[0].number, frames[-1].number == result.steps
    (0, True)
    """
    folder = result_folder(folder)
    summary, path = read_summary(folder / "summary.json"), folder / FILE
    if not path.exists():
        if summary.get("status") == "running":
            raise InputError(str(folder), f"the run has not ended, so it has no {FILE}", "the folder of a run that has")
        if not summary.get("steps"):
            raise InputError(str(folder), "the run has no steps to draw", "the folder of a run with steps")
        raise InputError(str(path), "is missing", "the files of the run as it left them; or run again")
    arrays = read_archive(path, FORMAT, FORMAT_VERSION)
    try:
        return _frames(arrays)
    except KeyError as error:
        raise InputError(str(path), f"lacks the array {error}") from None
    except (IndexError, TypeError, ValueError) as error:
        raise InputError(str(path), f"is damaged ({error})") from None


def _frames(arrays: dict[str, NDArray[Any]], known: Sequence[Section] = ()) -> tuple[Frame, ...]:
    """Steps in a file; sections of earlier parts are known."""
    sections = [*known[: int(arrays["sections.first"])], *_sections_of(arrays)]
    frames, body = [], 0
    controlled = arrays["steps.controlled"]
    cracks = arrays["steps.crack_offsets"]
    for k, which in enumerate(arrays["steps.section"]):
        number, bodies = (int(arrays[f"steps.{name}"][k]) for name in ("number", "bodies"))
        load, gauge = (float(arrays[f"steps.{name}"][k]) for name in ("load", "gauge"))
        section = sections[which]
        own, some = slice(body, body + len(section.nucleus)), slice(cracks[k], cracks[k + 1])
        opening = np.zeros(section.contacts, np.float32)
        opening[arrays["crack"][some]] = arrays["opening"][some]
        fields = (arrays["motion"][own], arrays["stress"][own], opening)
        frames.append(Frame(number, float(controlled[k]), load, bodies, section, *fields, gauge))
        body = own.stop
    return tuple(frames)


def _numbered(sections: Sequence[Section]) -> tuple[list[Section], list[int]]:
    """The sections in their order, each once, and which one each of these is."""
    numbers: dict[int, int] = {}
    which = [numbers.setdefault(id(section), len(numbers)) for section in sections]
    return [sections[which.index(k)] for k in range(len(numbers))], which


def _sections_of(arrays: dict[str, NDArray[Any]]) -> list[Section]:
    body, line = (pairwise(arrays[f"sections.{name}_offsets"].tolist()) for name in ("body", "line"))
    nucleus, fine, lines, sides = (arrays[f"sections.{name}"] for name in ("nucleus", "fine", "lines", "sides"))
    return [Section(nucleus[a:b], fine[a:b], lines[c:d], sides[c:d]) for (a, b), (c, d) in zip(body, line, strict=True)]


def _joined(parts: list[NDArray[Any]], nothing: NDArray[Any]) -> NDArray[Any]:
    """Arrays one after another, or this one where there are none."""
    return np.concatenate(parts) if parts else nothing


def _offsets(parts: Any) -> NDArray[np.int64]:
    return np.concatenate([[0], np.cumsum([len(part) for part in parts])]).astype(np.int64)
