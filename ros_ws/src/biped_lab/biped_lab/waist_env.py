"""The paper's task as a Gymnasium environment, `BipedWaist-v0`.

Observations are the eight inputs of Section 4.1, in SI units:

    0  right_support          10 right, -10 left; in double support the coming leg
    1  double_support         10 double, -10 single
    2  waist_x                [m] from the support foot's ankle point, -2 to 2
    3  waist_y
    4  zmp_error_x            [m] measured minus reference ZMP, -2 to 2
    5  zmp_error_y
    6  waist_acceleration_x   [m/s^2] -1000 to 1000
    7  waist_acceleration_y

An action is MultiDiscrete([15, 15]): corrections dx, dy of the waist, from -24 to
24 mm. A step is a decision: 20 ms, or `learner.action.hold_ticks` times that.

The reward is that of Table 2 when the target time is reached (10,000 if the cost beats
its estimate, else 10), and 0 until then. A failure ends the episode without reward; it
is terminated. Where the physics itself cannot be trusted any more, it is truncated.
With `schedule=True` the target time grows as in Section 5.1; else it is the whole walk.

`info` of the last step: `penalty` (0-based type of Table 1, if it failed), `end_cause`,
`t_err` (eq. (2)), `walked_s`, and `outcome`, all that a `learner_node.learner.Learner`
has to be told.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box, MultiDiscrete
from numpy.typing import NDArray

from biped_bringup.run_settings import load_settings
from biped_bringup.walker import Walker
from biped_common.settings import from_mapping, overlay, to_mapping
from biped_common.timing import LEARNING_PERIOD_S, seconds
from biped_description.robot import Robot
from biped_lab.drawing import Scene, picture
from learner_node.walking.task import End, WalkTask
from msgs_json.observation import Observation
from sim_node.control_tick import ControlTick

_FLAG, _LENGTH_M, _ACCELERATION_M_S2 = 10.0, 2.0, 1000.0
_HIGH = [_FLAG] * 2 + [_LENGTH_M] * 4 + [_ACCELERATION_M_S2] * 2


class BipedWaistEnv(gymnasium.Env[NDArray[np.float64], NDArray[np.int64]]):
    """Correct the waist of a walking biped."""

    metadata = {  # noqa: RUF012 - as Gymnasium declares it
        "render_modes": ["rgb_array"],
        "render_fps": round(1.0 / LEARNING_PERIOD_S),
    }

    def __init__(
        self,
        preset: str = "paper",
        settings: Mapping[str, Any] | None = None,
        schedule: bool = False,
        render_mode: str | None = None,
    ) -> None:
        """Plan the gait and build the robot.

        Args:
            preset: of the settings, such as `paper`.
            settings: laid over it, nested as in the presets' YAML.
            schedule: begin with short walks, as the paper does.
            render_mode: None or rgb_array.

        Raises:
            SettingsError: naming key, value and what is allowed.
        """
        run = load_settings(preset)
        if settings is not None:
            run = from_mapping(type(run), overlay(to_mapping(run), settings))
        # An episode of an environment ends where it has succeeded.
        plan = replace(run.learner.schedule, run_on=False)
        if not schedule:
            plan = replace(plan, first_target_s=run.gait.duration_s)
        learner = replace(run.learner, schedule=plan)
        self.settings = run
        self.render_mode = render_mode
        self._rng = np.random.default_rng(0)
        self._robot = Robot(run.robot)
        self._tick: ControlTick | None = None
        drawn = None if render_mode is None else self._take_note
        self._walker = Walker(run, self._rng, drawn)
        self.task = WalkTask(learner, self._walker.walk_ticks)
        self._walks = 0
        self._over = True
        clock_s = learner.inputs.clock_period_s
        self._high = np.array([*_HIGH, clock_s] if clock_s else _HIGH)
        self.observation_space = Box(-self._high, self._high, dtype=np.float64)
        self.action_space = MultiDiscrete(list(self.task.problem.space.alternatives))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float64], dict[str, Any]]:
        """Put the robot back on its feet; a seed is for its disturbances."""
        super().reset(seed=seed)
        if seed is not None:
            self._rng.bit_generator.state = self.np_random.bit_generator.state
        self._walks += 1
        self._tick = None
        self._walker.reference.reset()
        observation = self._walker.biped.begin_walk(self._walks)
        self.task.begin()
        self.task.end(observation)
        self._over = False
        return self._inputs(observation), {}

    def step(
        self, action: NDArray[np.int64]
    ) -> tuple[NDArray[np.float64], float, bool, bool, dict[str, Any]]:
        """Walk with a correction until the next decision."""
        if self._over:
            raise gymnasium.error.ResetNeeded("the walk is over: call reset")
        correction_m = self.task.correction_m(np.asarray(action))
        while True:
            segment = self._walker.reference.segment(correction_m)
            observation = self._walker.biped.execute(segment)
            end = self.task.end(observation)
            if end is not None or self.task.decides(observation):
                break
        inputs = self._inputs(observation)
        if end is None:
            return inputs, 0.0, False, False, {}
        self._over = True
        outcome = end.outcome
        blameless = outcome.penalty is None and outcome.reward is None
        return inputs, outcome.reward or 0.0, not blameless, blameless, _info(end)

    def _inputs(self, observation: Observation) -> NDArray[np.float64]:
        # What ends a walk can lie beyond any bound; what goes on never does.
        return np.clip(self.task.inputs(observation), -self._high, self._high)

    def render(self) -> NDArray[np.uint8] | None:
        """Return (height, width, 3) pixels: the robot from its right and from above."""
        if self.render_mode is None:
            return None
        tick, limits = self._tick, self.settings.sim.limits
        if tick is None:
            stance = self._walker.reference.stance()
            pose = (stance.waist, stance.left_foot, stance.right_foot)
            zmp_reference = stance.zmp_reference[0]
            q = self._robot.leg_joint_positions(*pose)[0]
            scene = Scene(stance.waist[0], q, zmp_reference, zmp_reference)
        else:
            waist, _ = self._walker.biped.world.waist()
            zmp = tick.contact[:2]
            scene = Scene(waist, tick.joint_position, zmp, tick.zmp_reference)
        return picture(self._robot, scene, limits.zmp_error_m)

    def _take_note(self, tick: ControlTick) -> None:
        self._tick = tick

    def close(self) -> None:
        """End the world."""
        self._walker.close()


def _info(end: End) -> dict[str, Any]:
    result = end.result
    info: dict[str, Any] = {
        "outcome": end.outcome,
        "end_cause": str(result.end_cause),
        "walked_s": seconds(result.control_ticks),
        "t_err": math.nan if result.cost is None else result.cost.total,
    }
    if end.outcome.penalty is not None:
        info["penalty"] = end.outcome.penalty
    return info
