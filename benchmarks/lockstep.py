"""Simulated seconds per second in lockstep: three processes, no recorder."""

from __future__ import annotations

import time

from benchmarks.graph_run import Listener, run_graph
from benchmarks.report import Figure
from biped_bringup.node_parameters import node_parameters
from biped_bringup.run_settings import load_settings
from biped_bringup.supervisor.supervisor import Supervisor

_SIMULATED_S = 100.0


def measure() -> list[Figure]:
    """Return the rate with all 500 Hz topics, and with a tenth of their messages."""
    return [
        Figure("lockstep, all topics at 500 Hz", _rate(1), "s/s", at_least=5.0),
        Figure("lockstep, fast topics at 50 Hz", _rate(10), "s/s", at_least=10.0),
    ]


def _rate(publish_every_ticks: int) -> float:
    parameters = node_parameters(
        load_settings("quick"), seed=1, publish_every_ticks=publish_every_ticks
    )
    seen: list[tuple[float, float]] = []  # simulated and real seconds

    def enough(supervisor: Supervisor, _: Listener) -> bool:
        status = supervisor.graph.status
        if status is not None and status.simulated_s > (seen[-1][0] if seen else 0.0):
            seen.append((status.simulated_s, time.monotonic()))
        return bool(seen) and seen[-1][0] - seen[0][0] > _SIMULATED_S

    run_graph(parameters.flat(), enough)
    return (seen[-1][0] - seen[0][0]) / (seen[-1][1] - seen[0][1])
