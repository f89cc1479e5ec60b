"""A learned walk in real time on the graph, and the same loop without ROS beside it.

The loop without ROS is the machine's noise floor: the same thread with the same
deadlines, the same robot, learner and trajectory, called directly. Then the walk with
SCHED_FIFO asked for, as `biped demo` does, alone and with its live page, at which a
browser looks. A walk that the machine was late for ends there, and its figures are
those up to then.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.graph_run import Listener, run_graph
from benchmarks.report import Figure
from benchmarks.watched_page import browser, live_page
from biped_bringup.node_parameters import node_parameters
from biped_bringup.run_settings import load_settings
from biped_bringup.supervisor.supervisor import Supervisor
from biped_bringup.training import TrainingRun
from biped_description.robot import Robot
from biped_ros.environment import private_domain
from biped_ros.processor import ProcessorSettings
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation
from sim_node.pilot import Pilot
from sim_node.realtime import Punctuality, RealtimeLoop
from trajectory_node.settings import TrajectorySettings
from trajectory_node.waist_reference import WaistReference

_RATE_HZ = 500.0
_MISSED = "missed 20 ms deadlines"
_LATENESS, _LATENCY = "control tick lateness", "observation to waist"
_FIFO = ProcessorSettings(fifo_priority=50)
_PERCENTILES = ("p50", "p99", "max")


def measure() -> list[Figure]:
    """Return punctuality on the graph, and of the bare loop."""
    run = TrainingRun(load_settings("quick"), seed=0)
    run.run(None, False, lambda _: True)
    with tempfile.TemporaryDirectory() as folder:
        memory_file = Path(folder) / "memory.npz"
        run.save(memory_file)
        listener = _walk_on_the_graph(run, memory_file)
        first = _walk_on_the_graph(run, memory_file, _FIFO)
        with live_page(private_domain()) as (_, address), browser(address):
            watched = _walk_on_the_graph(run, memory_file, _FIFO)
    floor = _walk_without_ros(run)
    run.close()
    heard, found = listener.arrivals_ns, listener.figures
    rate_hz = (len(heard) - 1) / (heard[-1] - heard[0]) * 1e9
    ticks = listener.control_ticks
    lost = ticks[-1] - ticks[0] + 1 - len(ticks)
    return [
        Figure(_MISSED, float(found[_MISSED]), "", 0),
        Figure("control ticks lost on the way", lost, "", 0),
        Figure("/joint_states", rate_hz, "Hz", _RATE_HZ + 1.0, _RATE_HZ - 1.0),
        *_percentiles(_LATENESS, found, bound_ms=1.0),
        *_percentiles(_LATENCY, found, bound_ms=5.0),
        *_percentiles(_LATENESS, floor, name=f"without ROS: {_LATENESS}"),
        *_with_fifo("alone", first),
        *_with_fifo("page watched", watched),
    ]


def _with_fifo(name: str, listener: Listener) -> list[Figure]:
    found = listener.figures
    return [
        Figure(f"FIFO, {name}: {_MISSED}", float(found[_MISSED]), "", 0),
        *_percentiles(_LATENESS, found, 1.0, f"FIFO, {name}: {_LATENESS}"),
    ]


def _percentiles(
    key: str, found: dict[str, str], bound_ms: float | None = None, name: str = ""
) -> list[Figure]:
    return [
        Figure(
            f"{name or key}, {percentile}",
            float(found[f"{key} {percentile} [ms]"]),
            "ms",
            bound_ms if percentile == "p99" else None,
        )
        for percentile in _PERCENTILES
    ]


def _walk_on_the_graph(
    run: TrainingRun, memory_file: Path, processor: ProcessorSettings | None = None
) -> Listener:
    parameters = node_parameters(
        run.settings,
        run.seed,
        checkpoint_file=str(memory_file),
        max_episodes=1,
        pace="realtime",
        frozen=True,
        processor=processor,
    )

    def walked(supervisor: Supervisor, listener: Listener) -> bool:
        if supervisor.graph.result is None:
            return False
        cause = supervisor.graph.result.end_cause
        if cause is not EndCause.COMPLETED and not cause.from_outside:
            raise RuntimeError(f"the walk ended: {cause}")
        said = listener.figures.get("control ticks", "0")
        return int(said) >= supervisor.graph.result.control_ticks

    return run_graph(parameters.flat(), walked)


class _DirectAnswer:
    """Learner and trajectory, called in the loop's own thread."""

    def __init__(self, run: TrainingRun) -> None:
        settings = run.settings
        self.reference = WaistReference(
            Robot(settings.robot),
            settings.gait,
            settings.correction,
            TrajectorySettings.look_ahead_ticks,
        )
        self.punctuality = Punctuality()
        self.pilot = Pilot(run.walker.biped)
        self._walk = run.session.greedy()
        self.loop = RealtimeLoop(
            self.pilot,
            self.reference.ticks,
            1.0,
            self._answer,
            self.punctuality,
        )
        self.result: EpisodeResult | None = None

    def _answer(self, observation: Observation) -> None:
        answer: NDArray[np.float64] | EpisodeResult = self._walk.respond(observation)
        if isinstance(answer, EpisodeResult):
            self.result = answer
        else:
            segment = self.reference.segment(answer)
            # After the pilot has taken note of the observation.
            self.loop.request(
                lambda: self.pilot.follow(observation.clock_ticks, segment)
            )
            self.loop.request(self.loop.segment_arrived)


def _walk_without_ros(run: TrainingRun) -> dict[str, str]:
    direct = _DirectAnswer(run)
    direct.loop.start()
    direct.loop.request(direct.loop.begin)
    end = time.monotonic() + 60.0
    while direct.result is None and time.monotonic() < end:
        time.sleep(0.1)
    direct.loop.stop()
    if direct.result is None or not direct.result.completed:
        raise RuntimeError(f"the walk without ROS was not walked: {direct.result}")
    return direct.punctuality.figures()
