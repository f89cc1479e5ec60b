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
    a message that the nodes refuse, since they do not understand it or it is for no
        observation, out of range or of another learner: it is counted; no difference.
    the robot gave up a walk, for a cause that comes from outside: what was answered is
        compared, and an answer that did not come any more is no difference.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Mapping

import msgspec
import numpy as np
from numpy.typing import NDArray

from biped_bag.verification.cost import recomputed_cost
from biped_bag.verification.report import Verification, WalkCheck
from biped_bag.verification.walks import (
    ImpossibleWalkError,
    RecordedWalk,
    RecordedWalks,
)
from biped_common.timing import TICKS_PER_LEARNING_TICK
from learner_node.checkpoint import MOST_BYTES
from learner_node.walking.session import LearningSession
from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation

_CORRECTION = "correction [m]"
_DECISIONS_BETWEEN_LOOKS = 100  # at the size of the learner's memory


def verify(
    session: LearningSession, messages: Iterable[tuple[str, bytes]]
) -> Verification:
    """Compare a bag with what a learner answers.

    Args:
        session: as it stood when the recorded run began.
        messages: topic and serialized message, in the order recorded.

    Raises:
        ImpossibleWalkError: a walk holds more, or other numbers, than any can have.
    """
    replay = _Replay(session)
    walks = RecordedWalks(messages)
    checks = []
    for walk, following in itertools.pairwise(itertools.chain(walks, [None])):
        if walk is not None:
            try:
                checks.append(replay.check(walk, following))
            except (ArithmeticError, ValueError) as error:
                raise ImpossibleWalkError(f"walk {walk.number}: {error}") from None
    return Verification(tuple(checks), walks.not_understood)


class _Replay:
    """A learner that goes through the recorded run."""

    def __init__(self, session: LearningSession) -> None:
        self._session = session
        self._lost: str | None = None
        """Why the session is not where the recorded learner was, once it is not."""
        self._learner: str | None = None
        self._before: Observation | None = None

    def check(self, walk: RecordedWalk, following: RecordedWalk | None) -> WalkCheck:
        """Check the next walk; the bag's last one may be cut short."""
        given = _taken(walk, self._session.settings.action.limit_m)
        check = WalkCheck(
            walk.number,
            walk.episode,
            None if walk.result is None else walk.result.learning,
            len(given),
            refused=sum(map(len, walk.corrections.values())) - len(given),
        )
        whole = walk.observations[0].control_tick == 0
        again = self._started_again(walk, following)
        status = walk.statuses.get(self._learner or next(reversed(walk.statuses), ""))
        frozen = _without_learning(walk, status)
        self._lost = self._lost or again or self._not_followed(walk, status, frozen)
        if self._lost is None and not whole:
            check.not_checked = "its beginning is not in the bag"
            if not frozen:
                self._lost = _not_in_the_bag(f"the beginning of walk {walk.number}")
        elif self._lost is not None:
            check.not_checked = self._lost
        elif given or walk.result is not None:
            self._session.frozen = frozen and not self._session.trial_due
            self._compare(walk, given, following is None, frozen, check)
        if whole:
            check.cost = recomputed_cost(walk, self._session.settings.cost)
        self._before = walk.observations[-1]
        return check

    # -- does the session know what the recorded learner knew? ----------------------

    def _started_again(
        self, walk: RecordedWalk, following: RecordedWalk | None
    ) -> str | None:
        """Follow the learner by its name; return what is missing if it is a new one.

        A learner that is heard again behind another one has not been started again:
        the other one is a stranger, of whom the nodes take nothing.
        """
        later = following.heard if following is not None else []
        known = self._learner
        if known is None and walk.heard:
            known = Counter([*walk.heard, *later]).most_common(1)[0][0]
        self._learner = known
        others = [name for name in walk.heard if name != known]
        if not others or walk.heard[-1] == known or known in later:
            return None
        self._learner = others[-1]
        return _not_in_the_bag(
            f"the memory from which the learner went on, when it was started again "
            f"in walk {walk.number},"
        )

    def _not_followed(
        self, walk: RecordedWalk, status: LearnerStatus | None, frozen: bool
    ) -> str | None:
        """Return what the recorded learner knew and the session does not, if any."""
        first, before = walk.observations[0], self._before
        by_user = status is not None and status.frozen and frozen
        if before is None:
            return self._not_the_beginning(walk, status, by_user)
        gap = first.simulation == before.simulation and (
            first.episode > before.episode + 1
        )
        if gap and not by_user:
            return _not_in_the_bag(
                f"what was learned in walks {before.episode + 1} to {first.episode - 1}"
            )
        return None

    def _not_the_beginning(
        self, walk: RecordedWalk, status: LearnerStatus | None, by_user: bool
    ) -> str | None:
        session = self._session
        same_memory = status is None or (
            status.episodes == session.episodes
            and status.memory_sha256 == session.memory_sha256()
        )
        if same_memory and (walk.episode == 1 or by_user):
            return None
        return _not_in_the_bag(
            f"the learner's memory of the moment when the bag begins, walk "
            f"{walk.episode} of a run,"
        )

    # -- a walk, observation by observation -----------------------------------------

    def _compare(
        self,
        walk: RecordedWalk,
        given: Mapping[int, list[NDArray[np.float64]]],
        last: bool,
        frozen: bool,
        check: WalkCheck,
    ) -> None:
        session = self._session
        previous = walk.observations[0]
        result: EpisodeResult | None = None
        for n, observation in enumerate(walk.observations):
            gap = observation.control_tick - previous.control_tick
            if gap > TICKS_PER_LEARNING_TICK:
                self._stop_at_hole(walk, frozen, check, previous)
                return
            previous = observation
            if n % _DECISIONS_BETWEEN_LOOKS == 0:
                self._check_memory()
            answer = session.respond(observation)
            recorded = given.get(observation.clock_ticks, [])
            if isinstance(answer, EpisodeResult):
                result = result or answer
                check.corrections -= bool(recorded)
                check.refused += bool(recorded)
            elif any(value_m.tobytes() == answer.tobytes() for value_m in recorded):
                check.identical += 1
            elif recorded:
                both = recorded[0].tolist(), answer.tolist()
                check.differ(observation, _CORRECTION, *both)
            elif not _may_be_unanswered(walk, n, last):
                check.differ(observation, _CORRECTION, None, answer.tolist())
        end = walk.observations[-1].end_cause
        given_up = end is not None and end.from_outside
        if given_up and walk.result is None and not last:
            # Whether the learner has heard of the end, nobody can know.
            self._lost = _not_in_the_bag(f"the learner's result of walk {walk.number}")
        elif result is None and (walk.result is not None or not last):
            self._stop_at_hole(walk, frozen, check, previous)
        elif result not in walk.results and not (last and walk.result is None):
            check.differ(
                previous, "result", *map(msgspec.to_builtins, (walk.result, result))
            )

    def _check_memory(self) -> None:
        arrays = self._session.learner.memory().values()
        size = sum(array.nbytes for array in arrays)
        if size > MOST_BYTES:
            raise ImpossibleWalkError(
                f"makes the learner's memory {size} bytes large, {MOST_BYTES} at most"
            )

    def _stop_at_hole(
        self, walk: RecordedWalk, frozen: bool, check: WalkCheck, before: Observation
    ) -> None:
        check.differ(
            before,
            "observation",
            None,
            "one must have been there",
            TICKS_PER_LEARNING_TICK,
        )
        check.not_checked = "an observation is missing; the rest is not checked"
        if not frozen:
            self._lost = _not_in_the_bag(f"an observation of walk {walk.number}")


def _taken(walk: RecordedWalk, limit_m: float) -> dict[int, list[NDArray[np.float64]]]:
    """Return the corrections that the trajectory may have taken, by clock tick."""
    given: dict[int, list[NDArray[np.float64]]] = {}
    for observation in walk.observations:
        for value_m in walk.corrections.get(observation.clock_ticks, ()):
            if observation.end_cause is None and (np.abs(value_m) <= limit_m).all():
                given.setdefault(observation.clock_ticks, []).append(value_m)
    return given


def _may_be_unanswered(walk: RecordedWalk, n: int, last: bool) -> bool:
    """Return whether the answer to an observation may be missing.

    The recording may have ended between the two, or the walk was given up meanwhile.
    """
    following = walk.observations[n + 1 : n + 2]
    if not following:
        return last
    end = following[0].end_cause
    return end is not None and end.from_outside


def _without_learning(walk: RecordedWalk, status: LearnerStatus | None) -> bool:
    """Return whether the learner walked greedily, as its result or its status says."""
    if walk.result is not None:
        return not walk.result.learning
    return status is not None and status.frozen


def _not_in_the_bag(what: str) -> str:
    return f"{what} is not in the bag"
