"""Statistics over the last messages: intervals, delays, sizes."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

from biped_common.timing import NS_PER_S


@dataclass(frozen=True)
class Spread:
    """Of some durations [ns]."""

    mean: float
    least: float
    most: float
    deviation: float
    count: int

    def line(self) -> str:
        """Return the second line of what `hz` and `delay` print."""
        return (
            f"\tmin: {self.least / NS_PER_S:.3f}s max: {self.most / NS_PER_S:.3f}s "
            f"std dev: {self.deviation / NS_PER_S:.5f}s window: {self.count}"
        )


def spread(durations_ns: Iterable[int]) -> Spread:
    """Return the spread of at least one duration; the deviation is the population's."""
    values = list(durations_ns)
    mean = sum(values) / len(values)
    variance = sum((value - mean) ** 2 for value in values) / len(values)
    return Spread(mean, min(values), max(values), math.sqrt(variance), len(values))


def rate_report(intervals_ns: Iterable[int]) -> str:
    """Return what `hz` prints for at least one interval between messages."""
    intervals = spread(intervals_ns)
    rate = NS_PER_S / intervals.mean if intervals.mean > 0.0 else 0.0
    return f"average rate: {rate:.3f}\n{intervals.line()}"


class RateWindow:
    """Rate of arrival, over the last intervals, once a second."""

    def __init__(self, size: int) -> None:
        """Begin without messages.

        Args:
            size: the most intervals that count.
        """
        self._intervals_ns: deque[int] = deque(maxlen=size)
        self._first_ns: int | None = None
        self._last_ns = 0
        self._reported_ns = 0

    def arrived(self, now_ns: int) -> str | None:
        """Take in a message; return a report if it is time for one.

        Args:
            now_ns: time of arrival; where it goes back, all begins anew.
        """
        if now_ns == 0:  # simulated time has not begun
            return self._reset()
        if self._first_ns is None or now_ns < self._first_ns:
            self._intervals_ns.clear()
            self._first_ns = self._last_ns = self._reported_ns = now_ns
            return None
        self._intervals_ns.append(now_ns - self._last_ns)
        self._last_ns = now_ns
        if now_ns < self._reported_ns + NS_PER_S:
            return None
        self._reported_ns = now_ns
        return rate_report(self._intervals_ns)

    def _reset(self) -> str | None:
        had_some = bool(self._intervals_ns)
        self._intervals_ns.clear()
        self._first_ns = None
        return "time has reset, resetting counters" if had_some else None


class DelayWindow:
    """Delay between stamp and arrival, over the last messages."""

    def __init__(self, size: int) -> None:
        """Begin without messages.

        Args:
            size: the most messages that count.
        """
        self._delays_ns: deque[int] = deque(maxlen=size)
        self._new = False

    def arrived(self, now_ns: int, stamp_ns: int) -> None:
        """Take in a message."""
        self._delays_ns.append(now_ns - stamp_ns)
        self._new = True

    def report(self) -> str | None:
        """Return what is to be printed, None before the first message."""
        if not self._delays_ns:
            return None
        if not self._new:
            return "no new messages"
        self._new = False
        delays = spread(self._delays_ns)
        return f"average delay: {delays.mean / NS_PER_S:.3f}\n{delays.line()}"


class BandwidthWindow:
    """Bytes per second, over the last messages."""

    def __init__(self, size: int) -> None:
        """Begin without messages.

        Args:
            size: the most messages that count.
        """
        self._arrivals: deque[tuple[int, int]] = deque(maxlen=size)

    def arrived(self, now_ns: int, size: int) -> None:
        """Take in a message of so many bytes."""
        self._arrivals.append((now_ns, size))

    def report(self, now_ns: int) -> str | None:
        """Return what is to be printed, None with fewer than two messages."""
        if len(self._arrivals) < 2:
            return None
        elapsed_ns = now_ns - self._arrivals[0][0]
        if elapsed_ns <= 0:
            self._arrivals.clear()
            return None
        sizes = [size for _, size in self._arrivals]
        rate = sum(sizes) * NS_PER_S / elapsed_ns
        unit = _unit(rate)
        mean, least, most = (
            _in_unit(size, unit)
            for size in (sum(sizes) / len(sizes), min(sizes), max(sizes))
        )
        return (
            f"{_in_unit(rate, unit)}/s from {len(sizes)} messages\n"
            f"\tMessage size mean: {mean} min: {least} max: {most}"
        )


def _unit(bytes_per_s: float) -> str:
    # One unit for the whole report: that of the bandwidth.
    if bytes_per_s < 1e3:
        return "B"
    return "KB" if bytes_per_s < 1e6 else "MB"


def _in_unit(size: float, unit: str) -> str:
    if unit == "B":
        return f"{size:.0f} B"
    return f"{size / (1e3 if unit == 'KB' else 1e6):.2f} {unit}"
