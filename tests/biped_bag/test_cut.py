"""A stretch of a bag, with what a subscriber would have known at its start."""

import pytest
from tests.biped_bag.bags import (
    RELIABLE,
    START_NS,
    TICK_NS,
    control_tick,
    record,
    robot_description,
)

from biped_bag.cut import cut, stretch_of_episodes, stretch_of_time
from biped_bag.errors import BagError
from biped_bag.storage.contents import BagTopic
from biped_bag.storage.reader import BagReader
from biped_bag.storage.writer import BagWriter
from msgs_json import topics

CLOCK, STATES = topics.CLOCK.name, topics.JOINT_STATES.name
ROBOT = topics.ROBOT_DESCRIPTION.name


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    """One second of walking, in several files."""
    folder = tmp_path_factory.mktemp("bags") / "bag"
    record(folder, ticks=500, max_file_bytes=40_000, attachment=b"memory")
    return BagReader(folder)


def data_of(bag, topic, **stretch):
    """Serialized messages of a topic."""
    return [message.data for message in bag.messages([topic], **stretch)]


def test_the_stretch_holds_exactly_the_messages_of_its_time(bag, tmp_path):
    done = cut(bag, tmp_path / "out", stretch_of_time(bag, 0.2, 0.4))
    read = BagReader(tmp_path / "out")
    assert data_of(read, CLOCK) == [control_tick(t)[0].data for t in range(100, 200)]
    assert data_of(read, STATES) == [control_tick(t)[1].data for t in range(100, 200)]
    assert (done.messages, done.latched) == (200, 1)


def test_messages_keep_their_times(bag, tmp_path):
    cut(bag, tmp_path / "out", stretch_of_time(bag, 0.2, 0.4))
    times = [m.log_ns for m in BagReader(tmp_path / "out").messages([CLOCK])]
    assert times == [START_NS + tick * TICK_NS for tick in range(100, 200)]


def test_what_was_latched_before_stands_at_the_start(bag, tmp_path):
    cut(bag, tmp_path / "out", stretch_of_time(bag, 0.05, 0.06))
    out = BagReader(tmp_path / "out")
    (latched,) = out.messages([ROBOT])
    assert latched.data == robot_description().data
    assert latched.log_ns == out.start_ns == START_NS + 25 * TICK_NS
    assert out.topics[ROBOT].latched


def test_without_an_end_it_goes_to_the_last_message(bag, tmp_path):
    cut(bag, tmp_path / "out", stretch_of_time(bag, 0.9, None))
    assert BagReader(tmp_path / "out").end_ns == bag.end_ns


def test_only_the_topics_asked_for_are_kept(bag, tmp_path):
    cut(bag, tmp_path / "out", stretch_of_time(bag, None, 0.1), [CLOCK])
    assert list(BagReader(tmp_path / "out").topics) == [CLOCK]


@pytest.mark.parametrize(("start_s", "kept"), [(0.0, 1), (0.5, 0)])
def test_attachments_are_of_the_beginning_only(bag, tmp_path, start_s, kept):
    cut(bag, tmp_path / "out", stretch_of_time(bag, start_s, None))
    assert len(list(BagReader(tmp_path / "out").attachments())) == kept


@pytest.mark.parametrize(("start", "end"), [(0.5, 0.5), (0.5, 0.2), (1.0, 2.0)])
def test_a_stretch_that_holds_nothing_is_refused(bag, start, end):
    with pytest.raises(BagError, match=r"must lie within the bag's 0\.998 s"):
        stretch_of_time(bag, start, end)


def test_a_topic_that_is_not_there_is_refused(bag, tmp_path):
    with pytest.raises(BagError, match="no topic /odom; there: /clock, /joint_states"):
        cut(bag, tmp_path / "out", stretch_of_time(bag, 0.0, None), ["/odom"])
    assert not (tmp_path / "out").exists()


def test_what_is_there_already_is_never_overwritten(bag, tmp_path):
    with pytest.raises(BagError, match="is there already"):
        cut(bag, tmp_path, stretch_of_time(bag, 0.0, None))


@pytest.fixture(scope="module")
def walks(tmp_path_factory):
    """Four walks of 50 control ticks each."""
    folder = tmp_path_factory.mktemp("walks") / "bag"
    writer = BagWriter(folder, records={"biped.run": {"seed": "7"}})
    writer.add_topic(BagTopic(CLOCK, topics.CLOCK.type_name, [RELIABLE]))
    for tick in range(200):
        writer.write(control_tick(tick)[0])
        if tick % 50 == 49:
            first_ns = START_NS + (tick - 49) * TICK_NS
            times = (first_ns, START_NS + tick * TICK_NS)
            keys = ("first_log_time", "last_log_time")
            record = dict(zip(keys, map(str, times), strict=True))
            writer.add_record(
                "biped.episode", {"episode": str(tick // 50 + 1)} | record
            )
    writer.close()
    return BagReader(folder)


def test_episodes_are_cut_from_their_first_to_their_last_message(walks, tmp_path):
    cut(walks, tmp_path / "out", stretch_of_episodes(walks, 2, 3))
    out = BagReader(tmp_path / "out")
    assert data_of(out, CLOCK) == [control_tick(t)[0].data for t in range(50, 150)]
    episodes = [r.metadata["episode"] for r in out.records("biped.episode")]
    assert episodes == ["2", "3"]


def test_episodes_that_are_not_there_are_refused(walks):
    with pytest.raises(
        BagError, match="no finished episode from 7 to 9; there: 1 to 4"
    ):
        stretch_of_episodes(walks, 7, 9)
