"""Lead a learner through a bag's observations, and compare what it answers.

The learner is that of `learner_node.node`, with the settings, the seed and, where the
run went on from one, the checkpoint that the bag holds. It must give every recorded
correction and every result again, bit for bit.

What is found, and what it means:
    a correction or a result differs, or one of the two sides has none: a difference.
    an observation is not in the bag, though it was answered: a difference; what a
        learner makes of the rest cannot be known, so the rest is not checked.
    the bag begins in the middle of a run, or a learner was started again meanwhile: the
        memory of that moment is not in the bag, so what follows is not checked.
    the bag ends in the middle of a walk: what there is, is checked, and the verdict
        says that it is not all.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable

import msgspec

from biped_bag.verification.cost import recomputed_cost
from biped_bag.verification.report import Verification, WalkCheck
from biped_bag.verification.walks import RecordedWalk, recorded_walks
from biped_common.timing import TICKS_PER_LEARNING_TICK
from learner_node.walking.session import LearningSession
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation

_CORRECTION = "correction [m]"


def verify(
    session: LearningSession, messages: Iterable[tuple[str, bytes]]
) -> Verification:
    """Compare a bag with what a learner answers.

    Args:
        session: as it stood when the recorded run began.
        messages: topic and serialized message, in the order recorded.

    Raises:
        MalformedMessageError: a message is not what its topic carries.
    """
    replay = _Replay(session)
    walks = itertools.chain(recorded_walks(messages), [None])
    return Verification(
        tuple(
            replay.check(walk, last=following is None)
            for walk, following in itertools.pairwise(walks)
            if walk is not None
        )
    )


class _Replay:
    """A learner that goes through the recorded run."""

    def __init__(self, session: LearningSession) -> None:
        self._session = session
        self._lost: str | None = None
        """Why the session is not where the recorded learner was, once it is not."""
        self._learner: str | None = None
        self._before: Observation | None = None

    def check(self, walk: RecordedWalk, *, last: bool) -> WalkCheck:
        """Check the next walk; the bag's last one may be cut short."""
        check = WalkCheck(
            walk.number,
            walk.episode,
            None if walk.result is None else walk.result.learning,
            len(walk.corrections),
        )
        whole = walk.observations[0].control_tick == 0
        self._lost = self._lost or self._not_followed(walk)
        if self._lost is None and not whole:
            check.not_checked = "its beginning is not in the bag"
            if not _without_learning(walk):
                self._lost = _not_in_the_bag(f"the beginning of walk {walk.number}")
        elif self._lost is not None:
            check.not_checked = self._lost
        elif walk.corrections or walk.result is not None:
            self._compare(walk, last, check)
        if whole:
            check.cost = recomputed_cost(walk, self._session.settings.cost)
        self._before = walk.observations[-1]
        return check

    # -- does the session know what the recorded learner knew? ----------------------

    def _not_followed(self, walk: RecordedWalk) -> str | None:
        """Return what the recorded learner knew and the session does not, if any."""
        known, self._learner = self._learner, min(walk.learners, default=self._learner)
        if len(walk.learners | {known or self._learner}) > 1:
            return _not_in_the_bag(
                f"the memory from which the learner went on, when it was started again "
                f"in walk {walk.number},"
            )
        first, before = walk.observations[0], self._before
        if before is None:
            return self._not_the_beginning(walk)
        gap = first.simulation == before.simulation and (
            first.episode > before.episode + 1
        )
        if gap and not _frozen_by_user(walk):
            return _not_in_the_bag(
                f"what was learned in walks {before.episode + 1} to {first.episode - 1}"
            )
        return None

    def _not_the_beginning(self, walk: RecordedWalk) -> str | None:
        session, status = self._session, walk.status
        same_memory = status is None or (
            status.episodes == session.episodes
            and status.memory_sha256 == session.memory_sha256()
        )
        if same_memory and (walk.episode == 1 or _frozen_by_user(walk)):
            return None
        return _not_in_the_bag(
            f"the learner's memory of the moment when the bag begins, walk "
            f"{walk.episode} of a run,"
        )

    # -- a walk, observation by observation -----------------------------------------

    def _compare(self, walk: RecordedWalk, last: bool, check: WalkCheck) -> None:
        session = self._session
        session.frozen = _without_learning(walk) and not session.trial_due
        expected = dict(walk.corrections)
        previous = walk.observations[0]
        result: EpisodeResult | None = None
        for observation in walk.observations:
            gap = observation.control_tick - previous.control_tick
            if gap > TICKS_PER_LEARNING_TICK:
                self._stop_at_hole(walk, check, previous)
                return
            previous = observation
            answer = session.respond(observation)
            if isinstance(answer, EpisodeResult):
                result = result or answer
                continue
            recorded = expected.pop(observation.clock_ticks, None)
            if recorded is None:
                # The recording may have ended between the two.
                if not (last and observation is walk.observations[-1]):
                    check.differ(observation, _CORRECTION, None, answer.tolist())
            elif recorded.tobytes() == answer.tobytes():
                check.identical += 1
            else:
                both = recorded.tolist(), answer.tolist()
                check.differ(observation, _CORRECTION, *both)
        if result is None and (walk.result is not None or not last):
            self._stop_at_hole(walk, check, previous)
        elif result != walk.result and not (last and walk.result is None):
            check.differ(
                previous, "result", *map(msgspec.to_builtins, (walk.result, result))
            )
        for clock_ticks in sorted(expected):
            since = clock_ticks - previous.clock_ticks
            value_m = expected[clock_ticks].tolist()
            check.differ(previous, _CORRECTION, value_m, None, since)

    def _stop_at_hole(
        self, walk: RecordedWalk, check: WalkCheck, before: Observation
    ) -> None:
        check.differ(
            before,
            "observation",
            None,
            "one must have been there",
            TICKS_PER_LEARNING_TICK,
        )
        check.not_checked = "an observation is missing; the rest is not checked"
        if not _without_learning(walk):
            self._lost = _not_in_the_bag(f"an observation of walk {walk.number}")


def _without_learning(walk: RecordedWalk) -> bool:
    """Return whether the learner walked greedily, as its result or its status says."""
    if walk.result is not None:
        return not walk.result.learning
    return walk.status is not None and walk.status.frozen


def _frozen_by_user(walk: RecordedWalk) -> bool:
    return walk.status is not None and walk.status.frozen and _without_learning(walk)


def _not_in_the_bag(what: str) -> str:
    return f"{what} is not in the bag"
