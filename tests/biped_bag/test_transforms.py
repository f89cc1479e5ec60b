"""/tf in a bag: as independent readers see it, and as ours do."""

from pathlib import Path

import pytest
import rclpy
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore
from tests.biped_bag.bags import START_NS, TICK_NS
from tests.graph.domains import MODULE, own_domain
from tests.robots import SHIPPED

from biped_bag.info import info_text
from biped_bag.player.node import PlayerNode
from biped_bag.recorder.settings import RecorderSettings
from biped_bag.storage.contents import BagMessage, BagTopic
from biped_bag.storage.reader import BagReader
from biped_bag.storage.writer import BagWriter
from biped_bag.transforms import MadeTransforms
from biped_bringup.cli.recording import recorder_parameters
from biped_description.joints import JOINT_NAMES
from biped_ros import tf_type
from biped_ros.cdr import string_message
from biped_ros.link_transforms import MADE_OF, TF
from biped_ros.markers import torso_pose_template
from biped_ros.messages import joint_state_template
from msgs_json import topics

POSES = 5
TICKS_PER_POSE = 20


def heard():
    """Yield a description, then joint states at 500 Hz and poses at 25 Hz."""
    states = joint_state_template(JOINT_NAMES, with_effort=True)
    poses = torso_pose_template("torso")
    yield message(topics.ROBOT_DESCRIPTION, string_message(SHIPPED.urdf), 0)
    for tick in range(POSES * TICKS_PER_POSE):
        yield message(topics.JOINT_STATES, states.fill([tick / 1e3] * 36, tick), tick)
        if tick % TICKS_PER_POSE == 0:
            pose = (tick / 1e3, 0.0, 0.6, 0.0, 0.0, 0.0, 1.0)
            yield message(topics.TORSO_POSE, poses.fill(pose, tick), tick)


def message(topic, data, tick):
    log_ns = START_NS + tick * TICK_NS
    return BagMessage(topic.name, data, log_ns, log_ns - 1_000, tick + 1)


@pytest.fixture
def bag(tmp_path):
    """Write what was heard, with /tf, into two files."""
    writer = BagWriter(tmp_path / "bag")
    for topic in MADE_OF:
        writer.add_topic(BagTopic(topic.name, topic.type_name))
    made = MadeTransforms(writer.add_topic, pytest.fail)
    for each in heard():
        for one in made.put_in([each]):
            writer.write(one)
        if each.sequence == POSES * TICKS_PER_POSE // 2:
            writer.split(each.log_ns)
    writer.close()
    return writer.folder


def test_rosbags_reads_it_by_its_own_definition(bag):
    own = get_typestore(Stores.ROS2_JAZZY)
    with Reader(bag) as reader:
        (connection,) = [c for c in reader.connections if c.topic == TF.name]
        assert connection.msgtype == TF.type_name
        read = [
            (at, own.deserialize_cdr(data, TF.type_name))
            for _, at, data in reader.messages([connection])
        ]
    assert [at for at, _ in read] == [
        START_NS + i * TICKS_PER_POSE * TICK_NS for i in range(POSES)
    ]
    for i, (_, tf) in enumerate(read):
        torso, *links = tf.transforms
        assert torso.transform.translation.x == i * TICKS_PER_POSE / 1e3
        assert len(links) == len(JOINT_NAMES)


def test_every_file_says_by_itself_how_to_read_it(bag):
    files = sorted(bag.glob("*.mcap"))
    assert len(files) == 2
    for file in files:
        with file.open("rb") as stream:
            reader = make_reader(stream, decoder_factories=[DecoderFactory()])
            decoded = [d for *_, d in reader.iter_decoded_messages(topics=[TF.name])]
        assert {tf.transforms[0].child_frame_id for tf in decoded} == {"torso"}


def test_it_lies_behind_what_it_is_made_of_and_is_numbered(bag):
    reader = BagReader(bag)
    messages = list(reader.messages())
    listed = info_text(reader)
    at = [i for i, each in enumerate(messages) if each.topic == TF.name]
    assert [messages[i - 1].topic for i in at] == [topics.TORSO_POSE.name] * POSES
    assert [messages[i].sequence for i in at] == [1, 2, 3, 4, 5]
    assert f"Topic: /tf | Type: tf2_msgs/msg/TFMessage | Count: {POSES}" in listed


def test_a_description_without_links_is_told_and_costs_only_tf():
    told = []
    made = MadeTransforms(pytest.fail, told.append)
    nonsense = message(topics.ROBOT_DESCRIPTION, string_message("<robot/>"), 0)
    messages = [nonsense, *list(heard())[1:]]
    assert made.put_in(messages) == messages
    assert told == [f"/tf cannot be made: URDF: has no joint {', '.join(JOINT_NAMES)}"]


def test_only_biped_up_asks_the_recorder_for_it():
    """`ros2 bag record` records what is on the graph, and nothing else."""
    assert not RecorderSettings().make_tf
    assert recorder_parameters(Path("bag"), {}, None, {})["make_tf"] is True


@pytest.fixture
def playable(bag):
    """Return which topics of the bag the player publishes."""
    context = rclpy.Context()

    def topics_played():
        rclpy.init(context=context, domain_id=own_domain(MODULE))
        node = PlayerNode(BagReader(bag).topics, {}, context=context)
        node.destroy_node()
        return node.topics

    yield topics_played
    rclpy.shutdown(context=context)


def test_it_is_played_with_the_others(playable):
    assert playable() == {TF.name, *(topic.name for topic in MADE_OF)}


def test_where_its_type_cannot_be_made_the_others_are_played(playable, monkeypatch):
    monkeypatch.setattr(tf_type, "_NESTED", b"geometry_msgs/msg/Pose")
    tf_type.tf_message_class.cache_clear()
    assert playable() == {topic.name for topic in MADE_OF}
    tf_type.tf_message_class.cache_clear()
