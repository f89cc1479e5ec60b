"""Bags as others read them: rosbags, mcap-ros2-support, and after a bad end."""

import subprocess
import sys

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from tests.biped_bag.bags import LATCHED, memory, messages_to_the_end

from biped_bag.errors import BagError
from biped_bag.storage.contents import BagMessage, BagTopic
from biped_bag.storage.layout import fresh_folder
from biped_bag.storage.metadata import FILE_NAME, read_metadata
from biped_bag.storage.reader import BagReader
from biped_bag.storage.writer import BagWriter
from biped_ros.cdr import string_message

STRING = "std_msgs/msg/String"
FAR_PAST_NS = 1_700_000_000_000_000_000


def message(topic, number):
    """Return the message of this number on a topic."""
    at_ns = FAR_PAST_NS + 1000 * number
    text = string_message(f"{topic} {number}")
    return BagMessage(topic, text, at_ns, at_ns - 10, number)


def written(folder, count=300, **options):
    """Write a bag: one message of /latched, then `count` of /fast."""
    writer = BagWriter(folder, **options)
    writer.add_topic(BagTopic("/latched", STRING, [LATCHED]))
    writer.add_topic(BagTopic("/fast", STRING))
    writer.write(message("/latched", 1))
    for number in range(2, count + 2):
        writer.write(message("/fast", number))
    return writer


def test_rosbags_reads_every_message_as_it_was_written(tmp_path):
    written(tmp_path / "bag").close()
    expected = [message("/latched", 1), *(message("/fast", n) for n in range(2, 302))]
    with Reader(tmp_path / "bag") as reader:
        read = [(c.topic, at, bytes(data)) for c, at, data in reader.messages()]
    assert read == [(m.topic, m.log_ns, m.data) for m in expected]


def test_mcap_ros2_decodes_every_message(tmp_path):
    written(tmp_path / "bag").close()
    with (tmp_path / "bag/bag_0.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        texts = [text.data for *_, text in reader.iter_decoded_messages()]
    assert texts == ["/latched 1", *(f"/fast {n}" for n in range(2, 302))]


def test_metadata_counts_what_is_in_the_files(tmp_path):
    written(tmp_path / "bag", max_file_bytes=2000).close()
    metadata = read_metadata(tmp_path / "bag")
    for info in metadata.files:
        with (tmp_path / "bag" / info.path).open("rb") as file:
            statistics = make_reader(file).get_summary().statistics
        assert statistics.message_count == info.message_count
        assert statistics.message_start_time == info.start_ns
        assert statistics.message_end_time == info.end_ns


def test_a_full_file_is_followed_by_another(tmp_path):
    # Chunks are compressed and written when they are full.
    written(tmp_path / "bag", count=5000, max_file_bytes=20_000).close()
    files = sorted((tmp_path / "bag").glob("*.mcap"))
    assert len(files) > 1
    assert [file.path for file in read_metadata(tmp_path / "bag").files] == [
        file.name for file in files
    ]


def test_every_file_alone_begins_with_what_is_latched(tmp_path):
    writer = written(tmp_path / "bag")
    writer.split(FAR_PAST_NS + 10**9)
    writer.write(message("/fast", 2_000_000))
    writer.close()
    with Reader(tmp_path / "bag/bag_1.mcap") as reader:
        read = [(c.topic, at, bytes(data)) for c, at, data in reader.messages()]
    assert read[0] == (
        "/latched",
        FAR_PAST_NS + 10**9,
        string_message("/latched 1"),
    )


def test_what_is_repeated_is_counted_apart(tmp_path):
    writer = written(tmp_path / "bag")
    writer.split(FAR_PAST_NS + 10**9)
    writer.close()
    assert writer.repeated == {"/latched": 1}
    assert writer.metadata.message_count == 302


def test_records_and_attachments_are_found_by_the_index(tmp_path):
    writer = written(tmp_path / "bag", records={"run": {"seed": "7"}})
    writer.add_record("end", {"lost": "0"})
    writer.attach(memory(b"abc"))
    writer.close()
    with (tmp_path / "bag/bag_0.mcap").open("rb") as file:
        reader = make_reader(file)
        records = {record.name: record.metadata for record in reader.iter_metadata()}
        attachments = [(a.name, a.data) for a in reader.iter_attachments()]
    assert records["run"] == {"seed": "7"}
    assert records["end"] == {"lost": "0"}
    assert attachments == [("memory.npz", b"abc")]


def test_a_bag_that_was_begun_has_metadata(tmp_path):
    BagWriter(tmp_path / "bag")
    assert read_metadata(tmp_path / "bag").files[0].path == "bag_0.mcap"


def test_a_next_file_that_cannot_be_made_leaves_the_one_before_it_whole(tmp_path):
    writer = written(tmp_path / "bag")
    (tmp_path / "bag/bag_1.mcap").touch()
    with pytest.raises(BagError, match="File exists"):
        writer.split(FAR_PAST_NS + 10**9)
    writer.close()
    assert BagReader(tmp_path / "bag/bag_0.mcap").message_count == 301
    assert read_metadata(tmp_path / "bag").message_count == 301


def test_what_was_flushed_is_there_without_an_end(tmp_path):
    writer = written(tmp_path / "bag")
    writer.flush()
    assert len(messages_to_the_end(tmp_path / "bag/bag_0.mcap")) == 301


def test_a_bag_is_never_overwritten(tmp_path):
    written(tmp_path / "bag").close()
    before = (tmp_path / "bag/bag_0.mcap").read_bytes()
    with pytest.raises(BagError, match="holds a bag already"):
        BagWriter(tmp_path / "bag")
    assert (tmp_path / "bag/bag_0.mcap").read_bytes() == before


def test_a_bag_of_which_only_the_data_are_left_is_not_overwritten_either(tmp_path):
    written(tmp_path / "bag").close()
    (tmp_path / "bag" / FILE_NAME).unlink()
    with pytest.raises(BagError, match="holds a bag already"):
        BagWriter(tmp_path / "bag")


def test_the_next_free_name_is_found(tmp_path):
    for name in ("bag", "bag_2"):
        written(tmp_path / name).close()
    assert fresh_folder(tmp_path / "bag") == tmp_path / "bag_3"


def test_an_empty_folder_can_become_a_bag(tmp_path):
    (tmp_path / "bag").mkdir()
    assert fresh_folder(tmp_path / "bag") == tmp_path / "bag"
    written(tmp_path / "bag").close()
    assert read_metadata(tmp_path / "bag").message_count == 301


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(BagError, match="Not a directory") as refusal:
        BagWriter(tmp_path / "file/bag")
    assert str(tmp_path / "file/bag") in str(refusal.value)


DISK_FULL = """
import os, resource, sys
from pathlib import Path
from biped_bag.errors import BagError
from biped_bag.storage.contents import BagMessage, BagTopic
from biped_bag.storage.writer import BagWriter

writer = BagWriter(Path(sys.argv[1]))
writer.add_topic(BagTopic("/noise", "std_msgs/msg/String"))
resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, 300_000))
try:
    for number in range(1, 10_000):
        noise = os.urandom(1000)
        writer.write(BagMessage("/noise", noise, number, number, number))
        if number % 50 == 0:
            writer.flush()
except BagError as error:
    print(error)
writer.close()
"""


@pytest.fixture(scope="module")
def full(tmp_path_factory):
    """Return folder and last words of a bag on a file system that takes no more."""
    folder = tmp_path_factory.mktemp("full") / "bag"
    done = subprocess.run(
        [sys.executable, "-c", DISK_FULL, str(folder)],
        capture_output=True,
        text=True,
        check=True,
        timeout=60.0,
    )
    return folder, done.stdout


def test_a_full_disk_is_an_error_that_names_the_bag(full):
    folder, said = full
    assert said == f"{folder}: File too large\n"


def test_a_bag_on_a_full_disk_ends_with_the_last_flush(full):
    folder, _ = full
    sequences = [
        message.sequence for message in messages_to_the_end(folder / "bag_0.mcap")
    ]
    assert sequences == list(range(1, len(sequences) + 1))
    assert len(sequences) % 50 == 0
    assert sequences


def test_metadata_of_a_bag_on_a_full_disk_counts_what_is_in_it(full):
    folder, _ = full
    in_file = len(messages_to_the_end(folder / "bag_0.mcap"))
    assert read_metadata(folder).message_count == in_file
    assert read_metadata(folder).topics[0].count == in_file
