"""The `biped.episode` records: how each walk in the bag ended, and where it is.

The learner publishes its status and then the result of the walk. Both come over
topics of their own, so the status that belongs to a result is chosen by the times at
which they were sent: the last one before it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import msgspec

from biped_bag.storage.contents import BagMessage
from biped_ros.cdr import string_text
from msgs_json import topics
from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.wire import MalformedMessageError, decode

_STATUSES_KEPT = 32


class _Opening(msgspec.Struct):
    """What is looked at of an observation."""

    control_tick: int


class EpisodeRecords:
    """Follows the walks among the messages that are being recorded."""

    def __init__(self) -> None:
        """Start before the first walk."""
        self.finished = 0
        """Walks that have ended."""
        self._begun_ns: int | None = None
        self._statuses: deque[tuple[int, LearnerStatus]] = deque(maxlen=_STATUSES_KEPT)
        self._ended: tuple[BagMessage, EpisodeResult] | None = None

    def hear(self, messages: Sequence[BagMessage]) -> None:
        """Take note of the statuses among messages that have come, in any order."""
        for message in messages:
            if message.topic == topics.LEARNER_STATUS.name:
                try:
                    status = decode(LearnerStatus, string_text(message.data))
                except MalformedMessageError:
                    continue  # recorded, but not a status
                self._statuses.append((message.publish_ns, status))

    def follow(self, messages: Sequence[BagMessage]) -> int:
        """Follow the walk through messages, in the order of recording.

        Returns:
            How many messages there are up to the first end of a walk, or all.
        """
        for i, message in enumerate(messages):
            if message.topic == topics.OBSERVATION.name:
                self._observe(message)
            elif message.topic == topics.EPISODE.name and self._end(message):
                return i + 1
        return len(messages)

    def record(self) -> dict[str, str] | None:
        """Return the record of the walk that `follow` saw the end of, if it did."""
        if self._ended is None:
            return None
        (message, result), self._ended = self._ended, None
        self.finished += 1
        sent_ns = message.publish_ns
        before = [(at, status) for at, status in self._statuses if at <= sent_ns]
        status = max(before, key=lambda pair: pair[0])[1] if before else None
        begun_ns, self._begun_ns = self._begun_ns, None
        record = {
            "episode": str(result.episode),
            "learning": _text(result.learning),
            "end_cause": result.end_cause.value,
            "control_ticks": str(result.control_ticks),
            "target_ticks": str(result.target_ticks),
            "T_err": "" if result.cost is None else repr(result.cost.total),
            "reward": repr(result.reward),
            "walk_sha256": result.trajectory_sha256,
            "first_log_time": "" if begun_ns is None else str(begun_ns),
            "last_log_time": str(message.log_ns),
        }
        if status is not None:
            record |= {
                "frozen": _text(status.frozen),
                "learned_episodes": str(status.episodes),
                "memory_sha256": status.memory_sha256,
                "trajectory_sha256": status.trajectory_sha256,
            }
        return record

    def _observe(self, message: BagMessage) -> None:
        try:
            text = string_text(message.data)
            opening = msgspec.json.decode(text, type=_Opening)
        except (MalformedMessageError, msgspec.DecodeError):
            return  # recorded, but not an observation
        if opening.control_tick == 0:
            self._begun_ns = message.log_ns

    def _end(self, message: BagMessage) -> bool:
        try:
            result = decode(EpisodeResult, string_text(message.data))
        except MalformedMessageError:
            return False  # recorded, but not a result
        self._ended = (message, result)
        return True


def _text(flag: bool) -> str:
    return "true" if flag else "false"
