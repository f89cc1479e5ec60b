"""Which observations never came, told by those that did."""

import pytest
from tests.learner_node.walking.observations import observation

from biped_ros.observation_gaps import ObservationGaps


def gaps(*observations):
    """Return what is missing before each (episode, control tick)."""
    counted = ObservationGaps()
    return [
        counted.before(
            observation(tick, episode=episode, clock_ticks=1000 * episode + tick)
        )
        for episode, tick in observations
    ]


@pytest.mark.parametrize(
    ("walked", "missing"),
    [
        ([(1, 0), (1, 10), (1, 20)], [0, 0, 0]),
        ([(1, 0), (1, 10), (1, 15), (2, 0)], [0, 0, 0, 0]),
        ([(1, 0), (1, 40)], [0, 3]),
        ([(1, 0), (1, 35)], [0, 3]),
        ([(1, 0), (2, 20)], [0, 2]),
        ([(1, 30), (1, 40)], [0, 0]),
        ([(1, 30), (1, 10), (1, 40)], [0, 0, 0]),
        ([(1, 30), (1, 30)], [0, 0]),
    ],
    ids=["none", "short last", "three", "at the end", "begin", "join", "old", "twice"],
)
def test_gaps_are_counted(walked, missing):
    assert gaps(*walked) == missing


def test_another_simulation_is_joined_where_it_is():
    counted = ObservationGaps()
    counted.before(observation(0))
    assert counted.before(observation(50, simulation="another", clock_ticks=50)) == 0
