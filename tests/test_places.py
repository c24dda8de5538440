"""Places of supports, loads and gauges in whole runs, from case files to peaks and messages."""

from __future__ import annotations

import pytest

from fissura.check import report
from fissura.errors import InputError
from fissura.simulation import Simulation

#: Thinner than platens are wide.
THIN_BEAM = {
    "specimen__size": [0.12, 0.04, 0.012],
    "notch__depth": 0.016,
    "discretization": {"l_f": 0.006, "l_c": 0.012},
    "control__target": 6e-5,
}


def test_the_peak_does_not_depend_on_the_width_of_a_platen(small_case):
    """A pin turns about the line across the beam, on platens narrower than the beam is thick, as wide, and wider."""
    peaks = []
    for width in (0.0, 0.010, 0.012, 0.013, 0.020):
        case = small_case(supports__0__width=width, **THIN_BEAM)
        peaks.append(max(step.load for step in Simulation(case, full=True).steps()))
    assert peaks == pytest.approx([194.2] * 5, rel=1e-4)


@pytest.mark.parametrize("end", ["a", "b"])
def test_a_gauge_that_ends_in_the_plane_of_an_ideal_cut_is_refused(small_case, end):
    with pytest.raises(InputError, match="ideal cut") as caught:
        report(small_case(**{f"gauge__{end}__at": 0.06}))
    assert caught.value.key == f"gauge.{end}.at"
