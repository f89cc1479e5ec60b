"""The trajectory on ROS: an observation and its correction in, a waist segment out."""

from __future__ import annotations

import sys
from typing import Any

from biped_description.robot import Robot
from biped_ros.cdr import string_message, string_text
from biped_ros.guarded import GuardedNode
from biped_ros.messages import (
    WORLD_FRAME,
    correction_of,
    segment_template,
    segment_values,
)
from biped_ros.observation_gaps import ObservationGaps
from biped_ros.running import claim_processor, run_node
from msgs_json import topics
from msgs_json.observation import Observation
from msgs_json.segment import WaistSegment
from msgs_json.wire import RefusedMessageError, decode, encode
from trajectory_node.segment_maker import SegmentMaker
from trajectory_node.settings import TrajectorySettings
from trajectory_node.waist_reference import WaistReference

NAME = topics.TRAJECTORY_NODE


class TrajectoryNode(GuardedNode):
    """Publishes the plan of the walk once, and a segment per learning tick."""

    def __init__(self, **options: Any) -> None:
        """Plan the gait and announce the plan.

        Args:
            options: of `rclpy.node.Node`, such as `parameter_overrides`.

        Raises:
            InfeasibleGaitError: the robot cannot walk this gait.
        """
        super().__init__(NAME, **options)
        settings = self.settings_from_parameters(TrajectorySettings)
        claim_processor(self, settings.processor)
        reference = WaistReference(
            Robot(settings.robot),
            settings.gait,
            settings.correction,
            settings.look_ahead_ticks,
        )
        self._maker = SegmentMaker(reference, settings.correction_limit_m)
        self._gaps = ObservationGaps()
        self._template = segment_template(reference.rows)
        self._segments = self.publisher(topics.WAIST_REFERENCE)
        self._plan = self.publisher(topics.PLAN)
        self._plan.publish(string_message(encode(reference.walk_plan())))
        self.listen(topics.CORRECTION, self._on_correction)
        self.listen(
            topics.OBSERVATION,
            self._on_observation,
            {self._segments: topics.SIM_NODE},
            self._anew,
        )

    def _anew(self) -> None:
        """Forget the robot that was heard."""
        self._maker.forget()
        self._gaps = ObservationGaps()

    def _on_observation(self, message: bytes) -> None:
        observation = decode(Observation, string_text(message))
        self.dropped(topics.OBSERVATION, self._gaps.before(observation))
        self._publish(self._maker.observe(observation), observation.clock_ticks)

    def _on_correction(self, message: bytes) -> None:
        frame, clock_ticks, correction_m = correction_of(message)
        if frame != WORLD_FRAME:
            raise RefusedMessageError(
                f"correction in frame {frame!r}: must be in {WORLD_FRAME}"
            )
        segment = self._maker.correct(clock_ticks, correction_m)
        self._publish(segment, clock_ticks)

    def _publish(self, segment: WaistSegment | None, clock_ticks: int) -> None:
        if segment is not None:
            values = segment_values(segment)
            self._segments.publish(self._template.fill(values, clock_ticks))


def main() -> int:
    """Run the node as a process."""
    return run_node(TrajectoryNode)


if __name__ == "__main__":
    sys.exit(main())
