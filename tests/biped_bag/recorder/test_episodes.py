"""Each walk's record: its result, and the status that the learner sent with it."""

import pytest
from msgspec.structs import replace
from tests.payloads import RESULT, STATUS

from biped_bag.recorder.episodes import EpisodeRecords
from biped_bag.storage.contents import BagMessage
from biped_ros.cdr import string_message
from msgs_json import topics
from msgs_json.wire import encode


def opening(at_ns):
    """Return the first observation of a walk, of which only the tick is looked at."""
    text = string_message('{"version": 1, "control_tick": 0}')
    return BagMessage(topics.OBSERVATION.name, text, at_ns, at_ns)


def result(at_ns):
    """Return the result of a walk."""
    payload = replace(RESULT, episode=4, trajectory_sha256="walk")
    text = string_message(encode(payload))
    return BagMessage(topics.EPISODE.name, text, at_ns + 5, at_ns)


def status(sent_ns, received_ns, memory):
    """Return a status of the learner."""
    payload = replace(
        STATUS, episodes=3, memory_sha256=memory, trajectory_sha256="chain"
    )
    text = string_message(encode(payload))
    return BagMessage(topics.LEARNER_STATUS.name, text, received_ns, sent_ns)


def recorded(messages):
    """Return the record after all of these messages have come."""
    records = EpisodeRecords()
    records.hear(messages)
    records.follow(messages)
    return records.record()


def test_a_walk_lies_between_its_first_observation_and_its_result():
    record = recorded([opening(100), result(900)])
    assert (record["first_log_time"], record["last_log_time"]) == ("100", "905")


def test_the_result_is_told():
    record = recorded([opening(100), result(900)])
    assert record["end_cause"] == "completed"
    assert record["control_ticks"] == "940"
    assert float(record["T_err"]) == 1.96875


def test_the_status_is_the_last_one_sent_before_the_result():
    heard = [status(100, 101, "before"), status(890, 895, "after"), result(900)]
    assert recorded([*heard, status(950, 951, "next")])["memory_sha256"] == "after"


def test_a_status_that_was_overtaken_by_the_result_still_counts():
    heard = [status(100, 101, "before"), result(900), status(890, 960, "after")]
    assert recorded(heard)["memory_sha256"] == "after"


def test_following_stops_behind_the_end_of_a_walk():
    records = EpisodeRecords()
    assert records.follow([opening(1), result(2), opening(3), result(4)]) == 2


def test_without_an_end_there_is_no_record():
    assert recorded([opening(100)]) is None


@pytest.mark.parametrize("topic", [topics.EPISODE, topics.OBSERVATION])
def test_what_is_no_payload_ends_nothing(topic):
    nonsense = BagMessage(topic.name, string_message("{"), 1, 1)
    assert recorded([nonsense]) is None
