"""What a bag holds: topics, and their messages as serialized bytes.

Topics are channels in MCAP; with each, rosbag2 keeps two more things: the quality of
service that the publishers offered, and the hash of the type.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import yaml
from mcap.records import Channel, Message, Schema
from mcap.well_known import MessageEncoding

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
        _QOS_KEY: yaml.safe_dump(profiles, sort_keys=False).strip() if profiles else "",
        _TYPE_HASH_KEY: topic.type_hash,
    }


def topic_of(channel: Channel, schema: Schema, count: int = 0) -> BagTopic:
    """Return the topic that an MCAP channel and its schema describe.

    Profiles that cannot be understood count as not known.
    """
    try:
        profiles = yaml.safe_load(channel.metadata.get(_QOS_KEY, ""))
    except yaml.YAMLError:
        profiles = None
    return BagTopic(
        name=channel.topic,
        type_name=schema.name,
        offered_qos=tuple(
            profile
            for profile in (profiles if isinstance(profiles, list) else ())
            if isinstance(profile, Mapping)
        ),
        type_hash=channel.metadata.get(_TYPE_HASH_KEY, ""),
        definition=schema.data.decode(),
        encoding=channel.message_encoding,
        count=count,
    )
