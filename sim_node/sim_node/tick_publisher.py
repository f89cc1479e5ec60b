"""The 500 Hz topics: everything that a control tick measured."""

from __future__ import annotations

from biped_description.joints import JOINT_NAMES
from biped_ros.cdr import string_message
from biped_ros.guarded import GuardedNode
from biped_ros.messages import (
    clock_template,
    joint_state_template,
    point_template,
)
from msgs_json import topics
from msgs_json.wire import encode
from sim_node.control_tick import ControlTick


class TickPublisher:
    """Publishes every n-th control tick of a walk."""

    def __init__(self, node: GuardedNode, every_ticks: int) -> None:
        """Make the publishers on a node.

        Args:
            node: that publishes.
            every_ticks: 1 publishes all control ticks, 10 every tenth.
        """
        self.every_ticks = every_ticks
        self._clock = node.publisher(topics.CLOCK)
        self._states = node.publisher(topics.JOINT_STATES)
        self._references = node.publisher(topics.JOINT_REFERENCES)
        self._zmp = node.publisher(topics.ZMP)
        self._zmp_reference = node.publisher(topics.ZMP_REFERENCE)
        self._phase = node.publisher(topics.PHASE)
        self._clock_template = clock_template()
        self._state_template = joint_state_template(JOINT_NAMES, with_effort=True)
        self._reference_template = joint_state_template(JOINT_NAMES, with_effort=False)
        self._point_template = point_template()

    def listeners(self) -> int:
        """Return how many are connected to every one of the topics."""
        publishers = (
            self._clock,
            self._states,
            self._references,
            self._zmp,
            self._zmp_reference,
            self._phase,
        )
        return min(int(each.get_subscription_count()) for each in publishers)

    def publish(self, tick: ControlTick) -> None:
        """Publish a tick, if it is its turn."""
        at = tick.clock_ticks
        if at % self.every_ticks:
            return
        self._clock.publish(self._clock_template.fill((), at))
        self._states.publish(
            self._state_template.fill(
                (*tick.joint_position, *tick.joint_velocity, *tick.joint_torque), at
            )
        )
        self._references.publish(
            self._reference_template.fill(
                (*tick.joint_reference, *tick.joint_velocity_reference), at
            )
        )
        self._zmp.publish(self._point_template.fill(tick.contact[:2], at))
        self._zmp_reference.publish(self._point_template.fill(tick.zmp_reference, at))
        self._phase.publish(string_message(encode(tick.phase)))
