"""The time left that a run tells: exact where the pace is, silent where it is not, on recorded runs within a factor."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fissura.progress.time_left import TimeLeft

RECORDS = json.loads((Path(__file__).parents[2] / "benchmarks" / "time_left.json").read_text(encoding="utf-8"))


@given(st.floats(0.001, 1000.0), st.floats(0.0, 1e6), st.integers(12, 200))
def test_exact_at_a_steady_pace(step: float, begin: float, steps: int) -> None:
    left = TimeLeft()
    for k in range(steps + 1):
        found = left.after(begin + k * step, k / steps)
        if k / steps >= 0.3 and k >= 8:
            assert found == pytest.approx((steps - k) * step, rel=1e-6, abs=1e-6 * (begin + 1.0))


def test_silent_before_there_is_a_pace_and_where_it_changes() -> None:
    left = TimeLeft()
    assert [left.after(float(k), 0.02 * k) for k in range(10)] == [None] * 10
    assert left.after(10.0, 0.9) is None, "a jump"
    assert left.after(11.0, 0.9) is None, "no progress"


@pytest.mark.parametrize("name", RECORDS)
def test_recorded_runs(name: str) -> None:
    """Off by a factor of three at most after a tenth of the run; a tenth of the time so far is "almost done"."""
    left, end = TimeLeft(), RECORDS[name][-1][0]
    for now, share in RECORDS[name]:
        found = left.after(now, share)
        if found is not None and now >= 0.1 * end:
            least = max(1.0, 0.1 * now)
            told, true = max(found, least), max(end - now, least)
            assert true / 3.0 <= told <= 3.0 * true, (now, share)


def test_some_time_is_told() -> None:
    for name in ("beam_d100", "beam_d100 full", "beam_d200 full", "four_point_shear"):
        left = TimeLeft()
        told = [left.after(now, share) is not None for now, share in RECORDS[name]]
        assert sum(told) > 0.4 * len(told)
