"""What a bag holds: topics, and their messages as serialized bytes.

Topics are channels in MCAP; with each, rosbag2 keeps two more things: the quality of
service that the publishers offered, and the hash of the type.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from mcap.records import Channel, Message, Schema
from mcap.well_known import MessageEncoding

from biped_bag.errors import BagError
from biped_common.plain_yaml import YamlError, read_yaml, yaml_text

_QOS_KEY = "offered_qos_profiles"
_TYPE_HASH_KEY = "topic_type_hash"
_TRANSIENT_LOCAL = ("transient_local", 1)  # rosbag2 has written both

OfferedQos = Mapping[str, Any]
"""One publisher's quality of service, with rosbag2's keys and words."""


class BagMessage(NamedTuple):
    """One message, as it came."""

    topic: str
    data: bytes
    """Its CDR, with the encapsulation header."""
    log_ns: int
    """When it was received, wall clock."""
    publish_ns: int
    """When its publisher sent it, wall clock."""
    sequence: int = 0
    """Its number among those of its publisher; 0 if not known."""


@dataclass(frozen=True)
class BagTopic:
    """One topic of a bag."""

    name: str
    type_name: str
    """As ROS writes it, package/msg/Type."""
    offered_qos: Sequence[OfferedQos] = ()
    """One per publisher that was there when the topic was first seen."""
    type_hash: str = ""
    """RIHS01 hash of the type; may be empty."""
    definition: str = ""
    """Of the message and all that is nested in it (ros2msg)."""
    encoding: str = MessageEncoding.CDR
    """Of the messages."""
    count: int = 0
    """Messages in the bag."""

    @property
    def latched(self) -> bool:
        """Whether who comes later still gets the last message (transient local)."""
        return any(
            profile.get("durability") in _TRANSIENT_LOCAL
            for profile in self.offered_qos
        )


def message_of(topic: str, message: Message) -> BagMessage:
    """Return a message of a topic as MCAP has it."""
    return BagMessage(
        topic,
        message.data,
        message.log_time,
        message.publish_time,
        message.sequence,
    )


def channel_metadata(topic: BagTopic) -> dict[str, str]:
    """Return what rosbag2 keeps with a topic's channel."""
    profiles = [dict(profile) for profile in topic.offered_qos]
    return {
        # With the words of metadata.yaml: readers compare the two.
        _QOS_KEY: yaml_text(profiles).strip() if profiles else "",
        _TYPE_HASH_KEY: topic.type_hash,
    }


def topic_of(channel: Channel, schema: Schema, count: int = 0) -> BagTopic:
    """Return the topic that an MCAP channel and its schema describe.

    Profiles that cannot be understood count as not known.

    Raises:
        BagError: name, type or definition cannot be those of a topic.
    """
    for what in (channel.topic, schema.name):
        # No ROS name has them, and they end lines, files' names and C's strings.
        if not what or not what.isprintable():
            raise BagError(
                f"topic {channel.topic!r} of type {schema.name!r}: names must be "
                "printable characters"
            )
    try:
        definition = schema.data.decode()
    except UnicodeDecodeError:
        raise BagError(f"topic {channel.topic}: its definition is no text") from None
    try:
        profiles = read_yaml(channel.metadata.get(_QOS_KEY, ""))
    except YamlError:
        profiles = None
    return BagTopic(
        name=channel.topic,
        type_name=schema.name,
        offered_qos=known_profiles(profiles),
        type_hash=channel.metadata.get(_TYPE_HASH_KEY, ""),
        definition=definition,
        encoding=channel.message_encoding,
        count=count,
    )


def known_profiles(profiles: Any) -> tuple[OfferedQos, ...]:
    """Return those of the profiles, as read from YAML, that can be understood."""
    return tuple(
        profile
        for profile in (profiles if isinstance(profiles, list) else ())
        if isinstance(profile, Mapping)
    )
