"""Count what a damaged MCAP file has lost, topic by topic.

In the order of trust: the totals of a sound summary; the message index behind a damaged
chunk; the numbers that the publisher gave its messages, where they had been consecutive
so far. Where none of them tells, the count is a lower bound and says so.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mcap.records import Message

from biped_bag.recovery.report import Loss
from biped_bag.storage.mcap_record import ChannelIndex


@dataclass
class ChannelTally:
    """What is known of one channel of one file."""

    loss: Loss = field(default_factory=Loss)
    _last_ns: int = 0
    _last_number: int = 0
    _consecutive: bool = True
    _pending: int = 0
    _hole: bool = False
    _hole_known: bool = True

    def add(self, message: Message) -> None:
        """Count a message that was recovered."""
        step = message.sequence - self._last_number
        if self._hole:
            numbered = self._consecutive and self._last_number and step > 0
            self._close(message.log_time, step - 1 if numbered else None)
        elif self.loss.recovered:
            self._consecutive = self._consecutive and step == 1
        self.loss.recovered += 1
        self._last_ns = max(self._last_ns, message.log_time)
        self._last_number = message.sequence

    def add_hole(self, messages: int | None, start_ns: int = 0) -> None:
        """Count a damaged chunk of so many messages; None if not known."""
        if messages == 0:
            return
        self._hole = True
        self._hole_known = self._hole_known and messages is not None
        self._pending += messages or 0
        self._last_ns = self._last_ns or start_ns

    def finish(self, end_ns: int, total: int | None) -> None:
        """Come to the end of the file.

        Args:
            end_ns: last log time that anything in the file tells of; 0 if nothing does.
            total: messages that the file held, if a sound summary says.
        """
        if self._hole:
            self._close(max(end_ns, self._last_ns), None)
        if total is not None:
            self.loss.settle(total)

    def _close(self, until_ns: int, numbered: int | None) -> None:
        """End a hole.

        Args:
            until_ns: log time at which it ends.
            numbered: messages that are missing by their numbers, if those tell.
        """
        lost = self._pending
        if not self._hole_known:
            lost = lost if numbered is None else numbered
            self.loss.exact = self.loss.exact and numbered is not None
        self.loss.lost += lost
        if lost or not self._hole_known:
            self.loss.lost_s += 1e-9 * max(0, until_ns - self._last_ns)
        self._pending, self._hole, self._hole_known = 0, False, True


class FileTally:
    """What is known of all channels of one file."""

    def __init__(self) -> None:
        self.channels: dict[int, ChannelTally] = {}
        self._hole = False
        self._indexes: list[ChannelIndex] = []
        self._unknown_holes = 0
        self.last_ns = 0
        """Last log time that anything tells of; 0 if nothing does."""

    def channel(self, number: int) -> ChannelTally:
        """Return the tally of a channel."""
        if number not in self.channels:
            self.channels[number] = ChannelTally()
            for _ in range(self._unknown_holes):
                self.channels[number].add_hole(None)
        return self.channels[number]

    def add(self, message: Message) -> None:
        """Count a message that was recovered."""
        self.channel(message.channel_id).add(message)
        self.last_ns = max(self.last_ns, message.log_time)

    def add_hole(self, end_ns: int) -> None:
        """Count a stretch that is damaged."""
        self.settle(whole_index=False)
        self._hole = True
        self.last_ns = max(self.last_ns, end_ns)

    def add_index(self, index: ChannelIndex) -> None:
        """Take the index of a damaged chunk into account, if there is one."""
        if self._hole:
            self._indexes.append(index)

    def settle(self, *, whole_index: bool = True) -> None:
        """Come to what stands behind a hole and its indexes.

        Args:
            whole_index: it is a sound record, so that no index was passed over.
        """
        if not self._hole:
            return
        for index in self._indexes:
            self.last_ns = max(self.last_ns, index.last_ns)
            self.channel(index.channel_id).add_hole(index.messages, index.first_ns)
        if not self._indexes or not whole_index:
            self._unknown_holes += 1
            for tally in self.channels.values():
                tally.add_hole(None)
        self._hole, self._indexes = False, []

    def finish(self, end_ns: int, totals: Mapping[int, int] | None) -> None:
        """Come to the end of the file; arguments as of ChannelTally.finish."""
        self.settle(whole_index=False)
        for channel in totals or ():
            self.channel(channel)
        for number, tally in self.channels.items():
            total = None if totals is None else totals.get(number, 0)
            tally.finish(max(end_ns, self.last_ns), total)
