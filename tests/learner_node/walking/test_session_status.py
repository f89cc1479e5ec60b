"""What a session says of itself."""

import pytest
from tests.learner_node.walking.sessions import (
    FALL,
    frozen_session,
    learned_session,
    new_session,
    result_of,
    with_schedule_complete,
)

from msgs_json.learner_status import LearnerStatus
from msgs_json.wire import decode, encode


def test_the_status_of_a_new_session():
    status = new_session(seed=7).status("me")
    assert status == LearnerStatus(
        instance="me",
        seed=7,
        target_time_s=0.06,
        subtask=0,
        subtasks=2,
        successes=0,
        episodes=0,
        survival=0.0,
        figures={"basis_states": 0, "fixed_states": 0, "penalty_states": 0},
        t_err_estimate=None,
        schedule_complete=False,
        learned=False,
        frozen=False,
        given_up={},
        simulated_s=0.0,
        memory_sha256=new_session().memory_sha256(),
        trajectory_sha256="",
    )


def test_the_status_tells_how_far_the_schedule_has_come():
    session = new_session()
    for _ in range(3):
        result_of(session)
    status = session.status("me")
    found = status.subtask, status.successes, status.target_time_s
    assert found == (1, 1, pytest.approx(0.1))


def test_the_status_tells_the_estimate():
    session = new_session()
    result_of(session, t_err=2.0)
    assert session.status("me").t_err_estimate == pytest.approx(2.1)


def test_the_status_tells_episodes_and_their_simulated_time():
    session = new_session()
    result_of(session)
    result_of(session, **FALL)
    status = session.status("me")
    assert (status.episodes, status.simulated_s) == (2, pytest.approx(0.1))


def test_the_status_tells_survival():
    session = new_session()
    result_of(session)
    result_of(session, **FALL)
    assert session.status("me").survival == pytest.approx(50 / 60)


def test_the_status_tells_the_states_of_the_memory():
    session = learned_session()
    figures = session.status("me").figures
    assert figures == session.learner.figures()
    assert figures["basis_states"] > 0


def test_the_status_tells_both_hashes():
    session = learned_session()
    status = session.status("me")
    assert (status.memory_sha256, status.trajectory_sha256) == (
        session.memory_sha256(),
        session.tally.trajectories_sha256,
    )


@pytest.mark.parametrize(
    "made, complete, learned",
    [
        (new_session, False, False),
        (with_schedule_complete, True, False),
        (learned_session, True, True),
    ],
)
def test_the_status_tells_what_is_learned(made, complete, learned):
    status = made().status("me")
    assert (status.schedule_complete, status.learned) == (complete, learned)


def test_the_status_tells_that_a_session_is_frozen():
    assert frozen_session().status("me").frozen


def test_the_status_goes_over_the_wire():
    status = learned_session().status("me")
    assert decode(LearnerStatus, encode(status)) == status
