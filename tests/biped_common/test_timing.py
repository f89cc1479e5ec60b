"""Integer time."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from biped_common.timing import (
    CONTROL_PERIOD_S,
    LEARNING_PERIOD_S,
    LEARNING_PERIOD_US,
    microseconds,
    seconds,
)


def test_the_control_period_is_2_ms():
    assert CONTROL_PERIOD_S == 0.002


def test_the_learning_period_is_20_ms():
    assert LEARNING_PERIOD_S == 0.020


def test_the_learning_period_is_20_000_us():
    assert LEARNING_PERIOD_US == 20_000


@pytest.mark.parametrize(
    ("ticks", "time_s"), [(0, 0.0), (1, 0.002), (500, 1.0), (5625, 11.25)]
)
def test_control_ticks_last_2_ms_each(ticks, time_s):
    assert seconds(ticks) == time_s


@settings(deadline=None)
@given(st.integers(0, 10**9))
def test_no_tick_is_lost_in_seconds(ticks):
    assert microseconds(seconds(ticks)) == 2_000 * ticks


@pytest.mark.parametrize(
    ("duration_s", "duration_us"),
    [(1.875, 1_875_000), (0.1 + 0.2, 300_000), (1e-6, 1), (4e-7, 0)],
)
def test_durations_are_rounded_to_whole_microseconds(duration_s, duration_us):
    assert microseconds(duration_s) == duration_us
