"""Recorded messages as rows of tidy tables: one column per number, units in its name.

any header: `stamp_ns`, `frame_id`; any time or duration: `NAME_ns`.
joint states: by joint, `position_left_knee_rad`.
points and vectors of the biped: `zmp_x_m`, `correction_x_m`.
waist references: by part, `waist_x_m`, each a list over the rows of the segment.
JSON payloads: a column per field; of a pair `zmp_error_m`, `zmp_error_x_m` and `_y_m`.
all others: field names joined by `_`; sequences of numbers as lists, of messages as
    JSON text.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import msgspec
from mcap.records import Schema
from mcap.well_known import SchemaEncoding
from mcap_ros2.decoder import DecoderFactory

from biped_bag.errors import BagError
from biped_bag.storage.contents import BagTopic
from biped_common.timing import nanoseconds
from msgs_json import topics
from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation, StampedPhase
from msgs_json.wire import decode

Row = dict[str, Any]

_PAYLOADS: Mapping[str, type[msgspec.Struct]] = {
    topics.PHASE.name: StampedPhase,
    topics.OBSERVATION.name: Observation,
    topics.EPISODE.name: EpisodeResult,
    topics.LEARNER_STATUS.name: LearnerStatus,
}
# Name before the axis: what the topic is about, in place of ROS's field names.
_POSITIONS_M = {
    topics.ZMP.name: "zmp",
    topics.ZMP_REFERENCE.name: "zmp_reference",
    topics.CORRECTION.name: "correction",
}
_JOINT_UNITS = {"position": "rad", "velocity": "rad_s", "effort": "n_m"}
_AXES = ("x", "y", "z")
# Endings of field names that are units; the longest that fits is meant.
_UNITS = ("_m_s2", "_rad_s", "_rad", "_m", "_s")


def row_maker(topic: BagTopic) -> Callable[[bytes], Row]:
    """Return what turns a topic's serialized messages into rows.

    Raises:
        BagError: the topic's messages cannot be understood.
    """
    schema = Schema(1, topic.definition.encode(), SchemaEncoding.ROS2, topic.type_name)
    try:
        decoder = DecoderFactory().decoder_for(topic.encoding, schema)
    except Exception as error:  # a definition can be wrong in any way
        raise BagError(
            f"{topic.name}: its definition is no message ({error})"
        ) from None
    if decoder is None:
        raise BagError(f"{topic.name}: messages are {topic.encoding}, but must be cdr")
    flatten = _flattener(topic)

    def row(data: bytes) -> Row:
        return dict(flatten(decoder(data)))

    return row


def _flattener(topic: BagTopic) -> Callable[[Any], Iterator[tuple[str, Any]]]:
    payload = _PAYLOADS.get(topic.name)
    if payload is not None and topic.type_name == "std_msgs/msg/String":
        return lambda message: _payload_columns(
            msgspec.to_builtins(decode(payload, message.data))
        )
    if topic.type_name == "sensor_msgs/msg/JointState":
        return _joint_columns
    if topic.type_name == "trajectory_msgs/msg/MultiDOFJointTrajectory":
        return _trajectory_columns
    if topic.name in _POSITIONS_M:
        return lambda message: _position_columns(message, _POSITIONS_M[topic.name])
    return lambda message: _columns(message, "")


def _payload_columns(
    values: Mapping[str, Any], prefix: str = ""
) -> Iterator[tuple[str, Any]]:
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from _payload_columns(value, f"{prefix}{name}_")
        elif isinstance(value, Sequence) and not isinstance(value, str):
            unit = next((unit for unit in _UNITS if name.endswith(unit)), "")
            stem = name.removesuffix(unit)
            for axis, number in zip(_AXES, value, strict=False):
                yield f"{prefix}{stem}_{axis}{unit}", number
        else:
            yield f"{prefix}{name}", value


def _joint_columns(message: Any) -> Iterator[tuple[str, Any]]:
    yield from _header_columns(message.header)
    for field, unit in _JOINT_UNITS.items():
        # Any of the three may be empty; the names say how many joints there are.
        for joint, number in zip(message.name, getattr(message, field), strict=False):
            yield f"{field}_{joint}_{unit}", number


def _position_columns(message: Any, name: str) -> Iterator[tuple[str, Any]]:
    yield from _header_columns(message.header)
    position = message.point if hasattr(message, "point") else message.vector
    for axis in _AXES:
        yield f"{name}_{axis}_m", getattr(position, axis)


def _trajectory_columns(message: Any) -> Iterator[tuple[str, Any]]:
    yield from _header_columns(message.header)
    yield (
        "time_from_start_ns",
        [nanoseconds(point.time_from_start) for point in message.points],
    )
    for i, part in enumerate(message.joint_names):
        unit = "" if part in ("phase", "extent") else "_m"
        for axis in _AXES:
            yield (
                f"{part}_{axis}{unit}",
                [getattr(p.transforms[i].translation, axis) for p in message.points],
            )


def _columns(message: Any, prefix: str) -> Iterator[tuple[str, Any]]:
    for name in message.__slots__:
        value = getattr(message, name)
        if name == "header" and hasattr(value, "frame_id"):
            yield from _header_columns(value, prefix)
        elif _is_time(value):
            yield f"{prefix}{name}_ns", nanoseconds(value)
        elif hasattr(value, "__slots__"):
            yield from _columns(value, f"{prefix}{name}_")
        elif isinstance(value, str | bytes | bool | int | float):
            yield f"{prefix}{name}", value
        else:
            items = list(value)
            nested = any(hasattr(item, "__slots__") for item in items)
            yield f"{prefix}{name}", json.dumps(_plain(items)) if nested else items


def _header_columns(header: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    yield f"{prefix}stamp_ns", nanoseconds(header.stamp)
    yield f"{prefix}frame_id", header.frame_id


def _is_time(value: Any) -> bool:
    return tuple(getattr(value, "__slots__", ())) == ("sec", "nanosec")


def _plain(value: Any) -> Any:
    """Return a decoded message as JSON knows it."""
    if hasattr(value, "__slots__"):
        return {name: _plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, str | bool | int | float):
        return value
    return [_plain(item) for item in value]
