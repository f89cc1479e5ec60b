"""Bags are read as they were written; what is not whole is refused in one line."""

import pytest
from tests.biped_bag.bags import (
    START_NS,
    TICK_NS,
    control_tick,
    record,
)

from biped_bag.errors import BagError
from biped_bag.storage.reader import BagReader
from msgs_json import topics

CLOCK = topics.CLOCK.name


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    """Folder and messages of a bag of several files."""
    folder = tmp_path_factory.mktemp("bags") / "bag"
    messages = record(folder, ticks=300, max_file_bytes=20_000, attachment=b"memory")
    return folder, messages


def test_all_messages_come_with_their_times_and_numbers(tmp_path):
    messages = record(tmp_path / "bag", ticks=100)
    read = list(BagReader(tmp_path / "bag").messages())
    assert sorted(read) == sorted(messages)


def test_messages_of_several_files_come_in_the_order_of_their_log_times(bag):
    reader = BagReader(bag[0])
    times = [message.log_ns for message in reader.messages()]
    assert len(reader.files) > 1
    assert times == sorted(times)


def test_topics_are_counted_over_all_files(bag):
    reader = BagReader(bag[0])
    assert reader.topics[CLOCK].count == 300
    assert reader.topics[CLOCK].type_name == "rosgraph_msgs/msg/Clock"


def test_a_stretch_starts_at_its_start_and_ends_before_its_end(bag):
    start, end = START_NS + 100 * TICK_NS, START_NS + 110 * TICK_NS
    read = list(BagReader(bag[0]).messages([CLOCK], start, end))
    assert [m.data for m in read] == [control_tick(t)[0].data for t in range(100, 110)]


def test_latched_topics_are_told_from_the_others(bag):
    reader = BagReader(bag[0])
    assert reader.topics[topics.ROBOT_DESCRIPTION.name].latched
    assert not reader.topics[CLOCK].latched


def test_records_and_attachments_are_read(bag):
    reader = BagReader(bag[0])
    run = next(reader.records("biped.run"))
    assert run.metadata == {"seed": "7", "preset": "quick"}
    assert [a.data for a in reader.attachments()] == [b"memory"]


def test_a_single_file_is_a_bag_too(bag):
    reader = BagReader(sorted(bag[0].glob("*.mcap"))[1])
    assert 0 < reader.topics[CLOCK].count < 300


@pytest.fixture
def broken(tmp_path):
    """A bag of one file, to be broken."""
    record(tmp_path / "bag", ticks=100)
    return tmp_path / "bag"


def test_a_bag_without_metadata_is_sent_to_recover(broken):
    (broken / "metadata.yaml").unlink()
    with pytest.raises(BagError, match=r"no metadata\.yaml.*`biped bag recover"):
        BagReader(broken)


def test_metadata_that_are_at_odds_with_the_data_are_refused(broken):
    file = broken / "metadata.yaml"
    file.write_text(file.read_text().replace("message_count: 100", "message_count: 99"))
    with pytest.raises(BagError, match=r"tells of 99 messages on .* hold 100"):
        BagReader(broken)


def test_another_distribution_than_the_data_tell_of_is_refused(broken):
    file = broken / "metadata.yaml"
    file.write_text(file.read_text().replace("jazzy", "jazzx"))
    with pytest.raises(BagError, match="tells of ROS 'jazzx', but the data of 'jazzy'"):
        BagReader(broken)


def test_a_file_that_metadata_do_not_name_is_refused(broken):
    (broken / "bag_1.mcap").write_bytes((broken / "bag_0.mcap").read_bytes())
    with pytest.raises(BagError, match="does not list the files"):
        BagReader(broken)


@pytest.mark.parametrize("share", [0.01, 0.1, 0.5, 0.9, 0.99])
def test_a_bag_that_was_cut_off_is_sent_to_recover(broken, share):
    file = broken / "bag_0.mcap"
    content = file.read_bytes()
    file.write_bytes(content[: int(share * len(content))])
    with pytest.raises(BagError, match=r"cut off.*`biped bag recover .*bag OUT`"):
        BagReader(broken)


def test_any_byte_that_is_flipped_is_noticed(broken):
    file = broken / "bag_0.mcap"
    content = bytearray(file.read_bytes())
    for at in range(8, len(content), len(content) // 100):
        content[at] ^= 0x04
        file.write_bytes(content)
        content[at] ^= 0x04
        with pytest.raises(BagError, match=r"damaged.*biped bag recover|cut off"):
            BagReader(broken)
