"""metadata.yaml: what rosbag2 reads, and nothing lost on the way."""

import pytest
import yaml
from tests.biped_bag.bags import RELIABLE

from biped_bag.errors import BagError
from biped_bag.storage.contents import BagTopic
from biped_bag.storage.metadata import (
    FILE_NAME,
    BagMetadata,
    FileInfo,
    metadata_text,
    read_metadata,
    write_metadata,
)


def a_bag():
    """Return metadata of a bag of two files."""
    return BagMetadata(
        topics=[
            BagTopic(
                "/a", "std_msgs/msg/String", (RELIABLE, RELIABLE), "RIHS01_1", count=3
            ),
            BagTopic("/b", "std_msgs/msg/String"),
        ],
        files=[
            FileInfo("bag_0.mcap", 100, 300, 2),
            FileInfo("bag_1.mcap", 400, 400, 1),
        ],
        custom={"state": "complete"},
    )


def test_what_was_written_is_read_again(tmp_path):
    write_metadata(tmp_path, a_bag())
    assert read_metadata(tmp_path) == a_bag()


def test_the_bag_lasts_from_its_first_message_to_its_last(tmp_path):
    content = yaml.safe_load(metadata_text(a_bag(), with_root=False))
    assert content["starting_time"] == {"nanoseconds_since_epoch": 100}
    assert content["duration"] == {"nanoseconds": 300}
    assert content["message_count"] == 3


def test_equal_values_are_written_out_without_anchors():
    assert "&" not in metadata_text(a_bag())


def test_a_bag_without_messages_has_no_duration():
    metadata = BagMetadata(files=[FileInfo("bag_0.mcap")])
    assert (metadata.start_ns, metadata.end_ns, metadata.message_count) == (0, 0, 0)


@pytest.mark.parametrize(
    "text", ["", "[]", "a: 1", "rosbag2_bagfile_information: 3", "{", "\x00"]
)
def test_what_is_no_metadata_is_refused_in_one_line(tmp_path, text):
    (tmp_path / FILE_NAME).write_text(text)
    with pytest.raises(BagError, match="is no metadata of a bag") as refusal:
        read_metadata(tmp_path)
    assert "\n" not in str(refusal.value)


def test_a_folder_without_metadata_is_named(tmp_path):
    with pytest.raises(BagError, match=r"metadata\.yaml: cannot be read"):
        read_metadata(tmp_path)
