"""What each node is told: a run's settings as the parameters of the three nodes."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from biped_bringup.run_settings import RunSettings
from biped_common.settings import SettingsError, to_mapping
from biped_ros.parameters import flattened
from biped_ros.processor import ProcessorSettings
from learner_node.settings import LearnerNodeSettings
from msgs_json import topics
from sim_node.sent_trajectory import LEAST_LOOK_AHEAD_TICKS
from sim_node.settings import ROBOT, SimNodeSettings
from trajectory_node.settings import TrajectorySettings


@dataclass(frozen=True)
class NodeParameters:
    """Settings of the three nodes of one run."""

    sim: SimNodeSettings
    trajectory: TrajectorySettings
    learner: LearnerNodeSettings

    def flat(self) -> dict[str, dict[str, Any]]:
        """Return the parameters by node and dotted name, as in parameter files."""
        return {
            topics.SIM_NODE: flattened(to_mapping(self.sim)),
            topics.TRAJECTORY_NODE: flattened(to_mapping(self.trajectory)),
            topics.LEARNER_NODE: flattened(to_mapping(self.learner)),
        }


def node_parameters(
    settings: RunSettings,
    seed: int,
    *,
    checkpoint_file: str = LearnerNodeSettings.checkpoint_file,
    max_episodes: int = LearnerNodeSettings.max_episodes,
    publish_every_ticks: int = SimNodeSettings.publish_every_ticks,
    pace: str = SimNodeSettings.pace,
    frozen: bool = LearnerNodeSettings.frozen,
    timeout_s: float = SimNodeSettings.timeout_s,
    listen_s: float = LearnerNodeSettings.listen_s,
    recorders: int = SimNodeSettings.recorders,
    realtime_factor: float = SimNodeSettings.realtime_factor,
    look_ahead_ticks: int = TrajectorySettings.look_ahead_ticks,
    processor: ProcessorSettings | None = None,
) -> NodeParameters:
    """Return the settings of the three nodes.

    Args:
        settings: of the whole run.
        seed: of every random draw.
        checkpoint_file: where the learner keeps its session; empty: nowhere.
        max_episodes: learning episodes after which the learner stops; 0: never.
        publish_every_ticks: 1 publishes the 500 Hz topics in full.
        pace: lockstep or realtime.
        frozen: walk greedily, learn nothing.
        timeout_s: silence of a peer after which a walk is given up.
        listen_s: how long the learner listens for another one first.
        recorders: for which the robot waits with its first walk.
        realtime_factor: simulated seconds per second, in real time.
        look_ahead_ticks: control ticks of reference beyond a segment.
        processor: what each of the three asks of the machine; None: nothing.

    Raises:
        SettingsError: what each node would take does not go together.
    """
    if settings.sim.engine == ROBOT and look_ahead_ticks < LEAST_LOOK_AHEAD_TICKS:
        raise SettingsError(
            "look_ahead_ticks",
            look_ahead_ticks,
            f"must be {LEAST_LOOK_AHEAD_TICKS} or more with sim.engine = {ROBOT}, "
            "which is led over from one segment to the next within it",
        )
    beside_learner = to_mapping(settings)
    del beside_learner["learner"]
    processor = processor or ProcessorSettings()
    return NodeParameters(
        sim=SimNodeSettings(
            robot=settings.robot,
            sim=settings.sim,
            processor=processor,
            seed=seed,
            realtime_factor=realtime_factor,
            publish_every_ticks=publish_every_ticks,
            pace=pace,
            timeout_s=timeout_s,
            recorders=recorders,
        ),
        trajectory=TrajectorySettings(
            robot=settings.robot,
            gait=settings.gait,
            correction=settings.correction,
            processor=processor,
            correction_limit_m=settings.learner.action.limit_m,
            look_ahead_ticks=look_ahead_ticks,
        ),
        learner=LearnerNodeSettings(
            learner=settings.learner,
            processor=processor,
            seed=seed,
            walk_ticks=settings.gait.walk_ticks,
            checkpoint_file=checkpoint_file,
            max_episodes=max_episodes,
            frozen=frozen,
            listen_s=listen_s,
            run_settings=json.dumps(beside_learner),
        ),
    )
