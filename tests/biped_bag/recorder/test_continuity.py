"""Losses are found by the publishers' own numbers, several publishers or not."""

import random

from biped_bag.recorder.continuity import Continuity


def after(numbers, publishers=1):
    """Return what was concluded from these numbers."""
    continuity = Continuity()
    continuity.publishers = publishers
    for number in numbers:
        continuity.take(number)
    return continuity


def test_numbers_without_a_gap_mean_no_loss():
    assert after(range(1, 100)).lost == 0


def test_a_gap_is_as_many_losses_as_numbers_are_missing():
    assert after([1, 2, 3, 7, 8]).lost == 3


def test_what_was_sent_before_the_first_message_is_not_lost():
    continuity = after([41, 42])
    assert (continuity.lost, continuity.earlier) == (0, 40)


def test_a_publisher_that_was_started_again_has_lost_nothing():
    assert after([1, 2, 3, 1, 2]).lost == 0


def test_publishers_that_take_turns_have_lost_nothing():
    rng = random.Random(1)
    left = [list(range(1, 200)) for _ in range(4)]
    numbers = []
    while any(left):
        numbers.append(rng.choice([queue for queue in left if queue]).pop(0))
    assert after(numbers, publishers=4).lost == 0


def test_one_loss_among_several_publishers_is_counted_once():
    numbers = [1, 1, 2, 2, 3, 4, 4, 5, 5]  # one of the two lost its third
    assert after(numbers, publishers=2).lost == 1


def test_a_publisher_that_was_there_before_is_not_taken_for_a_loss():
    continuity = after([1, 2, 500, 3, 501], publishers=2)
    assert (continuity.lost, continuity.earlier) == (0, 499)
