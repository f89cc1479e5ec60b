"""A bag's messages gathered walk by walk.

Messages of different topics are recorded in about, but not exactly, the order in which
they were sent: a walk is put together by stamps, once the walk after it has ended.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from biped_bag.errors import BagError
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


# Of what waits for its walk; a walk has at most 255,000 control ticks.
_MOST_OBSERVATIONS = 30_000
_MOST_WAITING = 100_000
_WALKS_WAITING = 4
_MOST_OF_ONE = 32


class ImpossibleWalkError(BagError):
    """A recorded walk cannot have been walked; the text says which, and why."""


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
    results: list[EpisodeResult] = field(default_factory=list)
    """The learner's; more of them where strangers spoke, too."""
    statuses: dict[str, LearnerStatus] = field(default_factory=dict)
    """What learners had last said of themselves when the walk began, by name."""
    heard: list[str] = field(default_factory=list)
    """Names of learners that said they take part, in order, at its beginning and in
    it."""
    corrections: dict[int, list[NDArray[np.float64]]] = field(default_factory=dict)
    """(2,) dx and dy [m], by clock tick; several where strangers spoke, too."""
    samples: dict[str, Samples] = field(default_factory=dict)
    """By topic of MEASURED."""

    @property
    def episode(self) -> int:
        """Number of the walk as the simulation counts."""
        return self.observations[0].episode

    @property
    def result(self) -> EpisodeResult | None:
        """The first result that is about what the robot walked, or else the first."""
        walked = self.observations[-1].trajectory_sha256
        about = [each for each in self.results if each.trajectory_sha256 == walked]
        return next(iter((*about, *self.results)), None)


class RecordedWalks:
    """The walks of a bag, and what is no part of any."""

    def __init__(self, messages: Iterable[tuple[str, bytes]]) -> None:
        """Prepare.

        Args:
            messages: topic and serialized message, in the order recorded; topics that
                are not WANTED are passed over.
        """
        self._messages = messages
        self.not_understood: Counter[str] = Counter()
        """Messages that no node understands, and none acted on, by topic."""

    def __iter__(self) -> Iterator[RecordedWalk]:
        """Yield the walks, in order."""
        gathering = _Gathering()
        for topic, message in self._messages:
            try:
                yield from gathering.take(topic, message)
            except MalformedMessageError:
                self.not_understood[topic] += 1
        yield from gathering.rest()


class _Gathering:
    """Walks that are not complete yet, and messages that belong to none yet."""

    def __init__(self) -> None:
        self._walks: list[RecordedWalk] = []
        self._count = 0
        self._statuses: dict[str, LearnerStatus] = {}
        self._corrections: dict[int, list[NDArray[np.float64]]] = {}
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
            pool = self._samples[topic]
            if len(pool) < _MOST_WAITING:
                pool[clock_ticks] = values
        elif topic == topics.OBSERVATION.name:
            yield from self._observe(decode(Observation, string_text(message)))
        elif topic == topics.CORRECTION.name:
            _, clock_ticks, value_m = correction_of(message)
            if len(self._corrections) < _MOST_WAITING:
                given = self._corrections.setdefault(clock_ticks, [])
                if len(given) < _MOST_OF_ONE:
                    given.append(value_m)
        elif topic == topics.EPISODE.name:
            yield from self._end(decode(EpisodeResult, string_text(message)))
        elif topic == topics.LEARNER_STATUS.name:
            self._hear(decode(LearnerStatus, string_text(message)))

    def rest(self) -> Iterator[RecordedWalk]:
        """Yield the walks that nothing more will come for."""
        yield from self._completed(all_but=0)
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
            yield from self._completed(all_but=_WALKS_WAITING)
            self._count += 1
            learners = list(self._statuses)
            walk = RecordedWalk(
                self._count, [], statuses=dict(self._statuses), heard=learners[-1:]
            )
            self._walks.append(walk)
        observations = self._walks[-1].observations
        if len(observations) == _MOST_OBSERVATIONS:
            raise ImpossibleWalkError(
                f"walk {self._count}: has more than {_MOST_OBSERVATIONS} observations"
            )
        observations.append(observation)

    def _hear(self, status: LearnerStatus) -> None:
        # The one that spoke last stands last.
        self._statuses.pop(status.instance, None)
        self._statuses[status.instance] = status
        if len(self._statuses) > _MOST_OF_ONE:
            del self._statuses[next(iter(self._statuses))]
        if self._walks:
            heard = self._walks[-1].heard
            if heard[-1:] != [status.instance] and len(heard) < _MOST_WAITING:
                heard.append(status.instance)

    def _end(self, result: EpisodeResult) -> Iterator[RecordedWalk]:
        for walk in self._walks:
            if walk.episode == result.episode and len(walk.results) < _MOST_OF_ONE:
                walk.results.append(result)
        while len(self._walks) > 1 and self._walks[1].results:
            yield from self._completed(all_but=len(self._walks) - 1)

    def _completed(self, all_but: int) -> Iterator[RecordedWalk]:
        """Yield the oldest walks, each with all messages up to its last observation."""
        while len(self._walks) > all_but:
            walk = self._walks.pop(0)
            self._complete(walk)
            yield walk

    def _complete(self, walk: RecordedWalk) -> None:
        first, last = walk.observations[0], walk.observations[-1]
        begin, end = first.clock_ticks - first.control_tick, last.clock_ticks
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
