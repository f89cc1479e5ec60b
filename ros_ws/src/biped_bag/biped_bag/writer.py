"""Write a bag: a folder with `metadata.yaml` and MCAP files that are readable alone.

What failures do:
    the folder is a bag already, or cannot be made or written to: `BagError`, and
        nothing in it is touched.
    the disk is full: `BagError`; the file ends with the last flush, without its index,
        and `metadata.yaml` counts what is in it, if there is room for that.
    kill -9: the file ends with the last flush, possibly with a torn record behind it;
        `metadata.yaml` is that of the beginning or of the last split.
"""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

from mcap.writer import CompressionType, Writer

from biped_bag.durable_file import DurableFile
from biped_bag.errors import BagError
from biped_bag.metadata import (
    FILE_NAME,
    BagMetadata,
    FileInfo,
    OfferedQos,
    TopicInfo,
    metadata_text,
    qos_text,
    write_metadata,
)
from biped_bag.schemas import ENCODING, message_definition

PROFILE = "ros2"
MESSAGE_ENCODING = "cdr"
# Small chunks: what is not in a finished chunk is lost when the recorder is killed.
CHUNK_BYTES = 64 * 1024


class RecordedMessage(NamedTuple):
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


@dataclass
class _Topic:
    info: TopicInfo
    latched: bool
    definition: str
    channel: int = 0
    """Of the present file."""
    last: RecordedMessage | None = None
    """The last message of a latched topic."""


@dataclass
class _File:
    stream: DurableFile
    writer: Writer
    info: FileInfo
    schemas: dict[str, int] = field(default_factory=dict)


class BagWriter:
    """Writes one bag; of one thread at a time."""

    def __init__(
        self,
        folder: Path,
        *,
        max_file_bytes: int = 0,
        records: Mapping[str, Mapping[str, str]] | None = None,
    ) -> None:
        """Begin the bag.

        Args:
            folder: of the bag; made if need be, must not hold a bag.
            max_file_bytes: a file that has grown so large is followed by a new one;
                0: never.
            records: MCAP metadata that every file begins with, by name.

        Raises:
            BagError: the folder cannot be used.
        """
        self.folder = folder
        self.metadata = BagMetadata()
        self.repeated: dict[str, int] = {}
        """Latched messages written again at the start of a file, by topic; they are
        part of all counts in `metadata`."""
        self._max_file_bytes = max_file_bytes
        self._records = dict(records or {})
        self._topics: dict[str, _Topic] = {}
        self._failed = False
        self._flushed: BagMetadata | None = None
        with self._disk():
            _claim(folder)
            self._file = self._new_file()
            self._put_down()

    def add_topic(
        self,
        name: str,
        type_name: str,
        offered_qos: Sequence[OfferedQos] = (),
        *,
        type_hash: str = "",
        latched: bool = False,
        definition: str = "",
    ) -> None:
        """Make a topic known; messages of it can be written from now on.

        Args:
            name: of the topic.
            type_name: as ROS writes it, package/msg/Type.
            offered_qos: profiles of its publishers, with rosbag2's keys and words.
            type_hash: RIHS01 hash of the type, if known.
            latched: each new file begins with its last message.
            definition: of the message and all that is nested in it (ros2msg), as
                another bag has it; by default that of the installed package.

        Raises:
            BagError: no installed package defines the type.
        """
        text = definition or message_definition(type_name)
        info = TopicInfo(name, type_name, tuple(offered_qos), type_hash=type_hash)
        self._topics[name] = topic = _Topic(info, latched, text)
        self.metadata.topics.append(info)
        self._add_channel(self._file, topic)

    def write(self, message: RecordedMessage) -> None:
        """Write a message of a known topic, into a new file if this one is full.

        Raises:
            BagError: the disk is full.
        """
        if 0 < self._max_file_bytes <= self._file.stream.tell():
            self.split(message.log_ns)
        topic = self._topics[message.topic]
        if topic.latched:
            topic.last = message
        self._write(topic, message)

    def add_record(self, name: str, content: Mapping[str, str]) -> None:
        """Write an MCAP metadata record."""
        self._file.writer.add_metadata(name, dict(content))

    def attach(self, name: str, media_type: str, data: bytes, time_ns: int) -> None:
        """Write an MCAP attachment.

        Args:
            name: of the attachment, a file name.
            media_type: MIME type.
            data: its content.
            time_ns: wall clock.
        """
        self._file.writer.add_attachment(time_ns, time_ns, name, media_type, data)

    def flush(self) -> None:
        """Close the chunk and hand everything to the operating system.

        Raises:
            BagError: the disk is full.
        """
        with self._disk():
            self._flush()

    def split(self, time_ns: int) -> None:
        """Finish this file and begin the next one, with what is latched.

        Args:
            time_ns: log_time of the latched messages that are repeated.

        Raises:
            BagError: the disk is full.
        """
        with self._disk():
            self._finish_file()
            self._file = self._new_file()
            for topic in self._topics.values():
                self._add_channel(self._file, topic)
            for topic in self._topics.values():
                if topic.last is not None:
                    self._write(topic, topic.last._replace(log_ns=time_ns))
                    name = topic.info.name
                    self.repeated[name] = self.repeated.get(name, 0) + 1
            self._put_down()

    def close(self, custom: Mapping[str, str] | None = None) -> None:
        """Finish the bag.

        Args:
            custom: remarks for `metadata.yaml`.

        Raises:
            BagError: the disk is full. After an earlier error the bag is left as
                described above and nothing is raised.
        """
        self.metadata.custom.update(custom or {})
        if self._failed:
            # Without room, the metadata of the last split must do.
            with contextlib.suppress(OSError):
                write_metadata(self.folder, self.metadata)
            return
        with self._disk():
            self._finish_file()
            write_metadata(self.folder, self.metadata)

    def _flush(self) -> None:
        self._file.writer.flush()
        topics, files = self.metadata.topics, self.metadata.files
        self._flushed = BagMetadata(
            [replace(topic) for topic in topics], [replace(file) for file in files]
        )

    def _put_down(self) -> None:
        """Flush, and bring `metadata.yaml` up to date."""
        self._flush()
        write_metadata(self.folder, self.metadata)

    def _write(self, topic: _Topic, message: RecordedMessage) -> None:
        file = self._file
        file.writer.add_message(
            topic.channel,
            message.log_ns,
            message.data,
            message.publish_ns,
            message.sequence,
        )
        topic.info.message_count += 1
        info = file.info
        if info.message_count == 0:
            info.start_ns = info.end_ns = message.log_ns
        info.start_ns = min(info.start_ns, message.log_ns)
        info.end_ns = max(info.end_ns, message.log_ns)
        info.message_count += 1

    def _new_file(self) -> _File:
        number = len(self.metadata.files)
        info = FileInfo(f"{self.folder.name}_{number}.mcap")
        stream = DurableFile(self.folder / info.path)
        # The writer asks no more of a stream than what DurableFile has.
        writer = Writer(
            stream,  # type: ignore[arg-type]
            chunk_size=CHUNK_BYTES,
            compression=CompressionType.ZSTD,
            enable_data_crcs=True,  # a finished file shows any damaged byte
        )
        writer.start(profile=PROFILE, library=f"biped {version('biped')}")
        for name, content in self._records.items():
            writer.add_metadata(name, dict(content))
        self.metadata.files.append(info)
        return _File(stream, writer, info)

    def _finish_file(self) -> None:
        self._flush()
        file = self._file
        # As rosbag2 does it: a file on its own says what the bag held so far.
        content = {"serialized_metadata": metadata_text(self.metadata, with_root=False)}
        file.writer.add_metadata("rosbag2", content)
        file.writer.finish()
        file.stream.flush()
        file.stream.close()

    def _add_channel(self, file: _File, topic: _Topic) -> None:
        info = topic.info
        if info.type_name not in file.schemas:
            file.schemas[info.type_name] = file.writer.register_schema(
                info.type_name, ENCODING, topic.definition.encode()
            )
        topic.channel = file.writer.register_channel(
            info.name,
            MESSAGE_ENCODING,
            file.schemas[info.type_name],
            {
                "offered_qos_profiles": qos_text(info.offered_qos),
                "topic_type_hash": info.type_hash,
            },
        )

    @contextlib.contextmanager
    def _disk(self) -> Iterator[None]:
        """Turn what the operating system refuses into an error of the bag."""
        try:
            yield
        except OSError as error:
            self._give_up()
            raise BagError(f"{self.folder}: {error.strerror}") from error

    def _give_up(self) -> None:
        """Close the file as it was flushed last, and count only what is in it."""
        if self._flushed is not None and not self._failed:
            self.metadata = self._flushed
            self._file.stream.close()
        self._failed = True


def holds_bag(folder: Path) -> bool:
    """Return whether a folder is a bag, or has been begun as one."""
    return (folder / FILE_NAME).exists() or any(folder.glob("*.mcap"))


def fresh_folder(folder: Path) -> Path:
    """Return the folder, or with _2, _3, ... behind it the first that is no bag."""
    numbered = (folder.with_name(f"{folder.name}_{n}") for n in itertools.count(2))
    candidates = itertools.chain((folder,), numbered)
    return next(path for path in candidates if not holds_bag(path))


def _claim(folder: Path) -> None:
    """Make the folder of a bag.

    Raises:
        BagError: it holds a bag.
        OSError: it cannot be made or read.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if holds_bag(folder):
        raise BagError(f"{folder}: holds a bag already, which is never overwritten")
