"""The supervisor: an ordered start, a watchful middle, an ordered end.

What failures do:
    a node dies: it is started again after a growing pause; the fifth time within ten
        seconds, or in a row without having come up, everything is ended, and the exit
        status says so.
    a node says that it cannot go on (wrong parameter, another learner on the graph):
        everything is ended at once, since a new start would come to the same.
    the recorder says so (disk full, folder unusable), or keeps dying: the recording has
        stopped, the walk goes on; `done_without` says why. Likewise whoever
        only listens, such as the bridge to Foxglove (port taken).
    a node lives but has said nothing for a while: it is killed, and counts as died.
    SIGINT, SIGTERM: the nodes are asked to end, last started first; who does not, is
        terminated and then killed.
    the supervisor is killed: the kernel terminates the nodes.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from biped_bringup.supervisor.child import Child
from biped_bringup.supervisor.graph_watch import FOXGLOVE, NAME, TF_NODE, GraphWatch
from biped_bringup.supervisor.restart_budget import RestartBudget
from biped_common.command_line import WRONG_INPUT
from biped_common.entry_points import entry_points
from biped_common.errors import BipedError
from biped_ros.environment import LEASE_S
from biped_ros.process import process_name
from biped_ros.running import REFUSED
from msgs_json import topics

RECORDER = topics.RECORDER_NODE
# In the order of their start. The recorder comes first and ends last: it misses
# nothing. The robot comes last: when it offers its first walk, everybody listens.
_MODULES = {
    RECORDER: "biped_bag.recorder.node",
    topics.TRAJECTORY_NODE: "trajectory_node.node",
    topics.LEARNER_NODE: "learner_node.node",
    topics.SIM_NODE: "sim_node.node",
}
START_ORDER = tuple(_MODULES)
# Started last, where asked for: packages above this one, found by what they declare.
_LISTENERS = {
    FOXGLOVE: "biped_view/foxglove_bridge",
    TF_NODE: "biped_view/tf_node",
}
READY = "is ready (process "
"""In the line that tells of a node that has come up."""
_TURN_S = 0.1
_ENDING_TURN_S = 0.02
_LAST_WORDS_S = 0.1
"""What a node sent last, such as what it could not save, may still be on its way."""


@dataclass(frozen=True)
class Patience:
    """How long the supervisor waits for what [s]."""

    discovery_s: float = 1.0
    """To learn who is on the graph, before the first node is started."""
    predecessor_s: float = LEASE_S + 3.0
    """For the nodes of a run that was killed to be off the graph."""
    ready_s: float = 60.0
    """For a node to appear on the graph; the first start compiles."""
    silence_s: float = 15.0
    """For a node that is on the graph to speak."""
    end_s: float = 5.0
    """For a node to end when asked, and again when terminated."""


class NodeFailureError(BipedError):
    """A node could not be kept running; the text says which, and why."""


class Supervisor:
    """Keeps the nodes of one run alive until it is done or told to stop."""

    def __init__(
        self,
        parameters: Mapping[str, Mapping[str, Any]],
        environment: Mapping[str, str],
        folder: Path,
        show: Callable[[str, str], None],
        patience: Patience | None = None,
    ) -> None:
        """Write the parameter files and join the graph.

        Args:
            parameters: of the nodes to start, by node.
            environment: of their processes.
            folder: for parameter files and logs.
            show: told (who, line) of everything there is to tell.
            patience: how long to wait for what.
        """
        self.children: dict[str, Child] = {}
        self.done_without: dict[str, str] = {}
        """Nodes that have ended for good while the run goes on, and why."""
        self._budgets: dict[str, RestartBudget] = {}
        self._show = show
        self._patience = patience or Patience()
        for name in (*START_ORDER, *_LISTENERS):
            if name in parameters:
                file = folder / f"{name}.yaml"
                content = {name: {"ros__parameters": dict(parameters[name])}}
                file.write_text(yaml.safe_dump(content))
                log = folder / f"{name}.log"
                arguments = ("--ros-args", "--params-file", str(file))
                self.children[name] = Child(
                    name, _module(name), arguments, environment, log, show
                )
                self._budgets[name] = RestartBudget()
        self.graph = GraphWatch(int(environment["ROS_DOMAIN_ID"]))

    def run(self, done: Callable[[], bool], stopped: Callable[[], bool]) -> None:
        """Start the nodes and keep them running until `done` or `stopped`.

        Raises:
            NodeFailureError: a node could not be started or kept running.
        """
        for child in self.children.values():
            self._await_turn(child, stopped)
            if stopped():
                return
            self._start(child, stopped)
        self.watch(done, stopped)

    def watch(self, done: Callable[[], bool], stopped: Callable[[], bool]) -> None:
        """Keep the nodes, once started, running until `done` or `stopped`.

        Raises:
            NodeFailureError: a node could not be kept running.
        """
        while not (done() or stopped()):
            self.graph.spin(_TURN_S)
            for child in self.children.values():
                self._look_after(child, stopped)

    def stop(self) -> None:
        """End all nodes, last started first, and leave the graph."""
        children = list(self.children.values())[::-1]
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            for child in children:
                if child.running:
                    if number is not signal.SIGINT:
                        self._show(NAME, f"{child.name} gets {number.name}")
                    child.signal(number)
                    # One that was stopped cannot end before it is let go on.
                    child.signal(signal.SIGCONT)
                    self._await_end(child)
        self.graph.close()

    def _await_turn(self, child: Child, stopped: Callable[[], bool]) -> None:
        """Wait until nobody else publishes what a node is to publish.

        The nodes of a run that was killed stay on the graph for a while.
        """
        end = time.monotonic() + self._patience.predecessor_s
        while not stopped() and (
            (other := self.graph.taken(child.name))
            or self.graph.watched_s < self._patience.discovery_s
        ):
            self.graph.spin(_TURN_S)
            if other and time.monotonic() > end:
                raise NodeFailureError(
                    f"{child.name} cannot be started: {other}; end that, or take "
                    "another domain"
                )

    def _await_end(self, child: Child) -> None:
        """Wait for a node to end, and hear its last words."""
        end = time.monotonic() + self._patience.end_s
        while child.running and time.monotonic() < end:
            self.graph.spin(_ENDING_TURN_S)
        if not child.running:
            child.wait(self._patience.end_s)  # until all that it said has been read
            self.graph.spin(_LAST_WORDS_S)

    def _start(self, child: Child, stopped: Callable[[], bool]) -> None:
        self.graph.expect(child.name, process_name(child.start()))
        end = time.monotonic() + self._patience.ready_s
        while not self.graph.has_node(child.name):
            self.graph.spin(_TURN_S)
            if stopped():
                return
            if not child.running:
                self._restart(child, stopped)
                return
            if time.monotonic() > end:
                self._give_up(
                    child,
                    f"did not appear on the graph within {self._patience.ready_s:g} s",
                )
                return
        self._budgets[child.name].ready()
        self._show(NAME, f"{child.name} {READY}{child.pid})")

    def _look_after(self, child: Child, stopped: Callable[[], bool]) -> None:
        if child.name in self.done_without:
            return
        if not child.running:
            if not stopped():
                self._restart(child, stopped)
            return
        heard = self.graph.heard_at.get(child.name)
        if heard is not None and time.monotonic() - heard > self._patience.silence_s:
            self._show(
                NAME,
                f"{child.name} has been silent for {self._patience.silence_s:g} s: "
                "it is killed",
            )
            child.signal(signal.SIGKILL)
            child.wait(self._patience.end_s)

    def _restart(self, child: Child, stopped: Callable[[], bool]) -> None:
        status = child.exit_status
        if status in (REFUSED, WRONG_INPUT):
            child.wait(self._patience.end_s)  # until all that it said has been read
            self._give_up(child, child.last_line.removeprefix(f"{child.name} "))
            return
        delay_s = self._budgets[child.name].failed(time.monotonic())
        if delay_s is None:
            self._give_up(
                child,
                f"died too often (last exit status {status}); its log says why",
            )
            return
        self._show(
            NAME,
            f"{child.name} died (exit status {status}), starts again in {delay_s:g} s",
        )
        self.graph.spin(delay_s)
        self._start(child, stopped)

    def _give_up(self, child: Child, reason: str) -> None:
        """Do without a node, if the run can.

        Raises:
            NodeFailureError: it cannot.
        """
        if child.name not in (RECORDER, *_LISTENERS):
            raise NodeFailureError(f"{child.name} {reason}")
        child.signal(signal.SIGKILL)
        self.done_without[child.name] = reason
        self._show(NAME, f"{child.name}: {reason}; the walk goes on")


def _module(name: str) -> str:
    """Return the module that runs a node.

    Raises:
        NodeFailureError: no package here has it.
    """
    if name in _MODULES:
        return _MODULES[name]
    point = entry_points("biped.nodes").get(_LISTENERS[name])
    if point is None:
        raise NodeFailureError(f"{name}: no installed package has {_LISTENERS[name]}")
    return point.module
