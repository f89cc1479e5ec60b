"""A frozen walk in this process, written into a bag as the nodes would publish it."""

from dataclasses import dataclass
from pathlib import Path

from tests.biped_bag.bags import LATCHED, RELIABLE, START_NS
from tests.biped_bag.verification.recorded_run import RecordedRun

from biped_bag.records import FROM_NOTHING, RUN_RECORD
from biped_bag.storage.contents import BagMessage, BagTopic
from biped_bag.storage.writer import BagWriter
from biped_bringup.training import TrainingRun
from biped_common.plain_yaml import yaml_text
from biped_common.settings import to_mapping
from biped_description.robot import Robot
from biped_ros.cdr import string_message
from biped_ros.markers import torso_pose_template
from biped_ros.messages import segment_template, segment_values
from msgs_json import topics
from msgs_json.wire import encode
from sim_node.markers import TORSO_FRAME
from trajectory_node.waist_reference import WaistReference

POSE_EVERY_TICKS = 20
_LOOK_AHEAD_TICKS = 5


class FrozenRun(RecordedRun):
    """All messages that a walk report is made of."""

    def __init__(self, training: TrainingRun):
        self.training = training
        settings = training.settings
        self._reference = WaistReference(
            Robot(settings.robot), settings.gait, settings.correction, _LOOK_AHEAD_TICKS
        )
        self._pose = torso_pose_template(TORSO_FRAME)
        super().__init__(settings, training.seed, frozen=True)
        self._say(topics.PLAN, string_message(encode(self._reference.walk_plan())))

    def new_session(self):
        return self.training.session

    def respond(self, observation):
        answer = super().respond(observation)
        if observation.control_tick == 0:
            self._reference.reset()
        if observation.end_cause is None and hasattr(answer, "shape"):
            values = segment_values(self._reference.segment(answer))
            template = segment_template(len(values))
            message = template.fill(values.ravel(), observation.clock_ticks)
            self._say(topics.WAIST_REFERENCE, message)
        return answer

    def _on_tick(self, tick):
        super()._on_tick(tick)
        if tick.clock_ticks % POSE_EVERY_TICKS == 0:
            world = self._walker.biped.world
            pose = (*world.waist().position, *world.torso_orientation())
            self._say(topics.TORSO_POSE, self._pose.fill(pose, tick.clock_ticks))


def write_bag(folder, run, *, without=(), records=True):
    """Write what a run has said into a bag.

    Args:
        folder: of the bag.
        run: a FrozenRun.
        without: names of topics that are left out.
        records: say of which run it is.
    """
    told = {
        "settings": yaml_text(to_mapping(run.settings)),
        "seed": str(run.seed),
        "frozen": "true",
        "begins_with": FROM_NOTHING,
    }
    writer = BagWriter(folder, records={RUN_RECORD: told} if records else None)
    for topic in (
        *topics.CONTROL, topics.ZMP, topics.ZMP_REFERENCE, topics.JOINT_STATES,
        topics.JOINT_REFERENCES, topics.TORSO_POSE,
    ):  # fmt: skip
        qos = LATCHED if topic.latched else RELIABLE
        writer.add_topic(BagTopic(topic.name, topic.type_name, [qos]))
    for n, (name, data) in enumerate(run.messages):
        if name not in without:
            at_ns = START_NS + n * 1000
            writer.write(BagMessage(name, bytes(data), at_ns, at_ns, n))
    writer.close()
    return folder


@dataclass(frozen=True)
class WalkedTwice:
    """A memory, and a bag of its frozen walk."""

    run: FrozenRun
    memory: Path
    bag: Path
