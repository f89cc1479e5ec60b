"""Broken bags: what is whole comes back, and what is lost is counted to the message."""

import mmap
import struct
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.opcode import Opcode
from mcap.records import Message
from rosbags.highlevel import AnyReader
from tests.biped_bag.bags import (
    LATCHED,
    RELIABLE,
    START_NS,
    TICK_NS,
    control_tick,
    record,
    robot_description,
)

from biped_bag.errors import BagError
from biped_bag.recovery.recover import RecoveryFailedError, recover
from biped_bag.recovery.scan import WholeChunk, scan
from biped_bag.storage.contents import BagTopic
from biped_bag.storage.integrity import RECORD_HEADER, file_end, mapped
from biped_bag.storage.reader import BagReader
from biped_bag.storage.writer import BagWriter
from msgs_json import topics

TICKS = 300
PER_TICK = 2
CLOCK = topics.CLOCK.name


@dataclass(frozen=True)
class Original:
    """A sound file, and where its records are."""

    content: bytes
    messages: list
    chunks: list[tuple[int, int, int]]
    """Begin and end of each chunk, and how many messages it holds."""
    records: list[tuple[int, int, int]]
    """Opcode, begin and end of every record up to the end of the data."""
    data_end_at: int

    def chunk_messages(self, number):
        """Messages of a chunk."""
        first = sum(count for _, _, count in self.chunks[:number])
        return self.messages[first : first + self.chunks[number][2]]


def messages_in(chunk):
    """How many messages a chunk holds."""
    return sum(isinstance(record, Message) for record in chunk.records)


@pytest.fixture(scope="module")
def original(tmp_path_factory) -> Original:
    folder = tmp_path_factory.mktemp("original") / "bag"
    messages = record(folder, ticks=TICKS, attachment=b"memory" * 50)
    file = folder / "bag_0.mcap"
    content = file.read_bytes()
    with mapped(file) as opened:
        end = file_end(file, opened).data_end_at
        held = [
            messages_in(found)
            for found in scan(opened, end)
            if isinstance(found, WholeChunk)
        ]
    records, at = [], 8
    while at < end:
        opcode, length = RECORD_HEADER.unpack_from(content, at)
        records.append((opcode, at, at + RECORD_HEADER.size + length))
        at = records[-1][2]
    spans = [(begin, stop) for code, begin, stop in records if code == Opcode.CHUNK]
    chunks = [(*span, count) for span, count in zip(spans, held, strict=True)]
    return Original(content, messages, chunks, records, end)


class Case:
    """A damaged copy of the original, recovered."""

    def __init__(self, original, folder, content):
        folder.mkdir(exist_ok=True)
        number = len(list(folder.iterdir()))
        self.file = folder / f"{number}.mcap"
        self.file.write_bytes(content)
        self.out = folder / f"{number}_recovered"
        self.report = recover(self.file, self.out)
        bag = BagReader(self.out)
        self.bag = bag
        self.messages = sorted(bag.messages())
        everything = original.messages
        self.foreign = Counter(self.messages) - Counter(everything)
        lost = Counter(everything) - Counter(self.messages)
        self.lost = Counter(message.topic for message in lost.elements())


def test_a_sound_bag_comes_back_whole(tmp_path):
    messages = record(tmp_path / "bag", ticks=20, attachment=b"memory")
    report = recover(tmp_path / "bag", tmp_path / "out")
    bag = BagReader(tmp_path / "out")
    assert report.nothing_lost
    assert sorted(bag.messages()) == sorted(messages)
    assert [a.data for a in bag.attachments()] == [b"memory"]
    assert [r.metadata["seed"] for r in bag.records("biped.run")] == ["7"]


def test_topics_keep_type_definition_and_quality_of_service(tmp_path):
    record(tmp_path / "bag", ticks=1)
    recover(tmp_path / "bag", tmp_path / "out")
    assert BagReader(tmp_path / "out").topics == BagReader(tmp_path / "bag").topics


def test_the_broken_bag_is_not_changed(tmp_path):
    record(tmp_path / "bag", ticks=20)
    file = tmp_path / "bag" / "bag_0.mcap"
    file.write_bytes(file.read_bytes()[:-100])
    before = {path.name: path.read_bytes() for path in file.parent.iterdir()}
    recover(tmp_path / "bag", tmp_path / "out")
    assert {path.name: path.read_bytes() for path in file.parent.iterdir()} == before


def position(original, where):
    """A byte in the middle of a part of the file."""
    begin, end, _ = original.chunks[2]
    behind = {code: span for code, *span in original.records if span[0] >= end}
    return {
        "the end of a chunk": end,
        "a chunk's opcode": begin + 1,
        "a chunk's length": begin + 5,
        "a chunk's times": begin + 15,
        "a chunk's compression": begin + 43,
        "a chunk's data": (begin + end) // 2,
        "a message index": end + 20,
        "the data's end": original.data_end_at + 5,
        "the summary": original.data_end_at + 40,
        "the footer": len(original.content) - 20,
        "the last magic": len(original.content) - 3,
        "the last record of the run": sum(behind[Opcode.METADATA]) // 2,
    }[where]


@pytest.mark.parametrize(
    "where",
    [
        "the end of a chunk",
        "a chunk's opcode",
        "a chunk's length",
        "a chunk's times",
        "a chunk's compression",
        "a chunk's data",
        "a message index",
        "the data's end",
        "the summary",
        "the footer",
        "the last magic",
        "the last record of the run",
    ],
)
def test_a_bag_cut_off_keeps_exactly_its_complete_chunks(original, tmp_path, where):
    at = position(original, where)
    case = Case(original, tmp_path / "cases", original.content[:at])
    complete = [i for i, (_, end, _) in enumerate(original.chunks) if end <= at]
    kept = [message for i in complete for message in original.chunk_messages(i)]
    assert case.messages == sorted(kept)


@pytest.mark.parametrize("at", [1, 7, 8, 12, 30, 60])
def test_a_bag_cut_off_before_its_first_message_cannot_be_recovered(
    original, tmp_path, at
):
    file = tmp_path / "cut.mcap"
    file.write_bytes(original.content[:at])
    with pytest.raises(RecoveryFailedError):
        recover(file, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_at_whatever_byte_a_bag_is_cut_off_its_complete_chunks_are_found(original):
    size = len(original.content)
    for at in range(20, size, size // 200):
        with mmap.mmap(-1, at) as content:
            content.write(original.content[:at])
            found = [f for f in scan(content, None) if isinstance(f, WholeChunk)]
        whole = [count for _, end, count in original.chunks if end <= at]
        assert [messages_in(chunk) for chunk in found] == whole, at


def test_the_report_of_a_bag_cut_off_says_that_its_end_is_missing(original, tmp_path):
    at = position(original, "a chunk's data")
    report = Case(original, tmp_path / "cases", original.content[:at]).report
    assert not report.end_known
    assert not report.topics[CLOCK].exact
    # The torn chunk still tells until when it reached: 50 control ticks further.
    assert report.topics[CLOCK].lost_s == pytest.approx(50 * TICK_NS * 1e-9, abs=1e-6)


def test_a_bag_that_lacks_its_summary_only_has_lost_nothing(original, tmp_path):
    content = original.content[: original.data_end_at + 13]
    assert Case(original, tmp_path / "cases", content).report.nothing_lost


# Without its end and its first chunk, a bag has no definitions of topics left.
@pytest.mark.parametrize(
    ("number", "finished"), [(0, True), (2, True), (5, True), (2, False), (5, False)]
)
def test_the_loss_of_a_damaged_chunk_is_counted_to_the_message(
    original, tmp_path, number, finished
):
    begin, end, _ = original.chunks[number]
    content = bytearray(original.content)
    content[(begin + end) // 2] ^= 0x10
    content = content if finished else content[: original.data_end_at]
    case = Case(original, tmp_path / "cases", bytes(content))
    kept = set(range(len(original.chunks))) - {number}
    assert case.messages == sorted(
        [message for i in kept for message in original.chunk_messages(i)]
    )
    told = {name: topic.lost for name, topic in case.report.topics.items()}
    assert told == {name: case.lost[name] for name in told}
    assert all(topic.exact for topic in case.report.topics.values())


def test_the_time_of_a_hole_reaches_from_message_to_message(original, tmp_path):
    begin, end, _ = original.chunks[2]
    content = bytearray(original.content)
    content[(begin + end) // 2] ^= 0x10
    report = Case(original, tmp_path / "cases", bytes(content)).report
    missing = report.topics[CLOCK].lost
    assert report.topics[CLOCK].lost_s == pytest.approx((missing + 1) * TICK_NS * 1e-9)


def test_a_chunk_whose_length_is_damaged_is_recovered_by_the_other_length(
    original, tmp_path
):
    begin, _, _ = original.chunks[2]
    content = bytearray(original.content)
    content[begin + 3] ^= 0xFF
    assert not Case(original, tmp_path / "cases", bytes(content)).lost


def test_behind_a_sector_of_zeros_all_chunks_are_found_again(original, tmp_path):
    begin, _, count = original.chunks[2]
    zeros = bytes(512)
    content = original.content[:begin] + zeros + original.content[begin + 512 :]
    case = Case(original, tmp_path / "cases", content[: original.data_end_at])
    assert case.lost.total() == count
    # The message index tells how many there were.
    assert case.report.lost == count


def test_messages_are_counted_by_their_numbers_where_the_index_is_gone_too(
    original, tmp_path
):
    begin = original.chunks[2][0]
    following = original.chunks[3][0]
    content = original.content[:begin] + bytes(following - begin)
    content += original.content[following : original.data_end_at]
    case = Case(original, tmp_path / "cases", content)
    told = case.report.topics[CLOCK]
    assert (told.lost, told.exact) == (case.lost[CLOCK], True)


@pytest.mark.parametrize("of_record", [False, True])
def test_a_length_that_reaches_over_the_next_chunks_costs_none_of_them(
    original, tmp_path, of_record
):
    begin, end, _ = original.chunks[0]
    content = bytearray(original.content)
    named = begin + RECORD_HEADER.size + 28  # behind times, size and checksum
    (name_bytes,) = struct.unpack_from("<I", content, named)
    length_at = begin + 1 if of_record else named + 4 + name_bytes
    (length,) = struct.unpack_from("<Q", content, length_at)
    struct.pack_into("<Q", content, length_at, length + original.chunks[2][1] - end)
    case = Case(original, tmp_path / "cases", bytes(content))
    assert not case.lost and not case.foreign


@settings(
    max_examples=40,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_flipped_bytes_cost_their_own_chunks_and_are_counted(original, tmp_path, data):
    size = len(original.content)
    flips = data.draw(
        st.lists(
            st.tuples(st.integers(8, size - 1), st.integers(1, 255)),
            min_size=1,
            max_size=3,
        )
    )
    content = bytearray(original.content)
    for at, mask in flips:
        content[at] ^= mask
    hit = [
        i
        for i, (begin, end, _) in enumerate(original.chunks)
        if any(begin <= at < end for at, _ in flips)
    ]
    summary_hit = any(at >= original.data_end_at for at, _ in flips)
    if 0 in hit and summary_hit:
        return  # the definitions of all topics are lost
    case = Case(original, tmp_path / "cases", bytes(content))
    assert not case.foreign
    at_most = sum(original.chunks[i][2] for i in hit)
    assert case.lost.total() <= at_most
    for name, topic in case.report.topics.items():
        if topic.exact:
            assert topic.lost == case.lost[name]
        else:
            assert topic.lost <= case.lost[name]
    changed = (
        content[: original.data_end_at] != original.content[: original.data_end_at]
    )
    if changed and not summary_hit:
        assert not case.report.nothing_lost


def test_a_split_bag_with_one_broken_file_loses_only_what_was_there(tmp_path):
    messages = record(tmp_path / "bag", ticks=TICKS, max_file_bytes=12_000)
    files = sorted((tmp_path / "bag").glob("*.mcap"))
    assert len(files) > 2
    content = files[1].read_bytes()
    files[1].write_bytes(content[: len(content) // 3])
    report = recover(tmp_path / "bag", tmp_path / "out")
    clock = report.topics[CLOCK]
    assert clock.recovered + clock.lost == TICKS
    assert clock.exact
    assert clock.lost > 0
    # From the last message before the hole to the end of that file.
    assert clock.lost_s == pytest.approx(clock.lost * TICK_NS * 1e-9, abs=3e-3)
    numbers = [m.sequence for m in BagReader(tmp_path / "out").messages([CLOCK])]
    assert len(numbers) == clock.recovered
    assert len(messages) == PER_TICK * TICKS + 1


def test_a_file_that_is_missing_is_counted_by_the_metadata(tmp_path):
    record(tmp_path / "bag", ticks=TICKS, max_file_bytes=12_000)
    files = sorted((tmp_path / "bag").glob("*.mcap"))
    held = BagReader(files[1]).topics[CLOCK].count
    files[1].unlink()
    report = recover(tmp_path / "bag", tmp_path / "out")
    assert report.topics[CLOCK].lost == held
    assert any("bag_1.mcap: is missing" in place for place in report.damage)


def test_a_file_that_was_just_begun_does_not_cost_the_others(tmp_path):
    messages = record(tmp_path / "bag", ticks=20)
    (tmp_path / "bag" / "bag_1.mcap").touch()
    report = recover(tmp_path / "bag", tmp_path / "out")
    assert report.recovered == len(messages)
    assert any("bag_1.mcap: empty" in place for place in report.damage)


@pytest.mark.parametrize("metadata", ["missing", "not YAML"])
def test_a_bag_whose_metadata_are_gone_has_lost_nothing(tmp_path, metadata):
    messages = record(tmp_path / "bag", ticks=20)
    file = tmp_path / "bag" / "metadata.yaml"
    file.unlink()
    if metadata != "missing":
        file.write_text("rosbag2_bagfile_information: [")
    report = recover(tmp_path / "bag", tmp_path / "out")
    assert report.nothing_lost
    assert report.recovered == len(messages)


def test_another_reader_reads_what_was_recovered(original, tmp_path):
    at = position(original, "a chunk's data")
    case = Case(original, tmp_path / "cases", original.content[:at])
    with AnyReader([case.out]) as reader:
        read = [(c.topic, data, time) for c, time, data in reader.messages()]
    assert sorted(read) == [tuple(message[:3]) for message in case.messages]


def test_records_of_episodes_are_kept(tmp_path):
    folder = tmp_path / "bag"
    writer = BagWriter(folder, records={"biped.run": {"seed": "7"}})
    writer.add_topic(BagTopic(CLOCK, topics.CLOCK.type_name, [RELIABLE]))
    name = topics.ROBOT_DESCRIPTION
    writer.add_topic(BagTopic(name.name, name.type_name, [LATCHED]))
    writer.write(robot_description())
    writer.write(control_tick(0)[0])
    writer.flush()
    writer.add_record("biped.episode", {"episode": "1", "last_log_time": str(START_NS)})
    writer.flush()
    file = folder / "bag_0.mcap"
    broken = tmp_path / "broken.mcap"
    broken.write_bytes(file.read_bytes())
    writer.close()
    recover(broken, tmp_path / "out")
    records = list(BagReader(tmp_path / "out").records())
    ours = [record.name for record in records if record.name.startswith("biped.")]
    assert ours == ["biped.run", "biped.episode"]


def test_what_is_there_already_is_never_overwritten(tmp_path):
    record(tmp_path / "bag", ticks=1)
    (tmp_path / "out").mkdir()
    with pytest.raises(BagError, match="is there already"):
        recover(tmp_path / "bag", tmp_path / "out")


def test_a_bag_is_not_recovered_into_itself(tmp_path):
    record(tmp_path / "bag", ticks=1)
    with pytest.raises(BagError, match="must not be inside"):
        recover(tmp_path / "bag", tmp_path / "bag" / "out")


@pytest.mark.parametrize("content", [b"", b"no bag\n" * 1000, b"PK\x03\x04" * 99])
def test_another_format_is_refused(tmp_path, content):
    file = Path(tmp_path) / "bag.mcap"
    file.write_bytes(content)
    with pytest.raises(RecoveryFailedError, match=r"bag\.mcap: (empty|not an MCAP)"):
        recover(file, tmp_path / "out")
    assert not (tmp_path / "out").exists()
