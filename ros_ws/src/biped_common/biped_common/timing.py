"""Integer time: control ticks of 2 ms, learning ticks of 20 ms (paper, Section 4)."""

from __future__ import annotations

from typing import Any

CONTROL_PERIOD_US = 2_000
TICKS_PER_LEARNING_TICK = 10
CONTROL_PERIOD_S = CONTROL_PERIOD_US * 1e-6
CONTROL_PERIOD_NS = CONTROL_PERIOD_US * 1000
LEARNING_PERIOD_US = CONTROL_PERIOD_US * TICKS_PER_LEARNING_TICK
LEARNING_PERIOD_S = LEARNING_PERIOD_US * 1e-6
NS_PER_S = 1_000_000_000


def seconds(control_ticks: int) -> float:
    """Return the time of a control tick [s]."""
    return control_ticks * CONTROL_PERIOD_US * 1e-6


def control_ticks(duration_s: float) -> int:
    """Return how many whole control ticks a duration has."""
    return microseconds(duration_s) // CONTROL_PERIOD_US


def microseconds(duration_s: float) -> int:
    """Return a duration in whole microseconds, in which events are compared."""
    return round(duration_s * 1e6)


def nanoseconds(time: Any) -> int:
    """Return a builtin_interfaces Time or Duration in nanoseconds."""
    return int(time.sec) * NS_PER_S + int(time.nanosec)
