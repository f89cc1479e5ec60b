"""The three nodes in this process under one executor, on the real middleware.

For tests and for looking around: everything goes over DDS as it does between
processes, but one thread runs it all, and a debugger can stop it.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from types import TracebackType

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.task import Future

from biped_bringup.node_parameters import NodeParameters
from biped_ros.parameters import parameters_of
from learner_node.node import LearnerNode
from sim_node.node import SimNode
from trajectory_node.node import TrajectoryNode

# The condition is looked at so often.
_TURN_S = 0.004


class OneExecutor:
    """Context manager around the graph of one run."""

    def __init__(self, parameters: NodeParameters, domain: int) -> None:
        """Remember what to start.

        Args:
            parameters: of the three nodes.
            domain: ROS domain to be alone in.
        """
        self._parameters = parameters
        self._domain = domain

    def __enter__(self) -> OneExecutor:
        """Start the nodes."""
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=self._domain)
        of, context = self._parameters, self._context
        self.trajectory = TrajectoryNode(
            context=context, parameter_overrides=parameters_of(of.trajectory)
        )
        self.learner = LearnerNode(
            context=context, parameter_overrides=parameters_of(of.learner)
        )
        self.sim = SimNode(context=context, parameter_overrides=parameters_of(of.sim))
        self.nodes = (self.trajectory, self.learner, self.sim)
        self._executor = EventsExecutor(context=context)
        for node in self.nodes:
            self._executor.add_node(node)
        return self

    def add(self, node: Node) -> None:
        """Have a node of the caller's own spun, too."""
        self._executor.add_node(node)

    def remove(self, node: Node) -> None:
        """Spin it no longer."""
        self._executor.remove_node(node)

    def spin_until(self, condition: Callable[[], bool], timeout_s: float) -> bool:
        """Spin until the condition holds; return whether it did in time."""
        # The executor looks at its own time-out only when no message waits, and while
        # the robot walks there always is one: a timer looks instead.
        end = time.monotonic() + timeout_s
        over: Future = Future()

        def look() -> None:
            if not over.done() and (condition() or time.monotonic() >= end):
                over.set_result(None)

        look()
        timer = self.sim.create_timer(_TURN_S, look)
        try:
            if not over.done():
                self._executor.spin_until_future_complete(over, timeout_s)
        finally:
            self.sim.destroy_timer(timer)
        return condition()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the nodes and leave the domain."""
        # What an executor still knows of is not taken off the graph.
        self._executor.shutdown()
        for node in self.nodes:
            node.close()
            node.destroy_node()
        rclpy.shutdown(context=self._context)
