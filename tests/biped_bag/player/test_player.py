"""The player's thread: what it publishes, paused, stopped, late and in error."""

import time

import pytest

from biped_bag.player.clock import FLAT_OUT
from biped_bag.player.player import Player
from biped_bag.storage.contents import BagMessage

MS = 1_000_000
TIMEOUT_S = 30.0


def messages(count, period_ns=MS):
    return [BagMessage("/zmp", b"%d" % n, n * period_ns, 0) for n in range(count)]


def player(played, publish, rate=FLAT_OUT, **options):
    """Make a player of a list of messages."""
    end_ns = played[-1].log_ns
    return Player(lambda: played, publish, 0, end_ns, rate, **options)


def wait_for(condition):
    end = time.monotonic() + TIMEOUT_S
    while time.monotonic() < end and not condition():
        time.sleep(0.001)
    assert condition()


def test_every_message_is_published_once_and_in_order():
    published = []
    playing = player(messages(50), published.append)
    playing.start()
    assert playing.finish().messages == 50
    assert published == messages(50)


def test_playing_takes_the_recorded_time_over_the_rate():
    playing = player(messages(21, 10 * MS), lambda _: None, rate=2.0)
    playing.start()
    assert playing.finish().duration_s >= 0.0999


def test_no_message_comes_more_than_a_quarter_of_a_millisecond_early():
    came_ns = []
    playing = player(
        messages(50), lambda _: came_ns.append(time.monotonic_ns()), rate=1.0
    )
    before_ns = time.monotonic_ns()
    playing.start()
    playing.finish()
    early_ns = [n * MS - (at - before_ns) for n, at in enumerate(came_ns)]
    assert max(early_ns) <= 250_000


def test_a_rate_that_cannot_be_kept_is_told_with_that_which_was():
    playing = player(messages(60, 10 * MS), lambda _: time.sleep(0.02), rate=10.0)
    playing.start()
    playing.finish()
    assert playing.lag.late_s > 0.25
    assert 0.0 < playing.lag.rate <= 0.5


def test_flat_out_nothing_is_late():
    playing = player(messages(20), lambda _: time.sleep(0.02))
    playing.start()
    assert playing.finish().worst_lateness_s == 0.0
    assert playing.lag is None


def test_a_stop_ends_also_what_is_paused():
    playing = player(messages(5), lambda _: None, paused=True)
    playing.start()
    playing.stop()
    assert playing.finish().messages == 0


def test_every_step_of_a_loop_is_a_message():
    published = []
    playing = player(messages(3), published.append, paused=True, loop=True)
    playing.start()
    for count in range(1, 8):
        playing.step()
        wait_for(lambda count=count: len(published) == count)
    playing.stop()
    assert playing.finish().messages == 7


def test_a_loop_goes_on_until_it_is_stopped():
    published = []
    playing = player(messages(5), published.append, loop=True)
    playing.start()
    wait_for(lambda: len(published) > 20)
    playing.stop()
    count = playing.finish().messages
    assert published == (messages(5) * (count // 5 + 1))[:count]


def test_every_pass_waits_for_the_delay():
    playing = player(messages(2), lambda _: None, delay_s=0.1)
    playing.start()
    assert playing.finish().duration_s >= 0.0999


def test_a_stop_ends_the_delay():
    playing = player(messages(5), lambda _: None, delay_s=10.0 * TIMEOUT_S)
    playing.start()
    playing.stop()
    assert playing.finish().messages == 0


def test_pausing_can_be_toggled():
    playing = player(messages(1), lambda _: None)
    assert [playing.toggle_paused() for _ in range(3)] == [True, False, True]


def test_what_ends_playing_early_is_raised_at_its_end():
    def fail(_):
        raise OSError("no more disk")

    playing = player(messages(5), fail)
    playing.start()
    with pytest.raises(OSError, match="no more disk"):
        playing.finish()
