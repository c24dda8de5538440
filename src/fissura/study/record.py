"""What a study keeps of one run: curve, summary, energy by contact, indicators of error; one file of some 100 kB."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fissura.arrays import FloatArray, IntArray
from fissura.case import Case, case_from_dict
from fissura.errors import InputError
from fissura.files.archive import read_archive, write_archive
from fissura.results.curve import COLUMNS, Curve, columns
from fissura.results.result import Result

FORMAT, FORMAT_VERSION = "fissura-study-run", 1


@dataclass(frozen=True)
class Energies:
    """Energy that contacts have dissipated over a run; contacts that dissipated none are left out.

    Attributes
    ----------
    pairs : (k, 2) array
        Identities of the two nuclei, the smaller one first.
    energy : (k,) array
        Energy [J].
    centroid : (k, 3) array
        Centroid of the facet [m].
    """

    pairs: IntArray = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    energy: FloatArray = field(default_factory=lambda: np.empty(0))
    centroid: FloatArray = field(default_factory=lambda: np.empty((0, 3)))

    def __len__(self) -> int:
        return len(self.energy)

    @classmethod
    def summed(cls, pairs: IntArray, energy: FloatArray, centroid: FloatArray) -> Energies:
        """Energies of contacts that occur several times, as from several steps; the last centroid counts."""
        if not len(pairs):
            return cls()
        unique, first, which = np.unique(pairs[::-1], axis=0, return_index=True, return_inverse=True)
        total = np.zeros(len(unique))
        np.add.at(total, which.ravel(), energy[::-1])
        return cls(unique, total, centroid[::-1][first])


@dataclass(frozen=True)
class Record:
    """One run of a study.

    Attributes
    ----------
    specimen, variation : str
        What was run; see `fissura.study.definition.Task`.
    seed : int
    case : dict
        The case with all defaults, as in ``case.json``.
    status : str
        ``"finished"``; ``"stopped"``: no equilibrium was found any more, what there was until then is kept;
        ``"refused"``: the case cannot be run; ``"failed"``: anything else.
    message : str
        Why, unless finished.
    summary : dict
        As in ``summary.json``; empty without steps.
    curve : dict of str to (steps,) array
        As in ``curve.csv``.
    energies : Energies
        By contact.
    indicators : dict of str to (steps,) array
        What the run itself tells about its error; see `fissura.study.indicators`.
    """

    specimen: str
    seed: int
    variation: str
    case: dict[str, Any]
    status: str
    message: str = ""
    summary: dict[str, Any] = field(default_factory=dict)
    curve: Curve = field(default_factory=lambda: columns([]))
    energies: Energies = field(default_factory=Energies)
    indicators: dict[str, FloatArray] = field(default_factory=dict)

    @property
    def steps(self) -> int:
        """Number of accepted steps."""
        return len(self.curve["step"])

    @property
    def end(self) -> str:
        """What ended the run: ``"target"``, ``"load"`` (it fell to ``stop_load``), or the status."""
        if self.status != "finished":
            return self.status
        reached = self.result().controlled[-1] >= self.case["control"]["target"] * (1.0 - 1e-9)
        return "target" if reached else "load"

    def result(self) -> Result:
        """The run as a `Result` without states."""
        case = case_from_dict(self.case, files_exist=False)
        return Result(case, bool(self.summary.get("full")), self.curve, self.summary, {})

    def save(self, path: Path) -> None:
        """Write the record; there is never half a file."""
        head = {
            name: getattr(self, name)
            for name in ("specimen", "seed", "variation", "case", "status", "message", "summary")
        }
        arrays: dict[str, Any] = {
            "head": json.dumps(head, allow_nan=False),
            "pairs": self.energies.pairs,
            "energy": self.energies.energy,
            "centroid": self.energies.centroid.astype(np.float32),
        }
        arrays |= {f"curve.{name}": values for name, values in self.curve.items()}
        arrays |= {f"indicator.{name}": values for name, values in self.indicators.items()}
        path.parent.mkdir(parents=True, exist_ok=True)
        write_archive(path, FORMAT, FORMAT_VERSION, arrays)

    @classmethod
    def load(cls, path: Path) -> Record:
        """Read a record.

        Raises
        ------
        InputError
            The file is missing, damaged, something else, or newer than this version of Fissura.
        """
        arrays = read_archive(path, FORMAT, FORMAT_VERSION)
        curve = _part(arrays, "curve.")
        missing = set(COLUMNS) - set(curve)
        try:
            if missing:
                raise KeyError(f"column {', '.join(sorted(missing))}")
            head = json.loads(str(arrays["head"]))
            pairs, energy, centroid = (arrays[name] for name in ("pairs", "energy", "centroid"))
            energies = Energies(pairs.astype(np.int64), energy, centroid.astype(np.float64))
            return cls(**head, curve=curve, energies=energies, indicators=_part(arrays, "indicator."))
        except (KeyError, TypeError, ValueError) as error:
            raise InputError(str(path), f"is damaged ({error})", f"a {FORMAT} file") from error


def case_text(case: Case | Mapping[str, Any], *, of_full: bool = False) -> str:
    """What decides the results of a case, as text to be compared; of a run at full resolution where asked for."""
    data = dict(case.model_dump(mode="json", exclude={"source"}) if isinstance(case, Case) else case)
    data.pop("output", None)
    if of_full:
        data.pop("adaptivity", None)
        data["discretization"] = {key: value for key, value in data["discretization"].items() if key != "l_c"}
    return json.dumps(data, sort_keys=True)


def _part(arrays: dict[str, Any], prefix: str) -> dict[str, Any]:
    return {name.removeprefix(prefix): values for name, values in arrays.items() if name.startswith(prefix)}
