"""Sessions of a learner for short walks, and walks that they walk."""

import json

from tests.learner_node.walking.observations import observation, ticks_until
from tests.learner_node.walking.small_settings import SETTINGS

from learner_node.walking.session import LearningSession
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult

# Two subtasks of 3 and 5 learning ticks.
WALK_TICKS = 50
SCHEDULE_EPISODES = 4
FALL = {"end": 20, "cause": EndCause.ZMP_ERROR}


def new_session(seed=0):
    return LearningSession(SETTINGS, WALK_TICKS, seed)


def begin(session, sha=""):
    return session.respond(observation(0, trajectory_sha256=sha))


def walk(session, end=WALK_TICKS, cause=None, t_err=2.0, sha="walked"):
    """Walk until there is a result, at `end` at the latest; return all answers."""
    answers = []
    for tick in ticks_until(end):
        answers.append(
            session.respond(
                observation(
                    tick,
                    waist_in_support_foot_m=(float(tick), 0.0),
                    # 10 times the mean joint error is a term of T_err.
                    mean_joint_error_rad=t_err / 10.0,
                    trajectory_sha256=sha,
                    end_cause=cause if tick == end else None,
                )
            )
        )
        if isinstance(answers[-1], EpisodeResult):
            return answers
    raise AssertionError("no result at the end of the walk")


def result_of(session, **changes):
    return walk(session, **changes)[-1]


def state_of(session):
    """All that a checkpoint holds, to compare."""
    arrays = {name: a.tolist() for name, a in session.arrays().items()}
    return json.dumps([session.header(), arrays])


def with_schedule_complete():
    session = new_session()
    for _ in range(SCHEDULE_EPISODES):
        result_of(session)
    return session


def learned_session():
    session = with_schedule_complete()
    result_of(session)
    return session


def copy_of(session):
    """A session restored from what a checkpoint keeps of another."""
    copy = new_session(seed=9)
    header = json.loads(json.dumps(session.header()))
    copy.restore(header, {k: v.copy() for k, v in session.arrays().items()})
    return copy


def with_mixed_walks(walks, trial_fails=True):
    """A session after so many walks, some of which fail."""
    session = new_session()
    for number in range(walks):
        fails = number % 3 == 1 or (session.trial_due and trial_fails)
        result_of(session, **(FALL if fails else {}))
    return session


def frozen_session():
    session = new_session()
    result_of(session)
    session.frozen = True
    return session
