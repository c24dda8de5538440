"""Datasets of xarray: curves and fields over steps, with units."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fissura.errors import InputError
from fissura.results import Result, xarrays
from fissura.running.recorder import Recorder

from .pictured import record
from .synthetic import simulation


@pytest.fixture(scope="module")
def result() -> Any:
    """A run that is coarse at the peak and at its end, and fine between them."""
    pytest.importorskip("xarray")
    return record(None)


def test_curve(result: Result) -> None:
    found = result.to_xarray()
    assert dict(found.sizes) == {"step": 6}
    np.testing.assert_array_equal(found["step"], result.curve["step"])
    for name, column, unit in (("load", "load_N", "N"), ("dissipated", "dissipated_J", "J"), ("gauge", "gauge_m", "m")):
        np.testing.assert_array_equal(found[name], result.curve[column])
        assert found[name].attrs == {"units": unit}
    assert found["unbalanced_Nm"].attrs == {"units": "N m"}
    assert len(found) == len(result.curve) - 1
    assert found["support_0_moment_x"].attrs == {"units": "N m"}
    assert found["iterations"].attrs == {}
    assert found.attrs == {"case": "little beam", "seed": 7, "full": 0}


def test_bodies_are_found_by_their_nuclei(result: Result) -> None:
    found = result.to_xarray("bodies")
    assert found["step"].values.tolist() == sorted(result.snapshots)
    for number, shot in result.snapshots.items():
        there = found.sel(step=number, nucleus=shot.tessellation.nucleus)
        np.testing.assert_array_equal(there["displacement"], shot.displacement[:, :3])
        np.testing.assert_array_equal(there["stress"], shot.stress)
        np.testing.assert_array_equal(there["fine"], shot.tessellation.fine)
    assert {name: found[name].attrs.get("units") for name in ("displacement", "stress", "volume", "fine")} == {
        "displacement": "m",
        "stress": "Pa",
        "volume": "m^3",
        "fine": None,
    }
    counts = found["volume"].notnull().sum("nucleus").values.tolist()
    assert counts == [len(shot.tessellation) for shot in result.snapshots.values()]
    assert min(counts) < max(counts)


def test_contacts_are_found_by_their_pairs(result: Result) -> None:
    found = result.to_xarray("contacts")
    pairs = set(zip(found["nucleus_a"].values.tolist(), found["nucleus_b"].values.tolist(), strict=True))
    assert len(pairs) == found.sizes["contact"]
    for number, shot in result.snapshots.items():
        at = found.sel(step=number)
        joined = np.sort(shot.tessellation.nucleus[shot.tessellation.contacts.bodies], axis=1)
        for (a, b), opening, traction in zip(joined, shot.opening, shot.traction, strict=True):
            one = at.isel(contact=int(np.flatnonzero((found["nucleus_a"] == a) & (found["nucleus_b"] == b))[0]))
            assert float(one["opening"]) == opening
            np.testing.assert_array_equal(one["traction"], traction)
            if a > 4:  # enough of them
                break
        assert int(at["damage"].notnull().sum()) == len(joined)


def test_what_there_is_no_dataset_of(result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match=r"^what: 'cracks' is not known \(allowed: curve, bodies, contacts\)"):
        result.to_xarray("cracks")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="no states"):
        Recorder(simulation(), None).finish("stopped").to_xarray("bodies")

    def missing(name: str) -> Any:
        raise ImportError(name)

    monkeypatch.setattr(xarrays, "import_module", missing)
    with pytest.raises(InputError, match="pip install xarray"):
        result.to_xarray()
