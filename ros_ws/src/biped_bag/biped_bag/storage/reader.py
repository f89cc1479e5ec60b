"""Read a finished bag: topics, messages in the order of recording, metadata records.

A bag is checked as a whole when it is opened: what a BagReader hands out is what was
recorded. What failures do:
    no such path, empty, another format: BagError says which.
    cut off, damaged bytes, metadata.yaml missing or at odds with the data: BagError
        that names `biped bag recover`; nothing is read or repaired then.
    more than a bound at once: BagError says what of, and the bound.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from mcap.records import Attachment, McapRecord, Metadata

from biped_bag.errors import BagError
from biped_bag.storage.contents import BagMessage, BagTopic, topic_of
from biped_bag.storage.integrity import DamagedFileError, SoundFile, sound_file
from biped_bag.storage.layout import broken, find_files
from biped_bag.storage.mcap_record import (
    RECORD_HEADER,
    DamagedRecordError,
    parsed,
    place_of,
)
from biped_bag.storage.message_order import Source, in_order
from biped_bag.storage.metadata import FILE_NAME, OWN_RECORD, BagMetadata, FileInfo
from biped_bag.storage.summary import check_sizes
from biped_common.plain_yaml import YamlError, read_yaml

MOST_RECORD_BYTES = 16 * 2**20
"""Of all MCAP metadata records that are read at once; that of a walk has 500 bytes."""


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
        self._found: dict[Path, SoundFile] = {}
        held = BagMetadata()
        for file in self.files:
            try:
                found = self._found[file] = sound_file(file)
                self._check_sizes()
            except DamagedFileError as error:
                raise broken(path, str(error)) from None
            except DamagedRecordError as error:
                raise BagError(f"{path}: {error}") from None
            self._add_topics(file, found)
            statistics = found.statistics
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

        Raises:
            BagError: a chunk is damaged, or more messages overlap than are held.
        """
        sources = []
        for file, found in self._found.items():
            names = {
                number: channel.topic
                for number, channel in found.summary.channels.items()
                if topics is None or channel.topic in topics
            }
            sources.append(Source(file, names, tuple(found.summary.chunks)))
        try:
            yield from in_order(sources, start_ns, end_ns)
        except DamagedRecordError as error:
            raise broken(self.path, f"{self.path}: damaged ({error})") from None

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
        """Yield the MCAP metadata records, of this name or all, in their order.

        Raises:
            BagError: one is damaged, or all together are more than is read.
        """
        size = 0
        for record in self._indexed(lambda found: found.summary.metadata):
            if isinstance(record, Metadata) and name in (None, record.name):
                size += sum(
                    len(key) + len(text) for key, text in record.metadata.items()
                )
                if size > MOST_RECORD_BYTES:
                    raise BagError(
                        f"{self.path}: metadata records of more than "
                        f"{MOST_RECORD_BYTES} characters"
                    )
                yield record

    def attachments(self) -> Iterator[Attachment]:
        """Yield the attachments, in their order.

        Raises:
            BagError: one is damaged.
        """
        for record in self._indexed(lambda found: found.summary.attachments):
            if isinstance(record, Attachment):
                yield record

    def _indexed(
        self, index: Callable[[SoundFile], Sequence[tuple[int, int]]]
    ) -> Iterator[McapRecord | None]:
        """Yield the records to which an index of the files leads."""
        for file, found in self._found.items():
            with file.open("rb") as stream:
                for at, end in index(found):
                    stream.seek(at)
                    try:
                        head = stream.read(RECORD_HEADER.size)
                        place = place_of(head, 0, end - at)
                        yield parsed(place.opcode, stream.read(place.end - place.body))
                    except DamagedRecordError as error:
                        raise broken(
                            self.path, f"{file}: the record at byte {at}: {error}"
                        ) from None

    def _add_topics(self, file: Path, found: SoundFile) -> None:
        counts = found.statistics.channel_message_counts
        for channel in found.summary.channels.values():
            schema = found.summary.schemas.get(channel.schema_id)
            if schema is None:
                raise BagError(
                    f"{file}: topic {channel.topic!r} has no message definition"
                )
            try:
                topic = topic_of(channel, schema, counts.get(channel.id, 0))
            except BagError as error:
                raise BagError(f"{file}: {error}") from None
            before = self.topics.setdefault(topic.name, replace(topic, count=0))
            if before.type_name != topic.type_name:
                raise BagError(
                    f"{file}: topic {topic.name} is of type {topic.type_name}, "
                    f"but {before.type_name} before"
                )
            self.topics[topic.name] = replace(before, count=before.count + topic.count)

    def _check_sizes(self) -> None:
        summaries = [found.summary for found in self._found.values()]
        check_sizes(
            sum(summary.size for summary in summaries),
            sum(summary.text_size for summary in summaries),
        )

    def _compare_with_metadata(self) -> None:
        for told in [] if self._told is None else self._told.topics:
            held = self.topics[told.name].count if told.name in self.topics else 0
            if told.count != held:
                raise broken(
                    self.path,
                    f"{self.path / FILE_NAME}: tells of {told.count} messages "
                    f"on {told.name}, but the data hold {held}",
                )
        own = [record.metadata for record in self.records(OWN_RECORD)]
        try:
            repeated = (
                read_yaml(own[-1].get("serialized_metadata", "")) if own else None
            )
        except YamlError:
            repeated = None  # of another recorder
        if self._told is None or not isinstance(repeated, dict):
            return
        distro = repeated.get("ros_distro", self.ros_distro)
        if distro != self.ros_distro:
            raise broken(
                self.path,
                f"{self.path / FILE_NAME}: tells of ROS {self.ros_distro!r}, but the "
                f"data of {distro!r}",
            )
