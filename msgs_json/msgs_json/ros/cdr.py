"""Messages as bytes, filled in and read without building Python objects.

A message object of the 500 Hz topics takes 30 us and more to make and serialize. All
messages of such a topic are alike but for some numbers, so one is serialized as a
template, the places of its numbers are found once by marking them, and from then on
only the numbers are written or read. Everything is little-endian plain CDR.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.serialization import serialize_message

from msgs_json.timing import CONTROL_PERIOD_US

_ENCAPSULATION = 4
_MICROSECONDS_PER_SECOND = 1_000_000
_STAMP = struct.Struct("<iI")


class MessageTemplate:
    """A serialized message whose float64 fields (and stamp) can be changed."""

    def __init__(
        self, make: Callable[[Sequence[float]], Any], n_values: int, stamped: bool
    ) -> None:
        """Serialize a message and find its numbers.

        Args:
            make: builds the message from n float64 values.
            n_values: how many there are.
            stamped: the message begins with a stamp (a Clock or a Header).
        """
        marks = np.array([1e200 * (1 + i) for i in range(n_values)])
        marked = bytes(serialize_message(make(marks.tolist())))
        self._bytes = bytearray(marked)
        self._stamped = stamped
        # CDR aligns float64 to 8 bytes from the end of the encapsulation header.
        self._view = self._numbers(self._bytes)
        self._index = np.array(
            [np.flatnonzero(self._view == mark)[0] for mark in marks], dtype=np.int64
        )
        self._fixed = np.ones(len(marked), dtype=np.bool_)
        for index in self._index:
            place = _ENCAPSULATION + 8 * index
            self._fixed[place : place + 8] = False
        if stamped:
            self._fixed[_ENCAPSULATION : _ENCAPSULATION + 8] = False
        self._pattern = np.frombuffer(marked, dtype=np.uint8)[self._fixed]

    def fill(self, values: Any, clock_ticks: int = 0) -> bytes:
        """Return the message with these values and this time.

        Args:
            values: n numbers, any shape.
            clock_ticks: control ticks of the simulation's clock.
        """
        self._view[self._index] = np.ravel(values)
        if self._stamped:
            write_stamp(self._bytes, _ENCAPSULATION, clock_ticks)
        return bytes(self._bytes)

    def read(self, message: bytes) -> tuple[NDArray[np.float64], int] | None:
        """Return values and clock ticks of a message, None if it is of another form."""
        if len(message) != len(self._bytes):
            return None
        octets = np.frombuffer(message, dtype=np.uint8)
        if not np.array_equal(octets[self._fixed], self._pattern):
            return None
        view = self._numbers(message)
        ticks = read_stamp(message, _ENCAPSULATION) if self._stamped else 0
        return (view[self._index], ticks) if ticks is not None else None

    @staticmethod
    def _numbers(message: bytes | bytearray) -> NDArray[np.float64]:
        count = (len(message) - _ENCAPSULATION) // 8
        return np.frombuffer(message, dtype="<f8", offset=_ENCAPSULATION, count=count)


def write_stamp(message: bytearray, place: int, clock_ticks: int) -> None:
    """Write the time of a clock tick as seconds and nanoseconds."""
    seconds, microseconds = divmod(
        clock_ticks * CONTROL_PERIOD_US, _MICROSECONDS_PER_SECOND
    )
    _STAMP.pack_into(message, place, seconds, 1000 * microseconds)


def read_stamp(message: bytes, place: int) -> int | None:
    """Return the clock tick of a stamp, None if it lies between two ticks."""
    seconds, nanoseconds = _STAMP.unpack_from(message, place)
    microseconds, rest = divmod(nanoseconds, 1000)
    ticks, between = divmod(
        seconds * _MICROSECONDS_PER_SECOND + microseconds, CONTROL_PERIOD_US
    )
    return None if rest or between or seconds < 0 else ticks


def string_message(text: str) -> bytes:
    """Return a serialized std_msgs/String."""
    octets = text.encode()
    return b"\0\1\0\0" + struct.pack("<I", len(octets) + 1) + octets + b"\0"


def string_text(message: bytes) -> str | None:
    """Return the text of a serialized std_msgs/String, None if it is none."""
    if len(message) < 9 or message[:4] != b"\0\1\0\0":
        return None
    (length,) = struct.unpack_from("<I", message, 4)
    if length < 1 or 8 + length > len(message):
        return None
    try:
        return message[8 : 8 + length - 1].decode()
    except UnicodeDecodeError:
        return None
