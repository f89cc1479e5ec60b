"""Messages of several files in the order of their log times, a chunk at a time.

A chunk is read when its turn comes, and its messages wait until no later chunk can hold
an earlier one. How many wait depends on how far chunks overlap; it has a bound.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import IO, NamedTuple

from mcap.opcode import Opcode
from mcap.records import Message

from biped_bag.errors import BagError
from biped_bag.storage.contents import BagMessage
from biped_bag.storage.mcap_record import (
    DamagedRecordError,
    place_of,
    records_in,
    stored_chunk,
    unpacked,
)
from biped_bag.storage.summary import Block

MOST_WAITING_BYTES = 128 * 2**20
"""Of messages that wait for their turn, with what Python adds to each."""
_BYTES_PER_MESSAGE = 400


class Source(NamedTuple):
    """A file, and what of it is wanted."""

    file: Path
    topics: Mapping[int, str]
    """Names of the topics that are wanted, by number of channel."""
    blocks: Sequence[Block]


class _Waiting(NamedTuple):
    """A message, behind all by which it is ordered."""

    log_ns: int
    source: int
    at: int
    """Of its block in the file."""
    number: int
    """In its block."""
    message: BagMessage


def in_order(
    sources: Sequence[Source], start_ns: int | None, end_ns: int | None
) -> Iterator[BagMessage]:
    """Yield the messages of all sources.

    Args:
        sources: of the messages.
        start_ns: log time to start at.
        end_ns: log time to end before.

    Raises:
        BagError: too many messages would have to wait.
        DamagedRecordError: a chunk is damaged.
    """
    blocks = sorted(
        (block.start_ns, number, block)
        for number, source in enumerate(sources)
        for block in source.blocks
        if (start_ns is None or block.end_ns >= start_ns)
        and (end_ns is None or block.start_ns < end_ns)
    )
    waiting: list[_Waiting] = []
    size = 0
    with ExitStack() as stack:
        streams: dict[int, IO[bytes]] = {}
        for block_start_ns, number, block in blocks:
            due = 0
            while due < len(waiting) and waiting[due].log_ns < block_start_ns:
                size -= _size(waiting[due])
                yield waiting[due].message
                due += 1
            del waiting[:due]
            source = sources[number]
            if number not in streams:
                streams[number] = stack.enter_context(source.file.open("rb"))
            for found in _messages(streams[number], source, number, block):
                if (start_ns is None or found.log_ns >= start_ns) and (
                    end_ns is None or found.log_ns < end_ns
                ):
                    waiting.append(found)
                    size += _size(found)
                if size > MOST_WAITING_BYTES:
                    raise BagError(
                        f"{source.file}: more than {MOST_WAITING_BYTES} bytes of "
                        "messages overlap in time, too many to be put in order"
                    )
            waiting.sort()
    for found in waiting:
        yield found.message


def _messages(
    stream: IO[bytes], source: Source, number: int, block: Block
) -> Iterator[_Waiting]:
    stream.seek(block.at)
    data = stream.read(block.end - block.at)
    try:
        if data[:1] == bytes([Opcode.CHUNK]):
            place = place_of(data, 0, len(data))
            chunk = stored_chunk(data, place.body)
            data = unpacked(
                chunk, data[chunk.data_at : chunk.data_at + chunk.data_bytes]
            )
        for i, record in enumerate(records_in(data)):
            if isinstance(record, Message) and record.channel_id in source.topics:
                message = BagMessage(
                    source.topics[record.channel_id],
                    record.data,
                    record.log_time,
                    record.publish_time,
                    record.sequence,
                )
                yield _Waiting(record.log_time, number, block.at, i, message)
    except DamagedRecordError as error:
        raise DamagedRecordError(
            f"{source.file}: the chunk at byte {block.at}: {error}"
        ) from None


def _size(waiting: _Waiting) -> int:
    return len(waiting.message.data) + _BYTES_PER_MESSAGE
