"""When messages are due: by absolute times, whatever is paused, stepped or late."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from biped_bag.player.clock import FLAT_OUT, PlaybackClock

times = st.integers(min_value=0, max_value=10**15)
rates = st.floats(min_value=0.01, max_value=100.0)


@given(log_ns=times, rate=rates, now_ns=times, since_ns=times)
def test_due_times_are_spaced_by_the_rate(log_ns, rate, now_ns, since_ns):
    clock = PlaybackClock(log_ns, rate, now_ns)
    due_ns = clock.due_ns(log_ns + since_ns)
    assert due_ns == pytest.approx(now_ns + since_ns / rate, abs=1.0)


@given(late_ns=times)
def test_a_late_message_delays_none_after_it(late_ns):
    clock = PlaybackClock(0, 1.0, 0)
    clock.took(late_ns)
    assert clock.due_ns(7) == 7


@given(played_ns=times, paused_ns=times, rate=rates)
def test_a_pause_delays_by_its_own_length(played_ns, paused_ns, rate):
    clock = PlaybackClock(0, rate, 0)
    undisturbed_ns = clock.due_ns(2 * 10**15)
    clock.pause(played_ns)
    clock.resume(played_ns + paused_ns)
    delayed_ns = clock.due_ns(2 * 10**15)
    # The place in the log is kept in whole nanoseconds.
    assert delayed_ns - undisturbed_ns == pytest.approx(paused_ns, abs=2.0 + 1.0 / rate)


def test_nothing_is_due_while_paused():
    assert PlaybackClock(0, 1.0, 0, paused=True).due_ns(0) is None


def test_a_step_lets_one_message_pass():
    clock = PlaybackClock(0, 1.0, 0, paused=True)
    clock.step()
    assert clock.due_ns(5) is not None
    clock.took(5)
    assert clock.due_ns(6) is None


def test_after_steps_it_goes_on_from_there():
    clock = PlaybackClock(0, 1.0, 0, paused=True)
    clock.step()
    clock.took(500)
    clock.resume(1000)
    assert clock.due_ns(600) == 1100


def test_there_are_no_steps_while_playing():
    assert not PlaybackClock(0, 1.0, 0).step()


def test_flat_out_everything_is_due_at_once():
    clock = PlaybackClock(0, FLAT_OUT, 100)
    assert clock.due_ns(10**15) == 100


@given(played_ns=times, old=rates, new=rates, later_ns=times)
def test_another_rate_holds_from_where_playing_is(played_ns, old, new, later_ns):
    clock = PlaybackClock(0, old, 0)
    clock.set_rate(new, played_ns)
    reached_ns = round(played_ns * old)
    due_ns = clock.due_ns(reached_ns + later_ns)
    assert due_ns == pytest.approx(played_ns + later_ns / new, abs=1.0)


def test_another_rate_while_paused_moves_nothing():
    clock = PlaybackClock(7, 1.0, 0, paused=True)
    clock.set_rate(2.0, 1000)
    clock.resume(1000)
    assert clock.due_ns(7) == 1000
