"""One seed, streams that have nothing to do with each other."""

import itertools

import numpy as np

from biped_common.seeds import learner_stream, robot_stream, trial_stream

STREAMS = (learner_stream, robot_stream, trial_stream)


def draws(stream, seed):
    return np.random.default_rng(stream(seed)).random(4).tolist()


def test_a_seed_gives_each_part_the_same_draws_again():
    assert [draws(stream, 7) for stream in STREAMS] == [
        draws(stream, 7) for stream in STREAMS
    ]


def test_no_two_parts_and_no_two_seeds_share_draws():
    every = [draws(stream, seed) for stream in STREAMS for seed in (7, 8)]
    assert all(a != b for a, b in itertools.combinations(every, 2))


def test_learner_and_robot_draw_what_they_drew_before_walks_were_tested():
    learner, robot = np.random.SeedSequence(7).spawn(2)
    assert draws(learner_stream, 7) == np.random.default_rng(learner).random(4).tolist()
    assert draws(robot_stream, 7) == np.random.default_rng(robot).random(4).tolist()
