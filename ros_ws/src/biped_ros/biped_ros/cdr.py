"""Messages as bytes, filled in and read without building Python objects.

A message object of the 500 Hz topics takes 30 us and more to make and serialize. All
messages of such a topic are alike but for some numbers: one is written as a template,
and from then on only its numbers are set or read. Little-endian plain CDR.
"""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from biped_common.timing import CONTROL_PERIOD_US
from msgs_json.wire import MalformedMessageError

_ENCAPSULATION = 4
_MICROSECONDS_PER_SECOND = 1_000_000
_STAMP = struct.Struct("<iI")


class MessageTemplate:
    """A serialized message, written field by field, whose numbers can be changed.

    Fields are appended in the order of the message definition. `value` appends a
    float64 that `fill` sets and `read` returns; everything else stays as written.
    """

    def __init__(self, *, stamped: bool) -> None:
        """Begin a message.

        Args:
            stamped: it begins with a stamp (a Clock or a Header).
        """
        self._bytes = bytearray(b"\0\1\0\0")
        self._values: list[int] = []
        self._loose: list[int] = [2, 3]
        self._stamps: list[int] = []
        if stamped:
            self.stamp()

    def stamp(self) -> MessageTemplate:
        """Append a time, that of the clock ticks given to `fill`."""
        self._align(4)
        self._stamps.append(len(self._bytes))
        self._loose += range(len(self._bytes), len(self._bytes) + _STAMP.size)
        self._bytes += bytes(_STAMP.size)
        return self

    def octet(self, number: int) -> MessageTemplate:
        """Append a uint8 or a bool."""
        self._bytes.append(number)
        return self

    def integer(self, number: int) -> MessageTemplate:
        """Append a (u)int32, the length of a sequence among them."""
        self._align(4)
        self._bytes += struct.pack("<i", number)
        return self

    def text(self, text: str) -> MessageTemplate:
        """Append a string."""
        octets = text.encode() + b"\0"
        self.integer(len(octets))
        self._bytes += octets
        return self

    def single(self, number: float) -> MessageTemplate:
        """Append a float32 that does not change."""
        self._align(4)
        self._bytes += struct.pack("<f", number)
        return self

    def constant(self, number: float) -> MessageTemplate:
        """Append a float64 that does not change."""
        self._align(8)
        self._bytes += struct.pack("<d", number)
        return self

    def value(self) -> MessageTemplate:
        """Append a float64 that changes."""
        self._align(8)
        self._values.append((len(self._bytes) - _ENCAPSULATION) // 8)
        self._loose += range(len(self._bytes), len(self._bytes) + 8)
        self._bytes += bytes(8)
        return self

    def finished(self) -> MessageTemplate:
        """Prepare for use; nothing can be appended any more."""
        # float64 fields lie on multiples of 8 bytes behind the encapsulation header.
        self._view = self._numbers(self._bytes)
        self._index = np.array(self._values, dtype=np.int64)
        self._fixed = np.ones(len(self._bytes), dtype=np.bool_)
        self._fixed[self._loose] = False
        self._pattern = np.frombuffer(self._bytes, dtype=np.uint8)[self._fixed]
        return self

    def __len__(self) -> int:
        """Return the size of the message in bytes."""
        return len(self._bytes)

    def _align(self, size: int) -> None:
        # Other writers leave anything in the padding.
        padding = -(len(self._bytes) - _ENCAPSULATION) % size
        self._loose += range(len(self._bytes), len(self._bytes) + padding)
        self._bytes += bytes(padding)

    def fill(self, values: Any, clock_ticks: int = 0) -> bytes:
        """Return the message with these values and this time.

        Args:
            values: n numbers, any shape.
            clock_ticks: control ticks of the simulation's clock.
        """
        self._view[self._index] = np.ravel(values)
        for place in self._stamps:
            write_stamp(self._bytes, place, clock_ticks)
        return bytes(self._bytes)

    def read(self, message: bytes) -> tuple[NDArray[np.float64], int] | None:
        """Return values and clock ticks of a message, None if it is of another form.

        Of several stamps, the first counts.
        """
        # The middleware may pad to four bytes and says so in the options.
        if not 0 <= len(message) - len(self._bytes) < 4:
            return None
        octets = np.frombuffer(message, dtype=np.uint8, count=len(self._bytes))
        if not np.array_equal(octets[self._fixed], self._pattern):
            return None
        view = self._numbers(message)
        ticks = read_stamp(message, self._stamps[0]) if self._stamps else 0
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


def string_text(message: bytes) -> str:
    """Return the text of a serialized std_msgs/String.

    Raises:
        MalformedMessageError: the bytes are no such message.
    """
    if len(message) >= 9 and message[:2] == b"\0\1":
        (length,) = struct.unpack_from("<I", message, 4)
        if 1 <= length <= len(message) - 8:
            try:
                return message[8 : 8 + length - 1].decode()
            except UnicodeDecodeError as error:
                raise MalformedMessageError(f"String: {error}") from None
    raise MalformedMessageError("String: the bytes are no serialized text")
