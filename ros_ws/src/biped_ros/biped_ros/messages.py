"""Types and templates of the graph's messages, and what their numbers mean."""

from __future__ import annotations

import importlib
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
from geometry_msgs.msg import Vector3Stamped
from numpy.typing import NDArray
from rclpy.serialization import deserialize_message

from biped_common.timing import CONTROL_PERIOD_NS
from biped_ros.cdr import MessageTemplate, read_stamp
from biped_ros.tf_type import TF_TYPE, tf_message_class
from msgs_json.segment import WaistSegment
from msgs_json.topics import Topic
from msgs_json.wire import MalformedMessageError

WORLD_FRAME = "world"
# One transform each per control tick, never turned against the world.
SEGMENT_FRAMES = ("waist", "left_foot", "right_foot", "zmp_reference")
_AXES = 3
_LENGTH = struct.Struct("<I")  # of a sequence
_TRANSFORM_BYTES = 7 * 8
_NO_ROTATION = (0.0, 0.0, 0.0, 1.0)  # quaternion x, y, z, w


def message_type(topic: Topic) -> Any:
    """Return the message class of a topic; that of /tf is for bytes only."""
    if topic.type_name == TF_TYPE:
        return tf_message_class()
    package, _, name = topic.type_name.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)


def clock_template() -> MessageTemplate:
    """Return /clock."""
    return MessageTemplate(stamped=True).finished()


def joint_state_template(names: Sequence[str], *, with_effort: bool) -> MessageTemplate:
    """Return joint states: positions, velocities and, if asked for, efforts."""
    template = MessageTemplate(stamped=True).text("").integer(len(names))
    for name in names:
        template.text(name)
    for present in (True, True, with_effort):
        template.integer(len(names) if present else 0)
        for _ in names if present else ():
            template.value()
    return template.finished()


def point_template() -> MessageTemplate:
    """Return a point on the floor: x and y."""
    template = MessageTemplate(stamped=True).text(WORLD_FRAME)
    return template.value().value().constant(0.0).finished()


def imu_template(frame: str) -> MessageTemplate:
    """Return an IMU without a rate gyro: orientation (x, y, z, w), specific force."""
    template = MessageTemplate(stamped=True).text(frame)
    for numbers, known in ((4, True), (3, False), (3, True)):
        for _ in range(numbers):
            template.value() if known else template.constant(0.0)
        # Covariance: zeros for one that is not known, -1 for numbers that are not.
        template.constant(0.0 if known else -1.0)
        for _ in range(8):
            template.constant(0.0)
    return template.finished()


def wrench_template(frame: str) -> MessageTemplate:
    """Return a sole's wrench: force along z, moments about x and y."""
    template = MessageTemplate(stamped=True).text(frame)
    template.constant(0.0).constant(0.0).value()
    return template.value().value().constant(0.0).finished()


def correction_template() -> MessageTemplate:
    """Return a correction: dx and dy."""
    template = MessageTemplate(stamped=True).text(WORLD_FRAME)
    return template.value().value().constant(0.0).finished()


def correction_of(message: bytes) -> tuple[str, int, NDArray[np.float64]]:
    """Return frame, clock ticks and (dx, dy) [m] of a correction.

    Raises:
        MalformedMessageError: not a correction, or its time lies between two ticks.
    """
    try:
        correction = deserialize_message(message, Vector3Stamped)
    except Exception as error:
        raise MalformedMessageError(f"Vector3Stamped: {error}") from None
    ticks = read_stamp(message, 4)
    if ticks is None:
        raise MalformedMessageError("Vector3Stamped: its stamp is not a control tick")
    vector = correction.vector
    return correction.header.frame_id, ticks, np.array([vector.x, vector.y])


def segment_template(rows: int) -> MessageTemplate:
    """Return a waist segment of so many control ticks."""
    template = MessageTemplate(stamped=True).text(WORLD_FRAME)
    template.integer(len(SEGMENT_FRAMES))
    for frame in SEGMENT_FRAMES:
        template.text(frame)
    template.integer(rows)
    for row in range(rows):
        template.integer(len(SEGMENT_FRAMES))
        for _ in SEGMENT_FRAMES:
            template.value().value().value()
            for component in _NO_ROTATION:
                template.constant(component)
        # Neither velocities nor accelerations; time from start.
        template.integer(0).integer(0).integer(0)
        template.integer(row * CONTROL_PERIOD_NS)
    return template.finished()


class SegmentReader:
    """Reads waist segments of any number of control ticks."""

    def __init__(self) -> None:
        """Read nothing yet."""
        self._template = segment_template(rows=0)
        self._at_length = len(self._template) - _LENGTH.size
        self._rows = 0

    def read(self, message: bytes) -> tuple[NDArray[np.float64], int]:
        """Return the (rows, frames, 3) positions [m] of a segment, and its clock ticks.

        Raises:
            MalformedMessageError: not a segment of this form.
        """
        if len(message) < self._at_length + _LENGTH.size:
            raise MalformedMessageError("not a waist reference")
        (rows,) = _LENGTH.unpack_from(message, self._at_length)
        # A template is made of no more rows than there are.
        if not 0 < rows * len(SEGMENT_FRAMES) * _TRANSFORM_BYTES <= len(message):
            raise MalformedMessageError(f"not a waist reference of {rows} rows")
        if rows != self._rows:
            self._template, self._rows = segment_template(rows), rows
        read = self._template.read(message)
        if read is None:
            raise MalformedMessageError(f"not a waist reference of {rows} rows")
        values, clock_ticks = read
        return values.reshape(rows, len(SEGMENT_FRAMES), _AXES), clock_ticks


def segment_values(segment: WaistSegment) -> NDArray[np.float64]:
    """Return the (rows, frames, 3) positions of a segment's message [m]."""
    values = np.zeros((len(segment.waist), len(SEGMENT_FRAMES), _AXES))
    values[:, 0] = segment.waist
    values[:, 1] = segment.left_foot
    values[:, 2] = segment.right_foot
    values[:, 3, :2] = segment.zmp_reference
    return values
