"""The player's thread: publish each message when it is due, until the end or a stop.

What failures do:
    a message is late (machine busy, disk slow): it is published at once; those after it
        keep their own due times.
    messages get later and later, as the asked rate is too fast for the machine: as
        above; `lag` tells, once they are late by a quarter of a second.
    publishing or reading fails: playing ends there, and `finish` raises the error.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple

from biped_bag.player.clock import FLAT_OUT, PlaybackClock
from biped_bag.storage.contents import BagMessage

# Waking up takes about as long: what is due by then is published in the same turn.
_AT_ONCE_NS = 250_000
_LAG_NS = 250_000_000


class Lag(NamedTuple):
    """Where playing was when it was first found to be far behind."""

    late_s: float
    rate: float
    """At which it had got there."""


@dataclass(frozen=True)
class Played:
    """What playing came to."""

    messages: int
    duration_s: float
    worst_lateness_s: float
    """Longest time that a message was published after it was due; 0 flat-out."""


class Player:
    """Plays passes of messages in a thread of its own."""

    def __init__(
        self,
        messages: Callable[[], Iterable[BagMessage]],
        publish: Callable[[BagMessage], None],
        start_ns: int,
        end_ns: int,
        rate: float,
        *,
        paused: bool = False,
        loop: bool = False,
        delay_s: float = 0.0,
    ) -> None:
        """Prepare.

        Args:
            messages: gives the messages of one pass, in the order of their log times.
            publish: gives out a message.
            start_ns: log time with which a pass begins.
            end_ns: log time with which it ends, not before the last message's.
            rate: as of PlaybackClock.
            paused: begin paused.
            loop: play again and again.
            delay_s: waited before each pass, also while paused.
        """
        self._messages = messages
        self._publish = publish
        self._start_ns, self._end_ns = start_ns, end_ns
        self._loop, self._delay_s = loop, delay_s
        self._changed = threading.Condition()
        self._stopped = False
        self.lag: Lag | None = None
        """None while the asked rate is kept."""
        self._clock = PlaybackClock(start_ns, rate, time.monotonic_ns(), paused=paused)
        self._count = 0
        self._worst_ns = 0
        self._duration_ns = 0
        self._error: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="player", daemon=True)

    @property
    def playing(self) -> bool:
        """Whether there is more to come."""
        return self._thread.is_alive()

    @property
    def rate(self) -> float:
        """Recorded time per time, as asked for last."""
        return self._clock.rate

    def start(self) -> None:
        """Begin to play."""
        self._thread.start()

    def finish(self) -> Played:
        """Wait for the end and return what was played.

        Raises:
            Exception: what ended playing early.
        """
        self._thread.join()
        if self._error is not None:
            raise self._error
        return Played(self._count, 1e-9 * self._duration_ns, 1e-9 * self._worst_ns)

    def stop(self) -> None:
        """End after the present message."""
        with self._changed:
            self._stopped = True
            self._changed.notify()

    def pause(self) -> bool:
        """Stop between two messages; return whether it was playing."""
        with self._changed:
            return self._clock.pause(time.monotonic_ns())

    def resume(self) -> bool:
        """Go on; return whether it was paused."""
        return self._change(lambda: self._clock.resume(time.monotonic_ns()))

    def step(self) -> bool:
        """Publish the next message and stay paused; return whether it was paused."""
        return self._change(self._clock.step)

    def toggle_paused(self) -> bool:
        """Stop or go on; return whether it is paused now."""
        return self.pause() or not self.resume()

    def set_rate(self, rate: float) -> None:
        """Play on at another rate, above 0 and finite; not when playing FLAT_OUT."""
        with self._changed:
            self._clock.set_rate(rate, time.monotonic_ns())
            self._changed.notify()

    def _change(self, change: Callable[[], bool]) -> bool:
        with self._changed:
            changed = change()
            self._changed.notify()
        return changed

    def _run(self) -> None:
        began_ns = time.monotonic_ns()
        try:
            while self._play_once() and self._loop:
                pass
        except Exception as error:
            self._error = error
        self._duration_ns = time.monotonic_ns() - began_ns

    def _play_once(self) -> bool:
        """Return whether the end was reached."""
        with self._changed:
            if self._delay_s:
                self._changed.wait_for(lambda: self._stopped, self._delay_s)
            self._clock.restart(self._start_ns, time.monotonic_ns())
        for message in self._messages():
            if not self._await(message.log_ns):
                return False
            self._publish(message)
            self._count += 1
        return self._await(self._end_ns, at_end=True)

    def _await(self, log_ns: int, *, at_end: bool = False) -> bool:
        """Wait until a log time is due; return whether to go on."""
        with self._changed:
            while not self._stopped:
                due_ns = self._clock.due_ns(log_ns)
                now_ns = time.monotonic_ns()
                if due_ns is None:
                    self._changed.wait()
                elif due_ns > now_ns + _AT_ONCE_NS:
                    self._changed.wait(1e-9 * (due_ns - now_ns))
                else:
                    self._take_note(log_ns, now_ns, now_ns - due_ns)
                    if not at_end:  # a step is a message, which the end is not
                        self._clock.took(log_ns)
                    return True
        return False

    def _take_note(self, log_ns: int, now_ns: int, late_ns: int) -> None:
        if not self._clock.paused and self._clock.rate != FLAT_OUT:
            self._worst_ns = max(self._worst_ns, late_ns)
            if late_ns > _LAG_NS and self.lag is None:
                rate = self._clock.achieved_rate(log_ns, now_ns)
                self.lag = Lag(1e-9 * late_ns, rate)
