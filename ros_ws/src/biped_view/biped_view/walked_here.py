"""Walk in this process, and keep what every control tick measured."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from biped_bringup.run_settings import RunSettings
from biped_bringup.training import TrainingRun, versions
from biped_bringup.walker import Responder, Walker
from biped_common.errors import BipedError
from biped_common.timing import TICKS_PER_LEARNING_TICK
from biped_description.robot import Robot
from biped_view.walk_record import LoadedWalk, Rows, WalkRecord
from learner_node.walking.session import LearningSession
from learner_node.walking.walks import greedy_walk, static_walk
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation
from sim_node.control_tick import ControlTick
from sim_node.physics import Physics
from trajectory_node.waist_reference import WaistReference

_SEED = 0
"""Of the disturbances, if any: as `biped walk` draws them where it is given no seed."""


class NoWalkError(BipedError, ValueError):
    """There is no walk to look at; the message says why."""


def walk_of_memory(path: Path) -> LoadedWalk:
    """Walk the frozen greedy walk of a memory, as `biped walk --memory` does.

    Args:
        path: a `memory.npz`.

    Raises:
        CheckpointError: it is no memory, or one of another version.
        NoWalkError: the walk ended before its first control tick.
    """
    run = TrainingRun.load(path, replay_bytes=0)
    run.close()
    session, settings = run.session, run.settings
    record = _walked(settings, session)
    facts = {
        "memory": str(path),
        "memory SHA-256": session.memory_sha256(),
        "seed of the run": str(run.seed),
        "written by": ", ".join(f"{name} {at}" for name, at in run.written_by.items()),
    }
    completed = record.end_cause is EndCause.COMPLETED
    return LoadedWalk(
        "The learned walk"
        if session.learned and completed
        else "The frozen greedy walk of a memory",
        record,
        settings,
        session,
        {name: text for name, text in facts.items() if text} | _facts(record),
    )


def walk_without_learner(settings: RunSettings) -> LoadedWalk:
    """Walk the static walk, as `biped walk --static` does.

    Raises:
        NoWalkError: the walk ended before its first control tick.
    """
    record = _walked(settings, None)
    return LoadedWalk("The static walk", record, settings, facts=_facts(record))


def _walked(settings: RunSettings, session: LearningSession | None) -> WalkRecord:
    walker = Walker(settings, np.random.default_rng(_SEED))
    ticks = _Ticks(walker.biped.world)
    walker.biped.on_tick = ticks.add
    learner = settings.learner
    walk = (
        static_walk(learner, walker.walk_ticks)
        if session is None
        else greedy_walk(learner, walker.walk_ticks, session.learner, session.task)
    )
    answers = _Answers(walk)
    try:
        result = walker.walk(answers)
    finally:
        walker.close()
    if not ticks.rows:
        raise NoWalkError(
            f"the walk ended as {result.end_cause} before its first control tick: "
            "there is nothing to see"
        )
    return _record(settings, ticks, answers.corrections_m, result)


class _Ticks:
    """Takes down what every control tick measured."""

    def __init__(self, world: Physics) -> None:
        self._world = world
        self.rows: list[tuple[float, ...]] = []

    def add(self, tick: ControlTick) -> None:
        x, y, z, w = self._world.torso_orientation()
        self.rows.append(
            (
                *tick.joint_position, *tick.joint_velocity, *tick.joint_torque,
                *tick.joint_reference, *self._world.waist().position, w, x, y, z,
                *tick.contact[:2], *tick.zmp_reference,
            )
        )  # fmt: skip

    def columns(self) -> list[Rows]:
        """Return joints (n, 12) four times, torso, its quaternion and both ZMPs."""
        rows = np.array(self.rows)
        widths = (12, 12, 12, 12, 3, 4, 2, 2)
        return np.split(rows, np.cumsum(widths)[:-1], axis=1)


class _Answers:
    """Stands between robot and learner, and takes down what the learner chose."""

    def __init__(self, responder: Responder) -> None:
        self._responder = responder
        self.corrections_m: list[NDArray[np.float64]] = []

    def respond(self, observation: Observation) -> NDArray[np.float64] | EpisodeResult:
        answer = self._responder.respond(observation)
        if not isinstance(answer, EpisodeResult):
            self.corrections_m.append(answer)
        return answer


def _record(
    settings: RunSettings,
    ticks: _Ticks,
    corrections_m: list[NDArray[np.float64]],
    result: EpisodeResult,
) -> WalkRecord:
    # The same corrections make the same reference again, to the last bit.
    reference = WaistReference(
        Robot(settings.robot), settings.gait, settings.correction
    )
    waist = np.concatenate(
        [
            segment.waist[1 : segment.n_ticks + 1]
            for segment in map(reference.segment, corrections_m)
        ]
    )
    plan, n = reference.plan, len(ticks.rows)
    rows = slice(1, n + 1)
    q, dq, torque, q_reference, torso, quaternion, zmp, zmp_reference = ticks.columns()
    return WalkRecord(
        robot=settings.robot,
        zmp_limit_m=settings.sim.limits.zmp_error_m,
        walk_ticks=plan.ticks,
        joint_position_rad=q,
        joint_velocity_rad_s=dq,
        joint_torque_nm=torque,
        joint_reference_rad=q_reference,
        torso_position_m=torso,
        torso_quaternion=quaternion,
        zmp_m=zmp,
        zmp_reference_m=zmp_reference,
        waist_m=waist[:n],
        static_waist_m=reference.static_waist[rows],
        left_foot_m=plan.left_foot[rows],
        right_foot_m=plan.right_foot[rows],
        right_support=plan.right_support[rows],
        double_support=plan.double_support[rows],
        step_index=plan.step_index[rows],
        correction_m=np.repeat(corrections_m, TICKS_PER_LEARNING_TICK, axis=0)[:n],
        end_cause=result.end_cause,
        result=result,
    )


def _facts(record: WalkRecord) -> dict[str, str]:
    assert record.result is not None
    found = [f"{name} {version}" for name, version in versions().items()]
    return {
        "walked here with": ", ".join(found),
        "trajectory SHA-256": record.result.trajectory_sha256,
    }
