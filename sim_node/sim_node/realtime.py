"""Walking in real time: one thread, absolute deadlines, no waiting for anybody.

A segment is taken over as soon as it is there; until then the robot walks on along the
look-ahead of the last one. A segment that is not there at the end of its learning tick
has missed its deadline, and the walk ends as `late`: what would follow was chosen by
nobody, so nothing could be made of it.

A thread that was held up for longer than two control ticks does not make up for it: its
clock falls behind, and who answers has the whole learning tick all the same.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from queue import Empty, SimpleQueue

import numpy as np

from biped_common.timing import (
    CONTROL_PERIOD_NS,
    CONTROL_PERIOD_S,
    TICKS_PER_LEARNING_TICK,
)
from msgs_json.end_cause import EndCause
from msgs_json.observation import Observation
from sim_node.pilot import Pilot

# Figures in /diagnostics.
MISSED_DEADLINES = "missed 20 ms deadlines"
SIMULATED_PER_REAL_TIME = "simulated per real time"

_REMEMBERED_TICKS = 10_000
_STALL_TICKS = 2
"""Control ticks by which the thread may be behind before the time is lost."""


class Punctuality:
    """Rate and lateness of control ticks, latency of segments, deadlines missed."""

    def __init__(self) -> None:
        """Start with nothing measured."""
        self.missed_deadlines = 0
        self.ticks = 0
        """Control ticks walked."""
        self.lost_ns = 0
        """Time by which walks fell behind the wall clock."""
        self._rated_ticks = 0
        self._rated_ns = time.monotonic_ns()
        self._lateness_ns: deque[int] = deque(maxlen=_REMEMBERED_TICKS)
        self._latency_ns: deque[int] = deque(maxlen=_REMEMBERED_TICKS)

    def late(self, lateness_ns: int) -> None:
        """Take note of how late a control tick began; only real time has deadlines."""
        self._lateness_ns.append(lateness_ns)

    def segment(self, latency_ns: int) -> None:
        """Take note of the time from an observation to its segment."""
        self._latency_ns.append(latency_ns)

    def figures(self) -> dict[str, str]:
        """Return the rate since the last call, and percentiles of the recent past."""
        now_ns = time.monotonic_ns()
        elapsed_s = (now_ns - self._rated_ns) * 1e-9
        rate_hz = (self.ticks - self._rated_ticks) / elapsed_s
        self._rated_ticks, self._rated_ns = self.ticks, now_ns
        figures = {
            "control ticks": str(self.ticks),
            "control ticks [Hz]": f"{rate_hz:.1f}",
            SIMULATED_PER_REAL_TIME: f"{rate_hz * CONTROL_PERIOD_S:.3f}",
            MISSED_DEADLINES: str(self.missed_deadlines),
            "real time lost [ms]": f"{self.lost_ns / 1e6:.1f}",
        }
        for name, values in (
            ("control tick lateness", self._lateness_ns),
            ("observation to waist", self._latency_ns),
        ):
            if values:
                p50, p99, worst = np.percentile(np.array(values), (50, 99, 100)) / 1e6
                figures[f"{name} p50 [ms]"] = f"{p50:.3f}"
                figures[f"{name} p99 [ms]"] = f"{p99:.3f}"
                figures[f"{name} max [ms]"] = f"{worst:.3f}"
        return figures


class RealtimeLoop:
    """Drives a pilot at 500 Hz; all that touches the robot happens in its thread."""

    def __init__(
        self,
        pilot: Pilot,
        walk_ticks: int,
        factor: float,
        publish: Callable[[Observation], None],
        punctuality: Punctuality,
    ) -> None:
        """Prepare the thread.

        Args:
            pilot: of the robot.
            walk_ticks: control ticks of the whole walk; then nothing more is due.
            factor: simulated seconds per second.
            publish: gives out an observation.
            punctuality: takes note of the deadlines.
        """
        self._punctuality = punctuality
        self._pilot = pilot
        self._walk_ticks = walk_ticks
        self._publish = publish
        self.set_factor(factor)
        self._requests: SimpleQueue[Callable[[], None]] = SimpleQueue()
        self._stopping = threading.Event()
        self._paused = False
        self._observed_ns = 0
        self._answered = False
        self._thread = threading.Thread(target=self._run, name="realtime", daemon=True)

    def set_factor(self, factor: float) -> None:
        """Walk so many simulated seconds per second from the next control tick on."""
        self._period_ns = round(CONTROL_PERIOD_NS / factor)

    def start(self) -> None:
        """Start the thread; the robot stands until the first walk is begun."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread."""
        self._stopping.set()
        if self._thread.is_alive():
            self._thread.join()

    def request(self, action: Callable[[], None]) -> None:
        """Have something done between two control ticks, in the loop's thread."""
        self._requests.put(action)

    # Requests: call these in the loop's thread only.

    def begin(self) -> None:
        """Begin the next walk."""
        self._give_out(self._pilot.begin())

    def segment_arrived(self) -> None:
        """Take note that the last observation has been answered."""
        self._answered = True
        self._punctuality.segment(time.monotonic_ns() - self._observed_ns)
        cause = self._pilot.biped.end_cause
        if cause is not None:  # the legs cannot follow it
            self.end(cause)

    def end(self, cause: EndCause) -> None:
        """End the walk from outside."""
        observation = self._pilot.end(cause)
        if observation is not None:
            self._give_out(observation)

    def pause(self, paused: bool) -> None:
        """Stop or go on between two ticks."""
        self._paused = paused

    def _run(self) -> None:
        deadline_ns = time.monotonic_ns()
        while not self._stopping.is_set():
            deadline_ns += self._period_ns
            wait_ns = deadline_ns - time.monotonic_ns()
            if wait_ns > 0:
                time.sleep(wait_ns * 1e-9)
            lateness_ns = max(0, time.monotonic_ns() - deadline_ns)
            stalled = lateness_ns > _STALL_TICKS * self._period_ns
            if stalled:
                deadline_ns += lateness_ns
            self._serve_requests()
            if not self._paused and self._pilot.walking:
                self._punctuality.late(lateness_ns)
                if stalled and self._pilot.biped.control_tick > 0:
                    self._punctuality.lost_ns += lateness_ns
                self._tick()

    def _serve_requests(self) -> None:
        while True:
            try:
                action = self._requests.get_nowait()
            except Empty:
                return
            action()

    def _tick(self) -> None:
        biped = self._pilot.biped
        if biped.control_tick >= self._walk_ticks:
            return  # the robot stands until it is told the result
        if biped.ticks_ahead < 1:
            # Before the first segment of a walk the robot just stands and waits.
            if biped.control_tick > 0:
                self._miss()
            return
        biped.advance()
        over = biped.end_cause is not None
        # The walk's last segment is shorter; on look-ahead, only the count tells.
        due = biped.at_segment_end or biped.control_tick % TICKS_PER_LEARNING_TICK == 0
        if due and not self._answered:
            self._miss()
        elif over or due:
            self._give_out(self._pilot.observe())

    def _miss(self) -> None:
        self._punctuality.missed_deadlines += 1
        self._give_out(self._pilot.miss())

    def _give_out(self, observation: Observation) -> None:
        self._observed_ns = time.monotonic_ns()
        self._answered = observation.end_cause is not None
        self._publish(observation)
