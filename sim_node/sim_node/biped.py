"""The simulated biped: executes waist segments, watches its limits, observes.

One walk is `begin_walk` and then `execute` per learning tick, until the observation
carries an end cause or the caller has seen enough.
"""

from __future__ import annotations

import copy
import hashlib
import math
import operator
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from biped_description import kinematics
from biped_description.joints import JOINT_NAMES, TORQUE_LIMIT
from msgs_json.end_cause import EndCause
from msgs_json.observation import Observation, PhaseFlags
from msgs_json.segment import WaistSegment
from msgs_json.timing import (
    CONTROL_PERIOD_S,
    CONTROL_PERIOD_US,
    LEARNING_PERIOD_S,
    microseconds,
)
from sim_node.contact import FloorContact, floor_contact
from sim_node.control_tick import ControlTick, sum_up
from sim_node.disturbance import Disturbance, draw_disturbance
from sim_node.errors import SnapshotError
from sim_node.settings import SimSettings
from sim_node.world import World

# The solver leaves the drop of the first contact behind well within 0.3 s.
_SETTLING_TICKS = 150
# A servo at this share of its limit counts as saturated.
_SATURATED = 0.999
_IK_END_CAUSE = {
    kinematics.UNREACHABLE: EndCause.IK_UNREACHABLE,
    kinematics.BEYOND_JOINT_LIMIT: EndCause.IK_JOINT_LIMIT,
}


@dataclass(frozen=True)
class BipedSnapshot:
    """A walk in its middle; valid for the biped that made it, until released."""

    world_state: int
    watch: _Watch
    disturbance: Disturbance
    rng_state: dict[str, Any]


@dataclass
class _Watch:
    """What the robot remembers from tick to tick besides the physics."""

    episode: int = 0
    control_tick: int = 0
    zmp: tuple[float, float] = (0.0, 0.0)
    waist_velocity: tuple[float, float] = (0.0, 0.0)
    unloaded_ticks: int = 0
    saturated_ticks: int = 0
    end_cause: EndCause | None = None
    trajectory: Any = field(default_factory=hashlib.sha256)
    """Running hash of all that was measured."""

    def copy(self) -> _Watch:
        """Return an independent copy."""
        return replace(self, trajectory=self.trajectory.copy())


class SimulatedBiped:
    """The robot in its world, from reset to the end of a walk."""

    def __init__(
        self,
        settings: SimSettings,
        start: WaistSegment,
        rng: np.random.Generator,
        on_tick: Callable[[ControlTick], None] | None = None,
    ) -> None:
        """Build the world and let the robot settle in its starting pose.

        Args:
            settings: limits and disturbances.
            start: a segment whose row 0 is the pose in which walks start.
            rng: source of all disturbances.
            on_tick: called after every control tick.
        """
        self.settings = settings
        self.on_tick = on_tick
        self._rng = rng
        self._start = start
        self.world = World()
        self.world.set_friction(settings.disturbances.friction)
        self.world.set_torque_limits(
            TORQUE_LIMIT * settings.disturbances.torque_limit_factor
        )
        limits = settings.limits
        self._unloaded_limit = _ticks(limits.unloaded_feet_s)
        self._saturation_limit = _ticks(limits.torque_saturation_s)
        self._torque_marks = [_SATURATED * limit for limit in self.world.torque_limits]
        self._q_reference = np.empty((0, len(JOINT_NAMES)))
        self._disturbance = draw_disturbance(
            replace(settings.disturbances, push_force_n=0.0, mass_error=0.0),
            self.world.n_links,
            np.random.default_rng(0),
        )
        self._watch = _Watch()
        self._settle()
        self._standing = self.world.save()

    # -- a walk --------------------------------------------------------------------

    def begin_walk(self, episode: int) -> Observation:
        """Put the robot back on its feet and return what it observes there."""
        self.world.check_open()
        self.world.load(self._standing)
        disturbances = self.settings.disturbances
        self._disturbance = draw_disturbance(
            disturbances, self.world.n_links, self._rng
        )
        if disturbances.mass_error > 0.0:
            self.world.set_mass_factors(self._disturbance.mass_factors)
        contact = floor_contact(self.world.contacts(), self.world.left_sole, (0.0, 0.0))
        _, velocity = self.world.waist()
        self._watch = _Watch(
            episode=episode,
            zmp=(contact.zmp_x_m, contact.zmp_y_m),
            waist_velocity=(float(velocity[0]), float(velocity[1])),
        )
        return self._observe(self._start, 0, [], contact)

    def execute(self, segment: WaistSegment) -> Observation:
        """Follow a segment to its end, or to the tick where the walk fails.

        Raises:
            ValueError: the segment does not continue the walk, or the walk is over.
        """
        watch = self._watch
        if watch.end_cause is not None:
            raise ValueError(f"the walk is over: {watch.end_cause}")
        if segment.first_tick != watch.control_tick:
            raise ValueError(
                f"segment starts at tick {segment.first_tick}, "
                f"the robot is at tick {watch.control_tick}"
            )
        rows = segment.n_ticks + 1
        self._q_reference = np.empty((rows, len(JOINT_NAMES)))
        status, tick, _ = kinematics.solve_legs(
            segment.waist[:rows],
            segment.left_foot[:rows],
            segment.right_foot[:rows],
            self._q_reference,
        )
        if status != kinematics.SOLVED:
            if status not in _IK_END_CAUSE:
                raise ValueError(f"segment has a number that is not finite, row {tick}")
            watch.end_cause = _IK_END_CAUSE[status]
            return self._observe(segment, 0, [], None)
        positions = self._q_reference.tolist()
        velocities = (np.diff(self._q_reference, axis=0) / CONTROL_PERIOD_S).tolist()
        references = segment.zmp_reference[:rows].tolist()
        ticks: list[ControlTick] = []
        for i in range(segment.n_ticks):
            self._push()
            self.world.step(positions[i], velocities[i])
            ticks.append(self._read(positions[i + 1], references[i + 1]))
            if watch.end_cause is not None:
                break
        return self._observe(segment, len(ticks), ticks, ticks[-1].contact)

    @property
    def control_tick(self) -> int:
        """Control ticks walked since the walk began."""
        return self._watch.control_tick

    @property
    def trajectory_sha256(self) -> str:
        """Hash of the walk so far: every tick's joint states and ZMP, bit for bit."""
        return str(self._watch.trajectory.hexdigest())

    # -- snapshots -----------------------------------------------------------------

    def snapshot(self) -> BipedSnapshot:
        """Keep the walk as it stands, so that `restore` continues it bit for bit."""
        self.world.check_open()
        return BipedSnapshot(
            world_state=self.world.save(),
            watch=self._watch.copy(),
            disturbance=self._disturbance,
            rng_state=copy.deepcopy(dict(self._rng.bit_generator.state)),
        )

    def restore(self, snapshot: BipedSnapshot) -> None:
        """Go back to a snapshot of this biped."""
        self.world.check_open()
        self.world.load(snapshot.world_state)
        self._watch = snapshot.watch.copy()
        self._disturbance = snapshot.disturbance
        if self.settings.disturbances.mass_error > 0.0:
            self.world.set_mass_factors(snapshot.disturbance.mass_factors)
        self._rng.bit_generator.state = snapshot.rng_state

    def release(self, snapshot: BipedSnapshot) -> None:
        """Free a snapshot that is no longer needed."""
        self.world.check_open()
        if snapshot.world_state == self._standing:
            raise SnapshotError("the standing robot is needed for every reset")
        self.world.release(snapshot.world_state)

    def close(self) -> None:
        """End the world."""
        self.world.close()

    # -- inner steps ---------------------------------------------------------------

    def _settle(self) -> None:
        pose = (self._start.waist[:1], self._start.left_foot[:1], self._start.right_foot[:1])  # fmt: skip  # noqa: E501
        q = kinematics.leg_joint_positions(*pose)[0]
        self.world.place(pose[0][0], q)
        self._q_reference = np.array([q])
        still = [0.0] * len(q)
        for _ in range(_SETTLING_TICKS):
            self.world.step(q.tolist(), still)

    def _push(self) -> None:
        push = self._disturbance
        if push.push_from_tick <= self._watch.control_tick < push.push_to_tick:
            self.world.push(push.push_force_n)

    def _read(
        self, joint_reference: list[float], zmp_reference: list[float]
    ) -> ControlTick:
        """Read the sensors after a control tick and watch the limits."""
        watch = self._watch
        watch.control_tick += 1
        position, velocity, torque = self.world.joint_states()
        contact = floor_contact(self.world.contacts(), self.world.left_sole, watch.zmp)
        watch.zmp = (contact.zmp_x_m, contact.zmp_y_m)
        zmp_error = math.hypot(
            contact.zmp_x_m - zmp_reference[0], contact.zmp_y_m - zmp_reference[1]
        )
        loaded = contact.left_load_n + contact.right_load_n > 0.0
        watch.unloaded_ticks = 0 if loaded else watch.unloaded_ticks + 1
        fastest = max(map(abs, velocity))
        saturated = any(map(operator.ge, map(abs, torque), self._torque_marks))
        watch.saturated_ticks = watch.saturated_ticks + 1 if saturated else 0
        limits = self.settings.limits
        # A sum is finite only if all of its terms are.
        if not math.isfinite(zmp_error + sum(position) + sum(velocity) + sum(torque)):
            watch.end_cause = EndCause.PHYSICS_NAN
        elif contact.penetration_m > limits.foot_penetration_m:
            watch.end_cause = EndCause.FOOT_THROUGH_FLOOR
        elif zmp_error >= limits.zmp_error_m:
            watch.end_cause = EndCause.ZMP_ERROR
        elif fastest >= limits.joint_velocity_rad_s:
            watch.end_cause = EndCause.JOINT_VELOCITY
        elif watch.saturated_ticks >= self._saturation_limit:
            watch.end_cause = EndCause.TORQUE_SATURATION
        elif watch.unloaded_ticks >= self._unloaded_limit:
            watch.end_cause = EndCause.FEET_UNLOADED
        tick = ControlTick(
            watch.control_tick,
            joint_reference,
            position,
            velocity,
            torque,
            contact,
            zmp_error,
        )
        if self.on_tick is not None:
            self.on_tick(tick)
        return tick

    def _observe(
        self,
        segment: WaistSegment,
        row: int,
        ticks: list[ControlTick],
        contact: FloorContact | None,
    ) -> Observation:
        """Sum up a learning tick, seen from its last control tick (row of segment)."""
        watch = self._watch
        waist, velocity = self.world.waist()
        right_support = bool(segment.right_support[row])
        support_foot = (segment.right_foot if right_support else segment.left_foot)[row]
        zmp_error = np.subtract(watch.zmp, segment.zmp_reference[row])
        acceleration = (
            np.subtract(velocity[:2], watch.waist_velocity) / LEARNING_PERIOD_S
        )
        watch.waist_velocity = (float(velocity[0]), float(velocity[1]))
        waist_in_support_foot = waist[:2] - support_foot[:2]
        noise = self.settings.disturbances
        if noise.position_noise_m > 0.0:
            waist_in_support_foot += noise.position_noise_m * self._rng.standard_normal(2)  # fmt: skip  # noqa: E501
        if noise.zmp_noise_m > 0.0:
            zmp_error += noise.zmp_noise_m * self._rng.standard_normal(2)
        if noise.acceleration_noise_m_s2 > 0.0:
            acceleration += noise.acceleration_noise_m_s2 * self._rng.standard_normal(2)
        sums = sum_up(ticks, self._q_reference, watch.trajectory)
        left = contact is not None and contact.left_load_n > 0.0
        right = contact is not None and contact.right_load_n > 0.0
        return Observation(
            episode=watch.episode,
            control_tick=watch.control_tick,
            phase=PhaseFlags(
                planned_right_support=right_support,
                planned_double_support=bool(segment.double_support[row]),
                measured_right_support=right
                and contact is not None
                and contact.right_load_n > contact.left_load_n,
                measured_double_support=left and right,
                step_index=int(segment.step_index[row]),
            ),
            waist_in_support_foot_m=_pair(waist_in_support_foot),
            zmp_error_m=_pair(zmp_error),
            waist_acceleration_m_s2=_pair(acceleration),
            **sums._asdict(),
            end_cause=watch.end_cause,
        )


def _ticks(duration_s: float) -> int:
    return max(1, microseconds(duration_s) // CONTROL_PERIOD_US)


def _pair(values: NDArray[np.float64]) -> tuple[float, float]:
    return float(values[0]), float(values[1])
