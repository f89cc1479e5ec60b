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
import shutil
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from mcap.records import Attachment
from mcap.well_known import MessageEncoding

from biped_bag.errors import BagError
from biped_bag.storage.contents import BagMessage, BagTopic
from biped_bag.storage.data_file import DataFile
from biped_bag.storage.definitions import message_definition
from biped_bag.storage.layout import holds_bag
from biped_bag.storage.metadata import (
    OWN_RECORD,
    BagMetadata,
    FileInfo,
    metadata_text,
    write_metadata,
)


@dataclass
class _Channel:
    """A topic in the file that is being written."""

    topic: BagTopic
    number: int
    latched: bool
    count: int = 0
    """Messages in the bag."""
    last: BagMessage | None = None
    """The last message of a latched topic."""


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
        self.repeated: Counter[str] = Counter()
        """Latched messages written again at the start of a file, by topic; they are
        part of all counts in `metadata`."""
        self._max_file_bytes = max_file_bytes
        self._records = dict(records or {})
        self._channels: dict[str, _Channel] = {}
        self._files: list[FileInfo] = []
        self._failed = False
        self._flushed = BagMetadata()
        with self._disk():
            folder.mkdir(parents=True, exist_ok=True)
            if holds_bag(folder):
                raise BagError(
                    f"{folder}: holds a bag already, which is never overwritten"
                )
            self._begin_file()

    @property
    def metadata(self) -> BagMetadata:
        """What is in the bag; after an error, what was flushed before it."""
        return self._flushed if self._failed else self._present()

    def add_topic(self, topic: BagTopic) -> None:
        """Make a topic known; messages of it can be written from now on.

        Args:
            topic: without a definition, it gets that of the installed package; if it is
                latched, each new file begins with its last message.

        Raises:
            BagError: its messages are not CDR, or no installed package defines them.
        """
        if topic.encoding != MessageEncoding.CDR:
            raise BagError(
                f"{topic.name}: messages are encoded as {topic.encoding or 'nothing'}, "
                f"but must be {MessageEncoding.CDR}"
            )
        definition = topic.definition or message_definition(topic.type_name)
        topic = replace(topic, definition=definition)
        number = self._file.add_channel(topic)
        self._channels[topic.name] = _Channel(topic, number, topic.latched)

    def write(self, message: BagMessage) -> None:
        """Write a message of a known topic, into a new file if this one is full.

        Raises:
            BagError: the disk is full.
        """
        if 0 < self._max_file_bytes <= self._file.size:
            self.split(message.log_ns)
        channel = self._channels[message.topic]
        if channel.latched:
            channel.last = message
        self._write(channel, message)

    def add_record(self, name: str, content: Mapping[str, str]) -> None:
        """Write an MCAP metadata record."""
        self._file.add_record(name, content)

    def attach(self, item: Attachment) -> None:
        """Write an MCAP attachment."""
        self._file.attach(item)

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
            self._finish_file(self._present())
            self._begin_file(time_ns)

    def close(self, custom: Mapping[str, str] | None = None) -> None:
        """Finish the bag.

        Args:
            custom: remarks for `metadata.yaml`.

        Raises:
            BagError: the disk is full. After an earlier error the bag is left as
                described above and nothing is raised.
        """
        metadata = replace(self.metadata, custom=custom or {})
        if self._failed:
            # Without room, the metadata of the last split must do.
            with contextlib.suppress(OSError):
                write_metadata(self.folder, metadata)
            return
        with self._disk():
            self._finish_file(metadata)
            write_metadata(self.folder, metadata)

    def _present(self) -> BagMetadata:
        """Return what has been written, flushed or not."""
        return BagMetadata(
            [replace(c.topic, count=c.count) for c in self._channels.values()],
            [replace(info) for info in self._files],
        )

    def _begin_file(self, time_ns: int = 0) -> None:
        path = self.folder / f"{self.folder.name}_{len(self._files)}.mcap"
        self._file = DataFile(path, self._records)
        self._files.append(self._file.info)
        for channel in self._channels.values():
            channel.number = self._file.add_channel(channel.topic)
        for name, channel in self._channels.items():
            if channel.last is not None:
                self._write(channel, channel.last._replace(log_ns=time_ns))
                self.repeated[name] += 1
        self._flush()
        write_metadata(self.folder, self._present())

    def _write(self, channel: _Channel, message: BagMessage) -> None:
        self._file.write(channel.number, message)
        channel.count += 1

    def _flush(self) -> None:
        self._file.flush()
        self._flushed = self._present()

    def _finish_file(self, metadata: BagMetadata) -> None:
        self._flush()
        # As rosbag2 does it: a file on its own says what the bag held so far.
        content = {"serialized_metadata": metadata_text(metadata, with_root=False)}
        self.add_record(OWN_RECORD, content)
        self._file.finish()

    @contextlib.contextmanager
    def _disk(self) -> Iterator[None]:
        """Turn what the operating system refuses into an error of the bag."""
        try:
            yield
        except OSError as error:
            self._failed = True
            if self._files:
                self._file.abandon()
            raise BagError(f"{self.folder}: {error.strerror}") from error


@contextlib.contextmanager
def new_bag(out: Path) -> Iterator[BagWriter]:
    """Write a bag that is gone again when the block fails; the block closes it.

    Raises:
        BagError: it cannot be written there.
    """
    writer = BagWriter(out)
    try:
        yield writer
    except BaseException:
        with contextlib.suppress(BagError):
            writer.close()
        shutil.rmtree(out, ignore_errors=True)
        raise
