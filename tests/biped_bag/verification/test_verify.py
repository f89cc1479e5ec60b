"""A learner that hears a recorded run again answers as recorded, to the last bit."""

import msgspec
import numpy as np
import pytest
from tests.biped_bag.verification.recorded_run import RecordedRun

from biped_bag.verification.cost import FROM_OBSERVATIONS, FROM_TOPICS
from biped_bag.verification.report import Verdict
from biped_bag.verification.verify import verify
from biped_bag.verification.walks import WANTED, ImpossibleWalkError
from biped_bringup.run_settings import load_settings
from biped_ros.cdr import string_message, string_text
from biped_ros.messages import correction_of, correction_template
from learner_node.walking.session import LearningSession
from msgs_json import topics
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation
from msgs_json.wire import decode, encode

SEED = 5
WALKS = 5


@pytest.fixture(scope="module")
def run():
    run = RecordedRun(load_settings("quick"), SEED)
    run.walk(WALKS)
    yield run
    run.close()


@pytest.fixture
def messages(run):
    return list(run.messages)


def places(messages, topic):
    """Return where the messages of a topic stand."""
    return [i for i, (name, _) in enumerate(messages) if name == topic.name]


def from_walk(messages, number):
    """Return the messages from the first observation of a walk on."""
    for i in places(messages, topics.OBSERVATION):
        if decode(Observation, string_text(messages[i][1])).episode == number:
            return messages[i:]
    raise AssertionError(f"no walk {number}")


def status_of(name, message, **changes):
    """Return a status in another learner's name."""
    status = decode(LearnerStatus, string_text(message[1]))
    changed = msgspec.structs.replace(status, instance=name, **changes)
    return topics.LEARNER_STATUS.name, string_message(encode(changed))


def change_correction(messages, place, change):
    """Replace a correction."""
    _, clock_ticks, value_m = correction_of(messages[place][1])
    message = correction_template().fill(change(value_m), clock_ticks)
    messages[place] = (topics.CORRECTION.name, message)


def test_every_correction_comes_out_again(run, messages):
    found = verify(run.new_session(), messages)
    assert found.verdict is Verdict.VERIFIED
    assert found.corrections == len(places(messages, topics.CORRECTION))


def test_one_bit_of_one_correction_is_found(run, messages):
    place = places(messages, topics.CORRECTION)[200]
    _, clock_ticks, _ = correction_of(messages[place][1])
    change_correction(
        messages, place, lambda value_m: [np.nextafter(value_m[0], 1.0), value_m[1]]
    )
    found = verify(run.new_session(), messages)
    assert found.differences == 1
    (wrong,) = (w.first_difference for w in found.walks if w.first_difference)
    assert wrong.clock_ticks == clock_ticks


def test_a_negative_zero_is_not_a_zero(run, messages):
    for place in places(messages, topics.CORRECTION):
        value_m = correction_of(messages[place][1])[2]
        if value_m[0] == 0.0:
            break
    change_correction(messages, place, lambda value_m: [-value_m[0], value_m[1]])
    assert verify(run.new_session(), messages).differences == 1


def test_a_missing_observation_is_found(run, messages):
    place = places(messages, topics.OBSERVATION)[200]
    missing = decode(Observation, string_text(messages.pop(place)[1]))
    found = verify(run.new_session(), messages)
    first = next(walk for walk in found.walks if walk.differences)
    assert first.episode == missing.episode
    assert first.first_difference.control_tick == missing.control_tick
    assert first.first_difference.what == "observation"


def test_after_a_missing_observation_nothing_is_claimed(run, messages):
    del messages[places(messages, topics.OBSERVATION)[20]]
    found = verify(run.new_session(), messages)
    assert all(walk.not_checked for walk in found.walks)
    assert sum(walk.identical for walk in found.walks[1:]) == 0


def test_a_missing_last_observation_of_a_walk_is_found(run, messages):
    results = places(messages, topics.EPISODE)
    before = [i for i in places(messages, topics.OBSERVATION) if i < results[2]]
    del messages[before[-1]]
    found = verify(run.new_session(), messages)
    assert [walk.episode for walk in found.walks if walk.differences] == [3]


def test_a_missing_correction_is_found(run, messages):
    del messages[places(messages, topics.CORRECTION)[200]]
    found = verify(run.new_session(), messages)
    assert found.differences == 1
    assert found.verdict is Verdict.NOT_VERIFIED


@pytest.mark.parametrize(
    ("value_m", "ticks_later"),
    [
        ([0.0, 0.0], 1),
        ([0.001, 0.0], 0),
        ([np.nan, 0.0], 0),
        ([0.0, -np.inf], 0),
        ([1.0, 0.0], 0),
    ],
    ids=["for no observation", "beside", "no number", "endless", "out of range"],
)
@pytest.mark.parametrize("before", [True, False])
def test_a_correction_that_is_refused_is_no_difference(
    run, messages, value_m, ticks_later, before
):
    place = places(messages, topics.CORRECTION)[200]
    _, clock_ticks, _ = correction_of(messages[place][1])
    extra = correction_template().fill(value_m, clock_ticks + ticks_later)
    messages.insert(place + (not before), (topics.CORRECTION.name, extra))
    found = verify(run.new_session(), messages)
    assert found.verdict is Verdict.VERIFIED
    assert sum(walk.refused for walk in found.walks) == 1


def test_a_correction_of_a_walk_that_is_over_is_refused(run, messages):
    end = places(messages, topics.EPISODE)[2]
    last = max(i for i in places(messages, topics.OBSERVATION) if i < end)
    clock_ticks = decode(Observation, string_text(messages[last][1])).clock_ticks
    extra = correction_template().fill([0.0, 0.0], clock_ticks)
    messages.insert(end, (topics.CORRECTION.name, extra))
    assert verify(run.new_session(), messages).verdict is Verdict.VERIFIED


def test_a_changed_result_is_found(run, messages):
    place = places(messages, topics.EPISODE)[3]
    result = decode(EpisodeResult, string_text(messages[place][1]))
    changed = msgspec.structs.replace(result, reward=result.reward + 1.0)
    messages[place] = (topics.EPISODE.name, string_message(encode(changed)))
    found = verify(run.new_session(), messages)
    assert [walk.episode for walk in found.walks if walk.differences] == [4]


def test_another_seed_is_no_match(run, messages):
    settings = run.settings.learner
    other = LearningSession(settings, run.new_session().walk_ticks, SEED + 1)
    assert verify(other, messages).verdict is Verdict.NOT_VERIFIED


def test_of_the_middle_of_a_run_nothing_is_claimed(run, messages):
    found = verify(run.new_session(), from_walk(messages, 3))
    assert found.identical == 0
    assert found.differences == 0
    assert "the bag begins, walk 3" in found.walks[0].not_checked


def test_of_a_bag_without_a_walk_in_its_middle_only_the_first_part_is_checked(
    run, messages
):
    third = len(messages) - len(from_walk(messages, 3))
    rest = from_walk(messages, 4)
    found = verify(run.new_session(), messages[:third] + rest)
    assert [walk.not_checked is None for walk in found.walks] == [True, True] + [
        False
    ] * (WALKS - 3)


def test_a_recording_that_ends_in_a_walk_is_checked_to_its_end(run, messages):
    end = places(messages, topics.OBSERVATION)[250] + 1
    found = verify(run.new_session(), messages[:end])
    assert 0 < found.corrections == found.identical


def test_a_walk_without_its_end_is_verified_only_as_far_as_recorded(run, messages):
    end = places(messages, topics.OBSERVATION)[250] + 1
    found = verify(run.new_session(), messages[:end])
    assert found.verdict is Verdict.AS_FAR_AS_RECORDED


def test_a_difference_in_a_walk_without_its_end_is_still_one(run, messages):
    place = places(messages, topics.CORRECTION)[240]
    change_correction(messages, place, lambda value_m: value_m + 1e-12)
    end = places(messages, topics.OBSERVATION)[250] + 1
    found = verify(run.new_session(), messages[:end])
    assert found.verdict is Verdict.NOT_VERIFIED


def test_a_walk_that_was_only_offered_lacks_nothing(run, messages):
    results = places(messages, topics.EPISODE)
    offered = next(i for i in places(messages, topics.OBSERVATION) if i > results[2])
    found = verify(run.new_session(), messages[: offered + 1])
    assert found.walks[-1].corrections == 0
    assert found.verdict is Verdict.VERIFIED


def test_a_learner_that_was_started_again_is_not_followed(run, messages):
    for place in places(messages, topics.LEARNER_STATUS)[2:]:
        messages[place] = status_of("learner-2", messages[place])
    found = verify(run.new_session(), messages)
    assert "started again" in found.walks[-1].not_checked
    assert found.verdict is Verdict.NOT_VERIFIED


@pytest.mark.parametrize("name", ["a-stranger", "stranger"])
@pytest.mark.parametrize("place", [0, 3])
def test_a_stranger_s_status_is_no_restart(run, messages, name, place):
    at = places(messages, topics.LEARNER_STATUS)[place]
    for where in (at + 1, at):
        messages.insert(where, status_of(name, messages[at], episodes=77, frozen=True))
    assert verify(run.new_session(), messages).verdict is Verdict.VERIFIED


def test_a_stranger_s_result_is_no_difference(run, messages):
    for place in reversed(places(messages, topics.EPISODE)):
        result = decode(EpisodeResult, string_text(messages[place][1]))
        false = msgspec.structs.replace(
            result, learning=False, reward=1.0, trajectory_sha256=""
        )
        text = string_message(encode(false))
        messages.insert(place, (topics.EPISODE.name, text))
    assert verify(run.new_session(), messages).verdict is Verdict.VERIFIED


def test_topics_may_be_recorded_out_of_step(run, messages):
    """Each topic keeps its order, but some come up to 30 messages late."""
    late = {topics.CORRECTION.name: 30, topics.ZMP.name: 17, topics.EPISODE.name: 5}
    order = sorted(
        range(len(messages)), key=lambda i: (i + late.get(messages[i][0], 0), i)
    )
    found = verify(run.new_session(), [messages[i] for i in order])
    assert found.verdict is Verdict.VERIFIED
    assert all(walk.cost.source == FROM_TOPICS for walk in found.walks)


def test_the_cost_of_each_walk_is_that_of_its_topics(run, messages):
    found = verify(run.new_session(), messages)
    for walk in found.walks:
        assert walk.cost.t_err_recomputed == pytest.approx(
            walk.cost.t_err_recorded, rel=1e-12
        )
        assert walk.cost.zmp_error_deviation_m == 0.0


def test_a_changed_zmp_shows_in_the_cost(run, messages):
    place = places(messages, topics.ZMP)[100]
    message = bytearray(messages[place][1])
    message[-17] ^= 0x10  # in y's exponent or first digits
    messages[place] = (topics.ZMP.name, bytes(message))
    found = verify(run.new_session(), messages)
    assert found.walks[0].cost.t_err_deviation > 1e-6


def test_thinned_topics_leave_the_observations_to_be_added_up(run, messages):
    del messages[places(messages, topics.JOINT_STATES)[100]]
    found = verify(run.new_session(), messages)
    assert found.walks[0].cost.source == FROM_OBSERVATIONS
    assert found.walks[0].cost.t_err_deviation < 1e-12


JUNK = {
    "no text": b"\0\1\0\0nothing",
    "nothing": b"",
    "no JSON": string_message("{"),
    "deep brackets": string_message("[" * 90_000),
    "another version": string_message('{"version": 99}'),
    "half a letter": b"\0\1\0\0\2\0\0\0\xff\0",
}


def test_messages_that_no_node_understands_are_passed_over(run, messages):
    for place in (len(messages), 300, 0):
        for topic in WANTED:
            messages[place:place] = [(topic, junk) for junk in JUNK.values()]
    found = verify(run.new_session(), messages)
    assert found.verdict is Verdict.VERIFIED
    assert found.not_understood == dict.fromkeys(WANTED, 3 * len(JUNK))


def test_numbers_that_no_walk_has_are_refused(run, messages):
    place = places(messages, topics.OBSERVATION)[20]
    observation = decode(Observation, string_text(messages[place][1]))
    false = msgspec.structs.replace(observation, torque_integral_n2m2_s=-1e9)
    messages[place] = (topics.OBSERVATION.name, string_message(encode(false)))
    with pytest.raises(ImpossibleWalkError, match=r"^walk 1: "):
        verify(run.new_session(), messages)


@pytest.mark.parametrize("cause", [c for c in EndCause if c.from_outside])
@pytest.mark.parametrize("answered", [True, False])
@pytest.mark.thorough
def test_a_walk_that_was_given_up_is_no_difference(cause, answered):
    given_up = RecordedRun(load_settings("quick"), SEED)
    given_up.walk(1)
    given_up.give_up(cause, observations=20, answered=answered)
    given_up.walk(2)
    found = verify(given_up.new_session(), given_up.messages)
    given_up.close()
    assert found.verdict is Verdict.VERIFIED
    assert [walk.differences for walk in found.walks] == [0] * 4


def test_after_a_walk_given_up_without_a_result_nothing_is_claimed(run):
    given_up = RecordedRun(load_settings("quick"), SEED)
    given_up.give_up(EndCause.PEER_SILENT, observations=20, answered=True)
    del given_up.messages[places(given_up.messages, topics.EPISODE)[0]]
    given_up.walk(1)
    found = verify(given_up.new_session(), given_up.messages)
    given_up.close()
    assert found.differences == 0
    assert "the learner's result of walk 1" in found.walks[1].not_checked


def test_frozen_walks_are_checked_greedily(run):
    frozen = RecordedRun(load_settings("quick"), SEED)
    frozen.walk(3)
    frozen.session.frozen = True
    frozen.walk(2)
    found = verify(frozen.new_session(), frozen.messages)
    frozen.close()
    assert found.verdict is Verdict.VERIFIED
    assert [walk.learning for walk in found.walks] == [True] * 3 + [False] * 2


def test_the_middle_of_a_frozen_run_can_be_checked():
    frozen = RecordedRun(load_settings("quick"), SEED, frozen=True)
    frozen.walk(3)
    status, rest = frozen.messages[:1], from_walk(frozen.messages, 2)
    found = verify(frozen.new_session(), status + rest)
    frozen.close()
    assert found.verdict is Verdict.VERIFIED


def test_the_run_of_another_learner_is_verified_alike():
    settings = load_settings("quick", changes=["learner.method=q_lambda"])
    other = RecordedRun(settings, SEED)
    other.walk(WALKS)
    found = verify(other.new_session(), other.messages)
    other.close()
    assert found.verdict is Verdict.VERIFIED
    assert [walk.learning for walk in found.walks] == [True] * WALKS
