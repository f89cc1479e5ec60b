"""What the nodes of a run have measured: for screen and summary of `biped up`."""

from __future__ import annotations

from collections.abc import Mapping

from biped_bringup.supervisor.graph_watch import GraphWatch
from learner_node.node import NOT_SAVED
from msgs_json import topics
from sim_node.realtime import MISSED_DEADLINES, SIMULATED_PER_REAL_TIME


def given_up_walks(graph: GraphWatch) -> dict[str, int]:
    """Return how many walks of this run ended from outside, by cause."""
    return {
        cause.value: walks
        for cause, walks in graph.end_causes.items()
        if cause.from_outside
    }


def missed_deadlines(graph: GraphWatch) -> int:
    """Return how many deadlines the robot missed, over all its processes."""
    told = (
        figures.get(MISSED_DEADLINES, "")
        for figures in graph.figures[topics.SIM_NODE].values()
    )
    # /diagnostics are open to all: a figure may be no number.
    return sum(int(text) for text in told if text.isdecimal() and len(text) < 10)


def simulated_per_real_time(graph: GraphWatch) -> str:
    """Return the robot's speed over the last second; `-` before it was heard."""
    return _last(graph, topics.SIM_NODE).get(SIMULATED_PER_REAL_TIME, "-")


def not_saved_because(graph: GraphWatch) -> str:
    """Return why the learner could not write its last checkpoint; empty if it could."""
    return _last(graph, topics.LEARNER_NODE).get(NOT_SAVED, "")


def _last(graph: GraphWatch, node: str) -> Mapping[str, str]:
    """Return the figures of a node's last process."""
    return next(reversed(graph.figures[node].values()), {})


def counted(causes: Mapping[str, int]) -> str:
    """Return counts in words, such as `late 2, peer_silent 1`."""
    return ", ".join(f"{cause} {walks}" for cause, walks in causes.items())
