"""The trajectory on ROS: an observation and its correction in, a waist segment out."""

from __future__ import annotations

import sys
from typing import Any

from biped_description.robot import Robot
from biped_ros.cdr import string_text
from biped_ros.guarded import GuardedNode
from biped_ros.messages import (
    correction_of,
    segment_template,
    segment_values,
)
from biped_ros.observation_gaps import ObservationGaps
from biped_ros.running import run_node
from msgs_json import topics
from msgs_json.observation import Observation
from msgs_json.segment import WaistSegment
from msgs_json.wire import decode
from trajectory_node.segment_maker import SegmentMaker
from trajectory_node.settings import TrajectorySettings
from trajectory_node.waist_reference import WaistReference

NAME = topics.TRAJECTORY_NODE


class TrajectoryNode(GuardedNode):
    """Publishes the stance once, and a segment per learning tick."""

    def __init__(self, **options: Any) -> None:
        """Plan the gait and announce the stance.

        Args:
            options: of `rclpy.node.Node`, such as `parameter_overrides`.

        Raises:
            InfeasibleGaitError: the robot cannot walk this gait.
        """
        super().__init__(NAME, **options)
        settings = self.settings_from_parameters(TrajectorySettings)
        reference = WaistReference(
            Robot(settings.robot),
            settings.gait,
            settings.correction,
            settings.look_ahead_ticks,
        )
        self._maker = SegmentMaker(reference, settings.correction_limit_m)
        self._gaps = ObservationGaps()
        stance = reference.stance()
        self._stance_template = segment_template(rows=1)
        self._template = segment_template(reference.rows)
        self._segments = self.publisher(topics.WAIST_REFERENCE)
        self._stance = self.publisher(topics.STANCE)
        self._stance.publish(self._stance_template.fill(segment_values(stance)))
        self.listen(topics.CORRECTION, self._on_correction)
        self.listen_once_heard(
            topics.OBSERVATION, self._on_observation, {self._segments: topics.SIM_NODE}
        )

    def _on_observation(self, message: bytes) -> None:
        observation = decode(Observation, string_text(message))
        self.dropped(topics.OBSERVATION, self._gaps.before(observation))
        self._publish(self._maker.observe(observation), observation.clock_ticks)

    def _on_correction(self, message: bytes) -> None:
        learner, clock_ticks, correction_m = correction_of(message)
        segment = self._maker.correct(learner, clock_ticks, correction_m)
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
