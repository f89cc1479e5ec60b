"""One MCAP file of a bag while it is written, and what is in it so far."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path

from mcap.records import Attachment
from mcap.well_known import Profile, SchemaEncoding
from mcap.writer import CompressionType, Writer

from biped_bag.storage.append_file import AppendFile
from biped_bag.storage.contents import BagMessage, BagTopic, channel_metadata
from biped_bag.storage.metadata import FileInfo

# Small chunks: what is not in a finished chunk is lost when the recorder is killed.
_CHUNK_BYTES = 64 * 1024


class DataFile:
    """An MCAP file, zstd in chunks, with checksums over all of it."""

    def __init__(self, path: Path, records: Mapping[str, Mapping[str, str]]) -> None:
        """Begin the file.

        Args:
            path: of the file, in the bag's folder; must not exist.
            records: MCAP metadata that it begins with, by name.

        Raises:
            OSError: it cannot be made.
        """
        self.info = FileInfo(path.name)
        self._stream = AppendFile(path)
        # The writer asks no more of a stream than what AppendFile has.
        self._writer = Writer(
            self._stream,  # type: ignore[arg-type]
            chunk_size=_CHUNK_BYTES,
            compression=CompressionType.ZSTD,
            enable_data_crcs=True,  # a finished file shows any damaged byte
        )
        self._writer.start(profile=Profile.ROS2, library=f"biped {version('biped')}")
        self._schemas: dict[str, int] = {}
        for name, content in records.items():
            self.add_record(name, content)

    @property
    def size(self) -> int:
        """Bytes, without those of the chunk that is being filled."""
        return self._stream.tell()

    def add_channel(self, topic: BagTopic) -> int:
        """Make a topic known; return the number of its channel."""
        if topic.type_name not in self._schemas:
            self._schemas[topic.type_name] = self._writer.register_schema(
                topic.type_name, SchemaEncoding.ROS2, topic.definition.encode()
            )
        return self._writer.register_channel(
            topic.name,
            topic.encoding,
            self._schemas[topic.type_name],
            channel_metadata(topic),
        )

    def write(self, channel: int, message: BagMessage) -> None:
        """Write a message."""
        self._writer.add_message(
            channel,
            message.log_ns,
            message.data,
            message.publish_ns,
            message.sequence,
        )
        info = self.info
        if info.message_count == 0:
            info.start_ns = info.end_ns = message.log_ns
        info.start_ns = min(info.start_ns, message.log_ns)
        info.end_ns = max(info.end_ns, message.log_ns)
        info.message_count += 1

    def add_record(self, name: str, content: Mapping[str, str]) -> None:
        """Write an MCAP metadata record."""
        self._writer.add_metadata(name, dict(content))

    def attach(self, item: Attachment) -> None:
        """Write an MCAP attachment."""
        self._writer.add_attachment(
            item.create_time, item.log_time, item.name, item.media_type, item.data
        )

    def flush(self) -> None:
        """Close the chunk and hand everything to the operating system.

        Raises:
            OSError: the disk is full.
        """
        self._writer.flush()

    def finish(self) -> None:
        """Write the summary and close.

        Raises:
            OSError: the disk is full.
        """
        self._writer.finish()
        self._stream.flush()
        self._stream.close()

    def abandon(self) -> None:
        """Close the file as it was flushed last."""
        self._stream.close()
