import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fissura.equilibrium import StepLength, limits


def test_starts_with_a_power_of_two_below_the_first_step():
    assert StepLength.starting(1.0, 8.0, 1e-3).length == 1.0
    assert StepLength.starting(1.5, 8.0, 1e-3).length == 1.0
    assert StepLength.starting(8.0, 8.0, 1e-3).length == 8.0


def test_ends_are_multiples_of_the_length():
    step = StepLength(8.0, 0.1, 3)
    assert step.next_value(0.0, 100.0) == 1.0
    assert step.next_value(0.6, 100.0) == 1.0
    assert step.next_value(1.0 - 1e-9, 100.0) == 2.0
    assert step.next_value(99.5, 99.7) == 99.7


def test_hard_steps_halve_at_once_and_easy_ones_double_with_patience():
    step = StepLength(8.0, 0.1, 2)
    assert step.after(limits.HARD, 2.0).length == 1.0
    assert step.after(limits.EASY + 1, 2.0).length == 2.0
    once = step.after(1, 2.0)
    assert once.length == 2.0
    assert once.after(1, 4.0).length == 4.0


def test_doubles_only_where_the_longer_step_begins():
    step = StepLength(8.0, 0.1, 2, easy=limits.EASY_STEPS - 1)
    waiting = step.after(1, 6.0)
    assert waiting.length == 2.0
    assert waiting.after(1, 8.0).length == 4.0


def test_never_longer_than_the_longest():
    step = StepLength(8.0, 0.1, 0)
    for k in range(5):
        step = step.after(1, 8.0 * k)
    assert step.length == 8.0


def test_halving_stops_at_the_smallest():
    step = StepLength(8.0, 1.0, 2)
    assert step.halved().length == 1.0
    assert step.halved().halved() is None


def test_no_step_is_shorter_than_the_smallest():
    step = StepLength(8.0, 3.0, 1)
    assert step.after(limits.HARD, 4.0).length == 4.0
    assert step.halved() is None


@settings(deadline=None, derandomize=True)
@given(
    st.lists(st.integers(1, 20), max_size=300),
    st.floats(1e-3, 1.0),
    st.floats(1.0, 1e3),
)
def test_any_run_reaches_the_target_on_the_grid(iterations, first, target):
    """Whatever happens, values grow, lie on the grid of their own length, and no step is longer than the longest."""
    longest = target / 50
    step, value, count = StepLength.starting(first * longest, longest, longest / 2**60), 0.0, 0
    while value < target * (1 - 1e-9):
        end = step.next_value(value, target)
        assert value < end <= target
        assert end - value <= longest * (1 + 1e-9)
        assert end == target or end / step.length == pytest.approx(round(end / step.length), rel=1e-12)
        value = end
        step = step.after(iterations[count], value) if count < len(iterations) and step.level < 30 else step
        if count >= len(iterations):
            step = StepLength(longest, step.smallest, 0)
        count += 1
    assert value == target
