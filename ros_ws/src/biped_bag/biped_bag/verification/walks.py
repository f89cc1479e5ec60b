"""A bag's messages gathered walk by walk.

Messages of different topics are recorded in about, but not exactly, the order in which
they were sent: a walk is put together by stamps, once the walk after it has ended.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from biped_description.joints import JOINT_NAMES
from biped_ros.cdr import MessageTemplate, string_text
from biped_ros.messages import (
    correction_of,
    joint_state_template,
    point_template,
)
from msgs_json import topics
from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation
from msgs_json.wire import MalformedMessageError, decode

MEASURED = (
    topics.ZMP.name,
    topics.ZMP_REFERENCE.name,
    topics.JOINT_STATES.name,
    topics.JOINT_REFERENCES.name,
)
"""The 500 Hz topics from which T_err can be computed anew."""
WANTED = (
    topics.OBSERVATION.name,
    topics.CORRECTION.name,
    topics.EPISODE.name,
    topics.LEARNER_STATUS.name,
    *MEASURED,
)
"""All topics that `recorded_walks` uses."""


class Samples(NamedTuple):
    """The messages of a 500 Hz topic within a walk, by control tick."""

    control_ticks: NDArray[np.int64]
    """(n,) since the walk began, ascending."""
    values: NDArray[np.float64]
    """(n, m), in the order of the message's fields."""


@dataclass
class RecordedWalk:
    """One walk as far as it is in the bag."""

    number: int
    """1 for the bag's first."""
    observations: list[Observation]
    result: EpisodeResult | None = None
    status: LearnerStatus | None = None
    """What the learner had last said of itself when the walk began."""
    learners: set[str] = field(default_factory=set)
    """Names of those that took part."""
    corrections: dict[int, NDArray[np.float64]] = field(default_factory=dict)
    """(2,) dx and dy [m], by clock tick."""
    samples: dict[str, Samples] = field(default_factory=dict)
    """By topic of MEASURED."""

    @property
    def episode(self) -> int:
        """Number of the walk as the simulation counts."""
        return self.observations[0].episode


def recorded_walks(messages: Iterable[tuple[str, bytes]]) -> Iterator[RecordedWalk]:
    """Yield the walks of a bag, in order.

    Args:
        messages: topic and serialized message, in the order recorded; topics that are
            not WANTED are passed over.

    Raises:
        MalformedMessageError: a message is not what its topic carries.
    """
    gathering = _Gathering()
    for topic, message in messages:
        try:
            yield from gathering.take(topic, message)
        except MalformedMessageError as error:
            raise MalformedMessageError(f"{topic}: {error}") from None
    yield from gathering.rest()


class _Gathering:
    """Walks that are not complete yet, and messages that belong to none yet."""

    def __init__(self) -> None:
        self._walks: list[RecordedWalk] = []
        self._count = 0
        self._status: LearnerStatus | None = None
        self._corrections: dict[int, NDArray[np.float64]] = {}
        self._samples: dict[str, dict[int, NDArray[np.float64]]] = {
            topic: {} for topic in MEASURED
        }
        point = point_template()
        self._templates: dict[str, MessageTemplate] = {
            topics.ZMP.name: point,
            topics.ZMP_REFERENCE.name: point,
            topics.JOINT_STATES.name: joint_state_template(
                JOINT_NAMES, with_effort=True
            ),
            topics.JOINT_REFERENCES.name: joint_state_template(
                JOINT_NAMES, with_effort=False
            ),
        }

    def take(self, topic: str, message: bytes) -> Iterator[RecordedWalk]:
        """Take in a message; yield the walks that are complete by it."""
        if topic in self._templates:
            read = self._templates[topic].read(message)
            if read is None:
                raise MalformedMessageError("not a message of the form that sim writes")
            values, clock_ticks = read
            self._samples[topic][clock_ticks] = values
        elif topic == topics.OBSERVATION.name:
            yield from self._observe(decode(Observation, string_text(message)))
        elif topic == topics.CORRECTION.name:
            _, clock_ticks, value_m = correction_of(message)
            self._corrections[clock_ticks] = value_m
        elif topic == topics.EPISODE.name:
            yield from self._end(decode(EpisodeResult, string_text(message)))
        elif topic == topics.LEARNER_STATUS.name:
            self._status = decode(LearnerStatus, string_text(message))
            self._take_part(self._status)

    def rest(self) -> Iterator[RecordedWalk]:
        """Yield the walks that nothing more will come for."""
        while self._walks:
            yield self._completed(self._walks.pop(0))
        self._corrections.clear()
        for samples in self._samples.values():
            samples.clear()

    def _observe(self, observation: Observation) -> Iterator[RecordedWalk]:
        last = self._walks[-1].observations[-1] if self._walks else None
        if last is not None and observation.simulation != last.simulation:
            # A simulation that was started anew counts its clock from 0 again.
            yield from self.rest()
            last = None
        if last is not None and observation.clock_ticks <= last.clock_ticks:
            return  # sent twice; the nodes refuse it, too
        if last is None or observation.episode != last.episode:
            self._count += 1
            self._walks.append(RecordedWalk(self._count, [], status=self._status))
            self._take_part(self._status)
        self._walks[-1].observations.append(observation)

    def _take_part(self, status: LearnerStatus | None) -> None:
        if self._walks and status is not None:
            self._walks[-1].learners.add(status.instance)

    def _end(self, result: EpisodeResult) -> Iterator[RecordedWalk]:
        for walk in self._walks:
            if walk.result is None and walk.episode == result.episode:
                walk.result = result
        while len(self._walks) > 1 and self._walks[1].result is not None:
            yield self._completed(self._walks.pop(0))

    def _completed(self, walk: RecordedWalk) -> RecordedWalk:
        """Hand the walk all messages up to its last observation."""
        first = walk.observations[0]
        begin = first.clock_ticks - first.control_tick
        end = walk.observations[-1].clock_ticks
        walk.corrections = {
            tick: self._corrections.pop(tick)
            for tick in sorted(self._corrections)
            if tick <= end
        }
        for topic, pool in self._samples.items():
            ticks = sorted(tick for tick in pool if tick <= end)
            rows = [pool.pop(tick) for tick in ticks]
            control_ticks = np.array(ticks, dtype=np.int64) - begin
            inside = control_ticks > 0
            if inside.any():
                walk.samples[topic] = Samples(
                    control_ticks[inside], np.array(rows)[inside]
                )
        return walk
