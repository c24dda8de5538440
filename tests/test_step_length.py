"""The peak does not depend on how far a run is to go."""

import pytest

from equilibrium.models import beam
from fissura.simulation.loop import Simulation


def peak(target, **changes):
    """Largest load, followed until a fifth of it is lost."""
    largest = 0.0
    for step in Simulation(beam(**changes, control={"target": target}), full=True).steps():
        largest = max(largest, step.load)
        if step.load < 0.8 * largest:
            break
    return largest


@pytest.mark.parametrize("seed", [1, 2])
def test_peaks_agree_whatever_the_target(seed):
    """With targets of 10 and 100 mm they were 4 to 12 % low."""
    expected = peak(5e-5, seed=seed)
    for target in (1e-3, 1e-2, 1e-1):
        assert peak(target, seed=seed) == pytest.approx(expected, rel=0.01)


def test_peaks_agree_under_control_by_the_displacement_of_the_load():
    changes = {"gauge": None}
    expected, far = (
        max(
            step.load
            for step in Simulation(
                beam(**changes, control={"type": "displacement", "target": target, "stop_load": 0.8}), full=True
            ).steps()
        )
        for target in (5e-5, 1e-1)
    )
    assert far == pytest.approx(expected, rel=0.01)


def test_short_steps_stay_as_they_were_asked_for():
    steps = list(Simulation(beam(control={"target": 2e-6}), full=True).steps())
    assert steps[0].gauge == pytest.approx(1e-8)
