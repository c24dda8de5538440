"""All that a run goes on from, as ``checkpoint.npz``."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fissura.errors import InputError
from fissura.files.archive import read_archive, write_archive
from fissura.files.packing import pack, unpack
from fissura.results.curve import Curve
from fissura.simulation.saved import TYPES, SavedState

FILE = "checkpoint.npz"
FORMAT = "fissura-checkpoint"
FORMAT_VERSION = 1

_WHAT_TO_DO = "the checkpoint as the run left it; or begin anew, with --overwrite"


@dataclass(frozen=True)
class Checkpoint:
    """Where a run stands, and what its recorder keeps.

    Attributes
    ----------
    case : mapping
        The case as plain data.
    full : bool
        Whether at full resolution.
    versions : mapping of str to str
        Of Fissura, Python and libraries.
    state, peak : SavedState
        After the last step, and after that of the largest load.
    curve : dict of str to (steps,) array
        The curve, to the last bit.
    written : tuple of int
        Steps whose states are written for ParaView.
    owed : bool
        The state of the last step is still to be written.
    share : float
        Share of the run that was done.
    sections : tuple of str
        Files that hold the section at every step.
    cpu_s, wall_s, memory : float
        Processor and wall time so far [s], and largest memory [bytes].
    """

    case: Mapping[str, Any]
    full: bool
    versions: Mapping[str, str]
    state: SavedState
    peak: SavedState
    curve: Curve
    written: tuple[int, ...]
    owed: bool
    share: float
    sections: tuple[str, ...]
    cpu_s: float
    wall_s: float
    memory: float

    @property
    def leg(self) -> int:
        """The way that the run is on, counted from 0."""
        leg = self.state.state.leg
        return 0 if leg is None else leg.index

    @property
    def begin(self) -> float:
        """Value of the controlled quantity where that way began [m or N]."""
        leg = self.state.state.leg
        return 0.0 if leg is None else leg.begin

    @property
    def steps(self) -> int:
        """Steps so far."""
        return len(self.curve["step"])


def write_checkpoint(path: Path, checkpoint: Checkpoint) -> None:
    """Write a checkpoint; what was there stays until it is whole.

    Raises
    ------
    OSError
        It cannot be written.
    """
    numbers, words = _parted(checkpoint.curve)
    arrays: dict[str, NDArray[Any]] = {"curve": np.stack(list(numbers.values())), **words}
    at_peak = checkpoint.peak is checkpoint.state
    text = {field.name: getattr(checkpoint, field.name) for field in fields(checkpoint) if field.name != "curve"} | {
        "state": pack(checkpoint.state, "state", arrays),
        "peak": None if at_peak else pack(checkpoint.peak, "peak", arrays),
        "columns": [(name, values.dtype.kind) for name, values in numbers.items()],
    }
    arrays["text"] = np.frombuffer(json.dumps(text).encode(), dtype=np.uint8)
    # Hardly anything in it shrinks.
    write_archive(path, FORMAT, FORMAT_VERSION, arrays, compress=False)


def _parted(curve: Curve) -> tuple[Curve, Curve]:
    """Columns of numbers, and those of words under their names in the file."""
    numbers = {name: values for name, values in curve.items() if values.dtype.kind in "if"}
    return numbers, {f"curve.{name}": values for name, values in curve.items() if name not in numbers}


def checkpoint_in(folder: Path) -> Path:
    """Path of the checkpoint in a folder.

    Raises
    ------
    InputError
        There is none.
    """
    path = folder / FILE
    if not path.is_file():
        raise InputError(
            "--resume",
            f"{folder} has no {FILE}: no run has been there, or it ended before its first checkpoint",
            "the folder of a run with one; or begin anew, without --resume or with --overwrite",
        )
    return path


def read_checkpoint(folder: Path) -> Checkpoint:
    """Read the checkpoint in a folder.

    Raises
    ------
    InputError
        There is none, or it is damaged, or another version of Fissura wrote it.
    """
    path = checkpoint_in(folder)
    try:
        arrays = read_archive(path, FORMAT, FORMAT_VERSION)
    except InputError as error:
        raise InputError(str(path), error.problem, _WHAT_TO_DO) from None
    try:
        text = json.loads(arrays["text"].tobytes())
        state = unpack(text.pop("state"), arrays, TYPES)
        peak = text.pop("peak")
        rows = zip(text.pop("columns"), arrays["curve"], strict=True)
        curve: Curve = {name: values.astype(np.int64 if kind == "i" else np.float64) for (name, kind), values in rows}
        curve |= {name.removeprefix("curve."): arrays[name] for name in arrays if name.startswith("curve.")}
        return Checkpoint(
            **{**text, "written": tuple(text["written"]), "sections": tuple(text["sections"])},
            state=state,
            peak=state if peak is None else unpack(peak, arrays, TYPES),
            curve=curve,
        )
    except (KeyError, TypeError, ValueError) as error:
        problem = f"is of another version of Fissura, or damaged ({type(error).__name__}: {error})"
        raise InputError(str(path), problem, _WHAT_TO_DO) from None
