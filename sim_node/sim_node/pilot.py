"""Walks after walks for whoever guides the robot: what to accept, when to begin anew.

Pure bookkeeping around the robot; the node brings the messages and the time.
"""

from __future__ import annotations

from biped_description.errors import DescriptionError
from biped_description.robot import Robot
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation
from msgs_json.segment import WaistSegment
from msgs_json.wire import RefusedMessageError
from sim_node.biped import SimulatedBiped


def check_stance(robot: Robot, stance: WaistSegment) -> None:
    """Refuse a pose in which a robot cannot stand.

    Raises:
        RefusedMessageError: the legs do not reach it.
    """
    try:
        robot.leg_joint_positions(stance.waist, stance.left_foot, stance.right_foot)
    except DescriptionError as error:
        raise RefusedMessageError(f"stance: {error}") from None


class Pilot:
    """Guides one robot by segments, in lockstep or ahead of real time."""

    def __init__(self, biped: SimulatedBiped) -> None:
        """Stand, and wait for `begin`."""
        self.biped = biped
        self.walks = 0
        self.observation: Observation | None = None
        """The last one given out."""
        self.segment: WaistSegment | None = None
        """The one that is followed."""
        self._followed_ticks: int | None = None
        """Time of the observation that it answers (real time)."""

    @property
    def walking(self) -> bool:
        """Whether a walk has begun and not ended."""
        return self.walks > 0 and self.biped.end_cause is None

    def begin(self) -> Observation:
        """Begin the next walk."""
        self.walks += 1
        self.observation = self.biped.begin_walk(self.walks)
        return self.observation

    def execute(self, clock_ticks: int, segment: WaistSegment) -> Observation:
        """Walk a segment to its end (lockstep).

        Args:
            clock_ticks: time of the observation that the segment answers.
            segment: the references.

        Raises:
            RefusedMessageError: the segment is not for now.
        """
        self.answered(clock_ticks)
        self.segment = segment
        try:
            self.observation = self.biped.execute(segment)
        except ValueError as error:
            raise RefusedMessageError(str(error)) from None
        return self.observation

    def follow(self, clock_ticks: int, segment: WaistSegment) -> None:
        """Take over a segment while walking on (real time).

        Raises:
            RefusedMessageError: the segment is not for now.
        """
        self.answered(clock_ticks)
        try:
            self.biped.follow(segment)
        except ValueError as error:
            raise RefusedMessageError(str(error)) from None
        self.segment = segment
        self._followed_ticks = clock_ticks

    def observe(self) -> Observation:
        """Sum up what was walked since the last observation (real time)."""
        self.observation = self.biped.observe()
        return self.observation

    def miss(self) -> Observation:
        """End the walk: its next segment is due, and not there (real time).

        That is why it ends, even if the look-ahead has made it fail in this tick.
        """
        self.biped.end(EndCause.LATE, failed=True)
        return self.observe()

    def end(self, cause: EndCause) -> Observation | None:
        """End the walk from outside; return the observation that tells so, if any."""
        if self.observation is None or self.observation.end_cause is not None:
            return None
        self.biped.end(cause)
        return self.observe()

    def check_result(self, result: EpisodeResult) -> None:
        """Refuse a result that is not about the present walk.

        Raises:
            RefusedMessageError: it is about another one.
        """
        if result.episode != self.walks:
            raise RefusedMessageError(
                f"result of walk {result.episode}, the present one is {self.walks}"
            )

    def answered(self, clock_ticks: int) -> Observation:
        """Return the observation that a segment of this time answers.

        Raises:
            RefusedMessageError: it is not the present one, or has been answered, or the
                walk is over.
        """
        observation = self.observation
        expected = None if observation is None else observation.clock_ticks
        if observation is None or clock_ticks != expected:
            raise RefusedMessageError(
                f"segment for clock tick {clock_ticks}, the robot waits at {expected}"
            )
        if clock_ticks == self._followed_ticks:
            raise RefusedMessageError(
                f"a second segment for clock tick {clock_ticks}, which is answered"
            )
        if self.biped.end_cause is not None:
            raise RefusedMessageError(f"the walk is over: {self.biped.end_cause}")
        return observation
