"""Walks of the whole robot that end from outside are walked again, bit for bit."""

import pytest
from tests.biped_bringup.runs import DISTURBED, SHORT, learn, quick, record

from msgs_json.end_cause import EndCause
from sim_node.pilot import Pilot

EPISODES = 4
WAYS = [
    (1, EndCause.LATE),
    (15, EndCause.PEER_SILENT),
    (25, EndCause.RESET),
    (10, EndCause.DISTURBED),
]


def give_up_a_walk(run, learning_ticks, cause):
    """Begin a walk as on the graph, and end it from outside."""
    pilot, reference = Pilot(run.walker.biped), run.walker.reference
    reference.reset()
    answer = run.session.respond(pilot.begin())
    for _ in range(learning_ticks):
        segment = reference.segment(answer)
        answer = run.session.respond(
            pilot.execute(pilot.observation.clock_ticks, segment)
        )
    run.session.respond(pilot.end(cause))


@pytest.mark.parametrize(
    "changes", [(), (*DISTURBED, "learner.method=q_lambda")], ids=["calm", "disturbed"]
)
def test_they_leave_nothing_behind(training, changes):
    settings = quick(*SHORT, *changes)
    undisturbed = learn(training(settings), EPISODES)
    run = training(settings, replay_bytes=0)
    for episodes in range(EPISODES):
        for way in WAYS[: episodes + 1]:
            give_up_a_walk(run, *way)
        run.episode()
    assert sum(run.tally.given_up.values()) == 10
    run.tally.given_up = {}
    assert record(run) == record(undisturbed)
