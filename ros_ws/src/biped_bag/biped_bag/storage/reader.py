"""Read a finished bag: topics, messages in the order of recording, metadata records.

A bag is checked as a whole when it is opened: what a BagReader hands out is what was
recorded. What failures do:
    no such path, empty, another format: BagError says which.
    cut off, damaged bytes, metadata.yaml missing or at odds with the data: BagError
        that names `biped bag recover`; nothing is read or repaired then.
"""

from __future__ import annotations

import heapq
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from mcap.reader import SeekingReader
from mcap.records import Attachment, Metadata
from mcap.summary import Summary

from biped_bag.errors import BagError
from biped_bag.storage.contents import BagMessage, BagTopic, message_of, topic_of
from biped_bag.storage.integrity import DAMAGE, DamagedFileError, sound_summary
from biped_bag.storage.layout import broken, find_files
from biped_bag.storage.metadata import FILE_NAME, BagMetadata, FileInfo


class BagReader:
    """A finished bag, opened and found whole."""

    def __init__(self, path: Path) -> None:
        """Open and check a bag.

        Args:
            path: of the rosbag2 folder, or of a single MCAP file.

        Raises:
            BagError: see the top of this module.
        """
        self.path = path
        self.files, self._told = find_files(path)
        self.topics: dict[str, BagTopic] = {}
        held = BagMetadata()
        for file in self.files:
            try:
                summary, statistics = sound_summary(file)
            except DamagedFileError as error:
                raise broken(path, str(error)) from None
            self._add_topics(file, summary, statistics.channel_message_counts)
            held.files.append(
                FileInfo(
                    file.name,
                    statistics.message_start_time,
                    statistics.message_end_time,
                    statistics.message_count,
                )
            )
        self.message_count = held.message_count
        self.start_ns, self.end_ns = held.start_ns, held.end_ns
        self._compare_with_metadata()

    @property
    def size(self) -> int:
        """Bytes of everything in the folder, as rosbag2 counts them, or of the file."""
        files = self.path.iterdir() if self.path.is_dir() else self.files
        return sum(file.stat().st_size for file in files if file.is_file())

    @property
    def ros_distro(self) -> str:
        """ROS distribution that recorded, as metadata.yaml says, or empty."""
        return "" if self._told is None else self._told.ros_distro

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
            key=lambda message: message.log_ns,
        )

    def chosen(self, topics: Collection[str] | None) -> list[str]:
        """Return the names of the topics that a user chose; all for None.

        Raises:
            BagError: one is not in the bag.
        """
        for name in topics or ():
            if name not in self.topics:
                known = ", ".join(sorted(self.topics))
                raise BagError(f"{self.path}: has no topic {name}; there: {known}")
        return [name for name in self.topics if topics is None or name in topics]

    def records(self, name: str | None = None) -> Iterator[Metadata]:
        """Yield the MCAP metadata records, of this name or all, in their order."""
        for file in self.files:
            with file.open("rb") as stream:
                for record in SeekingReader(stream).iter_metadata():
                    if name in (None, record.name):
                        yield record

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
                for _, channel, message in found:
                    yield message_of(channel.topic, message)
            except DAMAGE as error:
                raise broken(self.path, f"{file}: damaged ({error})") from None

    def _add_topics(
        self, file: Path, summary: Summary, counts: Mapping[int, int]
    ) -> None:
        for channel in summary.channels.values():
            schema = summary.schemas.get(channel.schema_id)
            if schema is None:
                raise BagError(
                    f"{file}: topic {channel.topic} has no message definition"
                )
            topic = topic_of(channel, schema, counts.get(channel.id, 0))
            before = self.topics.setdefault(topic.name, replace(topic, count=0))
            if before.type_name != topic.type_name:
                raise BagError(
                    f"{file}: topic {topic.name} is of type {topic.type_name}, "
                    f"but {before.type_name} before"
                )
            self.topics[topic.name] = replace(before, count=before.count + topic.count)

    def _compare_with_metadata(self) -> None:
        for told in [] if self._told is None else self._told.topics:
            held = self.topics[told.name].count if told.name in self.topics else 0
            if told.count != held:
                raise broken(
                    self.path,
                    f"{self.path / FILE_NAME}: tells of {told.count} messages "
                    f"on {told.name}, but the data hold {held}",
                )
