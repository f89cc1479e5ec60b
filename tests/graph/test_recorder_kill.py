"""The recorder is killed with `kill -9`: its bag is recovered, all but its last moment.

What is lost is bounded by 0.2 s on a machine that is not overloaded; that is measured
by `python -m benchmarks.recorder_kill`.
"""

import random

import pytest
from benchmarks.recorder_kill import killed_recording, publishing
from tests.graph.domains import MODULE, own_domain

KILLS = 5
# A flush every 0.1 s, and as much patience as an overloaded machine needs.
LONGEST_LOSS_S = 2.0


@pytest.fixture(scope="module")
def kills(tmp_path_factory):
    """Recorders killed at random moments while they wrote."""
    domain = own_domain(MODULE)
    chance = random.Random(1)
    folder = tmp_path_factory.mktemp("kills")
    kills = []
    with publishing(folder, domain) as sent:
        for number in range(KILLS):
            (folder / str(number)).mkdir()
            after_s = chance.uniform(0.0, 1.0)
            kills.append(killed_recording(folder / str(number), domain, sent, after_s))
    return kills


def test_every_bag_is_recovered(kills):
    assert all(kill.recovered > 0 for kill in kills)


def test_every_report_is_right_to_the_message(kills):
    assert [kill.right for kill in kills] == KILLS * [True]


def test_no_more_than_the_last_moment_is_lost(kills):
    assert max(kill.lost_s for kill in kills) < LONGEST_LOSS_S
