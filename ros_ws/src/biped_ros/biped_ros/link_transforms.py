"""/tf, made of the torso's pose and the joint states: what viewers place a robot by.

The message is tf2_msgs/TFMessage, a sequence of TransformStamped. A tree as
robot_state_publisher makes it: world to torso, and from each link to the next one down
the legs. Whoever has the three topics has it; it says nothing that they do not say.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import deque

import numpy as np
from numpy.typing import NDArray

from biped_common.errors import BipedError
from biped_description.joints import JOINT_NAMES
from biped_description.links import TORSO
from biped_ros.cdr import MessageTemplate, string_text
from biped_ros.markers import torso_pose_template
from biped_ros.messages import WORLD_FRAME, joint_state_template
from biped_ros.tf_type import TF_TYPE
from msgs_json import topics
from msgs_json.topics import Topic
from msgs_json.wire import MalformedMessageError

Rows = NDArray[np.float64]

TF = Topic(
    "/tf",
    TF_TYPE,
    depth=100,
    meaning="world to torso, and each link from the one above it [m]",
)
MADE_OF = (topics.ROBOT_DESCRIPTION, topics.JOINT_STATES, topics.TORSO_POSE)

# Joint states that wait for the pose of their control tick, half a second at 500 Hz.
_STATES_KEPT = 256
_STAMP = slice(4, 12)  # of a message that begins with a header


class RobotDescriptionError(BipedError):
    """A URDF from which the links cannot be placed."""


class LinkTransforms:
    """The transforms of one robot, as a message of which only numbers change."""

    def __init__(self, urdf: str) -> None:
        """Take links, joints, origins and axes from a URDF.

        Args:
            urdf: as XML; has our joints, all of them turning about an axis.

        Raises:
            RobotDescriptionError: it is no such URDF.
        """
        try:
            joints = {j.get("name"): j for j in ET.fromstring(urdf).iter("joint")}
        except ET.ParseError as error:
            raise RobotDescriptionError(f"URDF: {error}") from None
        missing = [name for name in JOINT_NAMES if name not in joints]
        if missing:
            raise RobotDescriptionError(f"URDF: has no joint {', '.join(missing)}")
        template = MessageTemplate(stamped=False).integer(1 + len(JOINT_NAMES))
        _add_transform(template, WORLD_FRAME, TORSO, None)
        axes = []
        for name in JOINT_NAMES:
            joint = joints[name]
            parent = _of(joint, name, "parent", "link")
            child = _of(joint, name, "child", "link")
            origin = _vector(_of(joint, name, "origin", "xyz"), name)
            if any(_vector(_of(joint, name, "origin", "rpy"), name)):
                raise RobotDescriptionError(f"URDF: {name} is turned against its link")
            axes.append(_vector(_of(joint, name, "axis", "xyz"), name))
            _add_transform(template, parent, child, origin)
        self._template = template.finished()
        self._axes = np.array(axes)

    def message(self, torso: Rows, q: Rows, clock_ticks: int) -> bytes:
        """Return the serialized TFMessage.

        Args:
            torso: (7,) world to torso: x, y, z [m] and quaternion x, y, z, w.
            q: (12,) joint positions in the order of JOINT_NAMES [rad].
            clock_ticks: control ticks of the simulation's clock.
        """
        half = 0.5 * q[:, np.newaxis]
        turns = np.hstack([self._axes * np.sin(half), np.cos(half)])
        return self._template.fill(np.concatenate([torso, turns.ravel()]), clock_ticks)


class TransformSource:
    """Hears the topics of `MADE_OF`, in any order, and makes messages of /tf."""

    def __init__(self) -> None:
        """Hear nothing yet."""
        self._transforms: LinkTransforms | None = None
        self._described = b""
        self._states: deque[bytes] = deque(maxlen=_STATES_KEPT)
        self._pose: bytes | None = None
        """The last one, while the joint states of its tick have not come."""
        self._state_template = joint_state_template(JOINT_NAMES, with_effort=True)
        self._pose_template = torso_pose_template(TORSO)

    def hear(self, topic: str, message: bytes) -> bytes | None:
        """Return a message of /tf, if this one completes it.

        There is one per torso pose for which there are joint states of the same control
        tick; what is of another form is passed over.

        Args:
            topic: name of any topic.
            message: serialized.

        Raises:
            RobotDescriptionError: it describes a robot whose links cannot be placed.
        """
        if topic == topics.JOINT_STATES.name:
            self._states.append(message)
            if self._pose is not None and self._pose[_STAMP] == message[_STAMP]:
                return self._made(self._pose, message)
        elif topic == topics.TORSO_POSE.name:
            self._pose = message
            for state in reversed(self._states):
                if state[_STAMP] == message[_STAMP]:
                    return self._made(message, state)
        elif topic == topics.ROBOT_DESCRIPTION.name and message != self._described:
            self._described, self._transforms = message, None
            try:
                self._transforms = LinkTransforms(string_text(message))
            except MalformedMessageError as error:
                raise RobotDescriptionError(str(error)) from None
        return None

    def _made(self, pose: bytes, state: bytes) -> bytes | None:
        self._pose = None
        torso, joints = self._pose_template.read(pose), self._state_template.read(state)
        if self._transforms is None or torso is None or joints is None:
            return None
        q = joints[0][: len(JOINT_NAMES)]
        return self._transforms.message(torso[0], q, torso[1])


def _add_transform(
    template: MessageTemplate, parent: str, child: str, origin: list[float] | None
) -> None:
    """Append a TransformStamped, its translation constant or three values."""
    template.stamp().text(parent).text(child)
    for i in range(3):
        if origin is None:
            template.value()
        else:
            template.constant(origin[i])
    for _ in range(4):
        template.value()


def _of(joint: ET.Element, name: str, tag: str, attribute: str) -> str:
    element = joint.find(tag)
    text = None if element is None else element.get(attribute)
    if text is None:
        raise RobotDescriptionError(f"URDF: {name} has no {tag} {attribute}")
    return text


def _vector(text: str, name: str) -> list[float]:
    try:
        x, y, z = (float(word) for word in text.split())
    except ValueError:
        raise RobotDescriptionError(f"URDF: {name}: {text} is no vector") from None
    return [x, y, z]
