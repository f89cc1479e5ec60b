"""Read a finished bag: topics, messages in the order of recording, metadata records.

A bag is checked as a whole when it is opened: what a BagReader hands out is what was
recorded. What failures do:
    no such path, empty, another format: BagError says which.
    cut off, damaged bytes, metadata.yaml missing or at odds with the data: BagError
        that names `biped bag recover`; nothing is read or repaired then.
"""

from __future__ import annotations

import heapq
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import yaml
from mcap.reader import SeekingReader
from mcap.records import Attachment, Channel, Schema
from mcap.summary import Summary

from biped_bag.bag_files import broken, find_files
from biped_bag.errors import BagError
from biped_bag.mcap_check import DAMAGE, DamagedFileError, check_file
from biped_bag.metadata import FILE_NAME

QOS_KEY = "offered_qos_profiles"
TYPE_HASH_KEY = "topic_type_hash"
_TRANSIENT_LOCAL = ("transient_local", 1)  # rosbag2 has written both


class BagMessage(NamedTuple):
    """One recorded message."""

    topic: str
    type_name: str
    """As ROS writes it, package/msg/Type."""
    data: bytes
    """CDR, with its encapsulation header."""
    log_time_ns: int
    publish_time_ns: int
    sequence: int
    """Number of the message on its topic, where the recorder counted; else 0."""


@dataclass(frozen=True)
class BagTopic:
    """One topic of a bag."""

    name: str
    type_name: str
    encoding: str
    """Of the messages: cdr."""
    qos: str
    """Offered QoS profiles, YAML as rosbag2 writes it."""
    type_hash: str
    """RIHS01 hash of the type; may be empty."""
    definition: str
    """Message definition with those it depends on (ros2msg)."""
    count: int

    @property
    def latched(self) -> bool:
        """Whether who comes later still gets the last message (transient local)."""
        return any(
            profile.get("durability") in _TRANSIENT_LOCAL
            for profile in offered_qos(self.qos)
        )


@dataclass(frozen=True)
class MetadataRecord:
    """One MCAP metadata record, such as `biped.run` or `biped.episode`."""

    name: str
    values: dict[str, str]


class BagReader:
    """A finished bag, opened and found whole."""

    def __init__(self, path: Path) -> None:
        """Open and check a bag.

        Args:
            path: of the rosbag2 folder, or of a single MCAP file.

        Raises:
            BagError: see the top of this module.
        """
        self._files = find_files(path)
        self.path = path
        self.topics: dict[str, BagTopic] = {}
        self.message_count = 0
        times: list[tuple[int, int]] = []
        for file in self.files:
            try:
                check_file(file)
                summary = _summary(file)
            except DamagedFileError as error:
                raise broken(path, f"{file}: {error}") from None
            self._add_topics(file, summary)
            statistics = summary.statistics
            assert statistics is not None
            self.message_count += statistics.message_count
            if statistics.message_count:
                times.append(
                    (statistics.message_start_time, statistics.message_end_time)
                )
        self.start_ns = min((start for start, _ in times), default=0)
        self.end_ns = max((end for _, end in times), default=0)
        self._compare_with_metadata()

    @property
    def files(self) -> tuple[Path, ...]:
        """MCAP files, in the order of recording."""
        return self._files.data

    @property
    def size(self) -> int:
        """Bytes of all files of the bag."""
        return self._files.size

    @property
    def ros_distro(self) -> str:
        """ROS distribution that recorded, as metadata.yaml says, or empty."""
        metadata = self._files.metadata
        return "" if metadata is None else metadata.ros_distro

    @property
    def duration_ns(self) -> int:
        """From the first to the last log time."""
        return self.end_ns - self.start_ns

    def messages(
        self,
        topics: Collection[str] | None = None,
        start_ns: int | None = None,
        end_ns: int | None = None,
    ) -> Iterator[BagMessage]:
        """Yield messages in the order of their log times, over all files.

        Args:
            topics: names; None takes all.
            start_ns: log time to start at.
            end_ns: log time to end before.
        """
        return heapq.merge(
            *(self._messages_of(file, topics, start_ns, end_ns) for file in self.files),
            key=lambda message: message.log_time_ns,
        )

    def metadata_records(self, name: str | None = None) -> Iterator[MetadataRecord]:
        """Yield the metadata records, of this name or all, in their order."""
        for file in self.files:
            with file.open("rb") as stream:
                for record in SeekingReader(stream).iter_metadata():
                    if name in (None, record.name):
                        yield MetadataRecord(record.name, dict(record.metadata))

    def attachments(self) -> Iterator[Attachment]:
        """Yield the attachments, in their order."""
        for file in self.files:
            with file.open("rb") as stream:
                yield from SeekingReader(stream).iter_attachments()

    def _messages_of(
        self,
        file: Path,
        topics: Collection[str] | None,
        start_ns: int | None,
        end_ns: int | None,
    ) -> Iterator[BagMessage]:
        with file.open("rb") as stream:
            found = SeekingReader(stream, validate_crcs=True).iter_messages(
                topics=topics, starting_at=start_ns, ending_before=end_ns
            )
            try:
                for schema, channel, message in found:
                    assert schema is not None
                    yield BagMessage(
                        channel.topic,
                        schema.name,
                        message.data,
                        message.log_time,
                        message.publish_time,
                        message.sequence,
                    )
            except DAMAGE as error:
                raise broken(self.path, f"{file}: damaged ({error})") from None

    def _add_topics(self, file: Path, summary: Summary) -> None:
        statistics = summary.statistics
        assert statistics is not None
        for channel in summary.channels.values():
            schema = summary.schemas.get(channel.schema_id)
            if schema is None:
                raise BagError(
                    f"{file}: topic {channel.topic} has no message definition"
                )
            topic = bag_topic(
                channel, schema, statistics.channel_message_counts.get(channel.id, 0)
            )
            before = self.topics.setdefault(topic.name, replace(topic, count=0))
            if before.type_name != topic.type_name:
                raise BagError(
                    f"{file}: topic {topic.name} is of type {topic.type_name}, "
                    f"but {before.type_name} before"
                )
            self.topics[topic.name] = replace(before, count=before.count + topic.count)

    def _compare_with_metadata(self) -> None:
        if self._files.metadata is None:
            return
        for told in self._files.metadata.topics:
            held = self.topics[told.name].count if told.name in self.topics else 0
            if told.message_count != held:
                raise broken(
                    self.path,
                    f"{self.path / FILE_NAME}: tells of {told.message_count} messages "
                    f"on {told.name}, but the data hold {held}",
                )


def bag_topic(channel: Channel, schema: Schema, count: int) -> BagTopic:
    """Return the topic that an MCAP channel and its schema describe."""
    return BagTopic(
        name=channel.topic,
        type_name=schema.name,
        encoding=channel.message_encoding,
        qos=channel.metadata.get(QOS_KEY, ""),
        type_hash=channel.metadata.get(TYPE_HASH_KEY, ""),
        definition=schema.data.decode(),
        count=count,
    )


def offered_qos(qos: str) -> list[dict[str, Any]]:
    """Return the profiles of a topic's publishers; none where they are not known."""
    profiles = yaml.safe_load(qos) if qos else None
    return [profile for profile in profiles or () if isinstance(profile, dict)]


def _summary(file: Path) -> Summary:
    """Return what the file's end tells of it.

    Raises:
        DamagedFileError: it tells nothing.
    """
    with file.open("rb") as stream:
        try:
            summary = SeekingReader(stream).get_summary()
        except DAMAGE as error:
            raise DamagedFileError(f"its summary is damaged ({error})") from None
    if summary is None or summary.statistics is None:
        raise DamagedFileError("it has no summary")
    return summary
