"""A bag written by a thread: in order, and with its reason where it ends early."""

from tests.biped_bag.bags import START_NS

from biped_bag.recorder.writer_thread import WriterThread
from biped_bag.storage.contents import BagMessage, BagTopic
from biped_bag.storage.metadata import read_metadata
from biped_bag.storage.writer import BagWriter
from biped_ros.cdr import string_message

STRING = "std_msgs/msg/String"


def message(topic, number):
    at_ns = START_NS + number
    return BagMessage(topic, string_message(f"{number}"), at_ns, at_ns, number)


def test_a_recording_writes_in_the_order_of_what_was_put_in(tmp_path):
    recording = WriterThread(BagWriter(tmp_path / "bag"))
    recording.do(lambda bag: bag.add_topic(BagTopic("/fast", STRING)))
    recording.put([message("/fast", 1), message("/fast", 2)])
    recording.do(lambda bag: bag.split(START_NS))
    recording.put([message("/fast", 3)])
    recording.close({"state": "complete"})
    metadata = read_metadata(tmp_path / "bag")
    assert [file.message_count for file in metadata.files] == [2, 1]
    assert metadata.custom == {"state": "complete"}


def test_a_recording_says_why_it_has_ended(tmp_path):
    recording = WriterThread(BagWriter(tmp_path / "bag"))
    recording.do(lambda bag: bag.add_topic(BagTopic("/x", "nobody_msgs/msg/Nothing")))
    recording.close({})
    assert "no installed package defines this message" in str(recording.error)
