"""The simulated biped: executes waist segments, watches its limits, observes.

One walk is `begin_walk` and then `execute` per learning tick, until the observation
carries an end cause or the caller has seen enough.
"""

from __future__ import annotations

import copy
import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from biped_common.timing import seconds
from biped_description import kernels
from biped_description.links import LINK_NAMES
from biped_description.robot import Robot
from msgs_json.end_cause import EndCause
from msgs_json.observation import Observation
from msgs_json.segment import WaistSegment
from sim_node.contact import NO_CONTACT, FloorContact
from sim_node.control_tick import ControlTick, phase_flags
from sim_node.disturbance import Disturbance, draw_disturbance
from sim_node.errors import PlantStoppedError, SnapshotError, WorldClosedError
from sim_node.joint_references import JointReferences, solve, standing
from sim_node.limit_watch import LimitCounts, LimitWatch
from sim_node.physics import Array
from sim_node.plant import make_plant
from sim_node.settings import ROBOT, SimSettings
from sim_node.tick_sums import TickRows

# The solver leaves the drop of the first contact behind well within 0.3 s.
_SETTLING_TICKS = 150
_NO_NOISE = [[0.0, 0.0]] * 3
_IK_END_CAUSE = {
    kernels.UNREACHABLE: EndCause.IK_UNREACHABLE,
    kernels.BEYOND_JOINT_LIMIT: EndCause.IK_JOINT_LIMIT,
}


@dataclass(frozen=True, eq=False)
class BipedSnapshot:
    """A walk in its middle; valid for the biped that made it, until released."""

    world_state: int
    watch: _Watch
    disturbance: Disturbance
    rng_state: dict[str, Any]
    references: JointReferences


@dataclass
class _Watch:
    """What the robot remembers from tick to tick besides the physics."""

    episode: int = 0
    clock_ticks: int = 0
    control_tick: int = 0
    contact: FloorContact = NO_CONTACT
    waist_velocity: tuple[float, float] = (0.0, 0.0)
    limits: LimitCounts = field(default_factory=LimitCounts)
    end_cause: EndCause | None = None
    chance: Mapping[str, Any] = field(default_factory=dict)
    """State of the generator before the walk, where disturbances are drawn."""
    trajectory: Any = field(default_factory=hashlib.sha256)
    """Running hash of all that was measured."""

    def copy(self) -> _Watch:
        """Return an independent copy."""
        return replace(
            self, limits=replace(self.limits), trajectory=self.trajectory.copy()
        )


class SimulatedBiped:
    """The robot in its world, from reset to the end of a walk."""

    def __init__(
        self,
        robot: Robot,
        settings: SimSettings,
        start: WaistSegment,
        rng: np.random.Generator,
        on_tick: Callable[[ControlTick], None] | None = None,
        name: str = "in-process",
    ) -> None:
        """Build the world and let the robot settle in its starting pose.

        Args:
            robot: that is simulated.
            settings: limits and disturbances.
            start: a segment whose row 0 is the pose in which walks start.
            rng: source of all disturbances; nothing is drawn where none is random.
            on_tick: called after every control tick.
            name: of this simulation's run, for observations.
        """
        self._name = name
        self.robot = robot
        self.settings = settings
        self.on_tick = on_tick
        self._rng = rng
        self._start = start
        sizes = settings.disturbances
        torque_limits_nm = robot.torque_limit_nm * sizes.torque_limit_factor
        self.world = make_plant(robot, settings, torque_limits_nm, rng)
        self._open = True
        self._noise_sizes = np.array(
            [
                [sizes.position_noise_m],
                [sizes.zmp_noise_m],
                [sizes.acceleration_noise_m_s2],
            ]
        )
        self._limit_watch = LimitWatch(
            settings.limits,
            robot.settings.velocity_limit_rad_s,
            torque_limits_nm,
        )
        self._references = standing(start)
        self._snapshots: set[BipedSnapshot] = set()
        self._rows = TickRows()
        """Since the last observation."""
        self._disturbance = draw_disturbance(
            replace(settings.disturbances, push_force_n=0.0, mass_error=0.0),
            len(LINK_NAMES),
            np.random.default_rng(0),
        )
        self._watch = _Watch()
        self._standing_contact = self._settle()
        self._standing = self.world.save()

    # -- a walk --------------------------------------------------------------------

    def begin_walk(self, episode: int) -> Observation:
        """Put the robot back on its feet and return what it observes there.

        The clock goes on by one tick, so that no two observations share a time. After
        a walk that ended from outside the disturbances are the same as in it.
        """
        self._check_open()
        end_cause = None
        try:
            self.world.load(self._standing)
        except PlantStoppedError as stopped:
            end_cause = stopped.cause
        disturbances = self.settings.disturbances
        chance: Mapping[str, Any] = {}
        if self.settings.random:
            last = self._watch
            if last.end_cause is not None and last.end_cause.from_outside:
                self._rng.bit_generator.state = last.chance
            chance = self._rng.bit_generator.state
        if disturbances.random:
            self._disturbance = draw_disturbance(
                disturbances, len(LINK_NAMES), self._rng
            )
        if disturbances.mass_error > 0.0:
            self.world.set_mass_factors(self._disturbance.mass_factors)
        _, velocity = self.world.waist()
        self._watch = _Watch(
            episode=episode,
            clock_ticks=self._watch.clock_ticks + 1,
            contact=self._standing_contact,
            waist_velocity=velocity[:2],
            end_cause=end_cause,
            chance=chance,
        )
        self._references = standing(self._start)
        self._rows.clear()
        return self.observe()

    def execute(self, segment: WaistSegment) -> Observation:
        """Follow a segment to its end, or to the tick where the walk fails.

        Raises:
            ValueError: the segment does not continue the walk, or the walk is over.
        """
        self._check_walking()
        if segment.first_tick != self._watch.control_tick:
            raise ValueError(
                f"segment starts at tick {segment.first_tick}, "
                f"the robot is at tick {self._watch.control_tick}"
            )
        # A robot that keeps its own time is told the look-ahead, too.
        ahead = self.settings.engine == ROBOT
        self.follow(segment, rows=None if ahead else segment.n_ticks + 1)
        self._walk(segment.first_tick + segment.n_ticks)
        return self.observe()

    def follow(self, segment: WaistSegment, rows: int | None = None) -> None:
        """Take over the references of a segment, from the present tick on.

        A segment that the legs cannot follow within its own ticks ends the walk here,
        before it is begun; look-ahead is followed as far as they can.

        Args:
            segment: begins at or before the present control tick.
            rows: how many of its rows to use; all by default.

        Raises:
            ValueError: the segment is not about the present tick, has a number that is
                not finite, or the walk is over.
        """
        self._check_walking()
        watch = self._watch
        rows = len(segment.waist) if rows is None else rows
        if not 0 <= watch.control_tick - segment.first_tick < rows - 1:
            raise ValueError(
                f"segment of ticks {segment.first_tick} to "
                f"{segment.first_tick + rows - 1}, "
                f"the robot is at tick {watch.control_tick}"
            )
        if segment.n_ticks < 1:
            raise ValueError("segment without a tick")
        references, status = solve(self.robot, segment, rows)
        if references.rows <= segment.n_ticks:
            watch.end_cause = _IK_END_CAUSE[status]
            watch.clock_ticks += 1  # no two observations share one
            return
        self._references = references
        self.world.plan(references.q[self._row() + 1 : references.rows])

    def advance(self) -> None:
        """Walk one control tick along the references.

        Raises:
            ValueError: the walk is over, or the references are used up.
        """
        self._check_walking()
        if self.ticks_ahead < 1:
            raise ValueError(f"no reference for tick {self._watch.control_tick + 1}")
        self._walk(self._watch.control_tick + 1)

    def _walk(self, to_tick: int) -> None:
        """Walk to a control tick, or to the one that ends the walk."""
        # Once per 2 ms of every walk: what does not change is looked up before.
        world, watch, references = self.world, self._watch, self._references
        push, check = self._disturbance, self._limit_watch.check
        first = row = self._row()
        joints = self._rows.joints(to_tick - watch.control_tick)
        zmp = []
        while watch.control_tick < to_tick and watch.end_cause is None:
            if push.push_from_tick <= watch.control_tick < push.push_to_tick:
                world.push(push.push_force_n)
            measured = joints[row - first]
            watch.clock_ticks += 1
            try:
                contact = world.step(references.q[row], references.dq[row], measured)
            except PlantStoppedError as stopped:
                watch.end_cause = stopped.cause
                break
            row += 1
            watch.control_tick += 1
            if not contact.loaded:
                contact = contact.holding(watch.contact)
            watch.contact = contact
            zmp_x_m, zmp_y_m = contact.zmp_x_m, contact.zmp_y_m
            reference_x_m, reference_y_m = references.zmp[row]
            error_m = math.hypot(zmp_x_m - reference_x_m, zmp_y_m - reference_y_m)
            zmp.append((zmp_x_m, zmp_y_m, error_m))
            watch.end_cause = check(watch.limits, measured, contact, error_m)
            if self.on_tick is not None:
                self.on_tick(self._control_tick(row, measured, error_m))
        self._rows.add(references.q[first + 1 : row + 1], references.dq[first:row], zmp)

    def _control_tick(
        self, row: int, measured: Array, zmp_error_m: float
    ) -> ControlTick:
        """Return the control tick that has led to a row of the references."""
        watch, references = self._watch, self._references
        position, velocity, torque = measured.reshape(3, -1).tolist()
        return ControlTick(
            watch.clock_ticks,
            watch.control_tick,
            references.q[row].tolist(),
            references.dq[row - 1].tolist(),
            tuple(position),
            tuple(velocity),
            tuple(torque),
            watch.contact,
            references.zmp[row],
            zmp_error_m,
            references.phase(row),
        )

    def observe(self) -> Observation:
        """Sum up the control ticks since the last observation, as seen from the last.

        Numbers that the physics left undefined are reported as zero, with the end
        cause `physics_nan`.
        """
        watch, references, row = self._watch, self._references, self._row()
        segment, planned = references.segment, references.phase(row)
        waist, velocity = self.world.waist()
        if not math.isfinite(sum(waist)):
            watch.end_cause = EndCause.PHYSICS_NAN
        foot = segment.right_foot if planned[0] else segment.left_foot
        # Over the time since the last observation; the walk's last one is shorter.
        period_s = seconds(max(1, len(self._rows)))
        noise = _NO_NOISE
        if self.settings.disturbances.random:
            # Drawn also where its size is zero, so that a size changes no other draw.
            noise = (self._noise_sizes * self._rng.standard_normal((3, 2))).tolist()
        waist_in_support_foot = _measured(waist, foot[row].tolist(), noise[0])
        zmp_error = _measured(watch.contact, references.zmp[row], noise[1])
        acceleration = _measured(velocity, watch.waist_velocity, noise[2], period_s)
        watch.waist_velocity = velocity[:2]
        sums = self._rows.sum_up(watch.control_tick, watch.trajectory)
        self._rows.clear()
        return Observation(
            simulation=self._name,
            episode=watch.episode,
            clock_ticks=watch.clock_ticks,
            control_tick=watch.control_tick,
            phase=phase_flags(planned, watch.contact),
            waist_in_support_foot_m=waist_in_support_foot,
            zmp_error_m=zmp_error,
            waist_acceleration_m_s2=acceleration,
            **sums._asdict(),
            trajectory_sha256=self.trajectory_sha256,
            end_cause=watch.end_cause,
        )

    def end(self, cause: EndCause, failed: bool = False) -> None:
        """End the walk from outside; the clock ticks once.

        Args:
            cause: why.
            failed: end it by this cause even if it has failed.
        """
        if failed or self._watch.end_cause is None:
            self._watch.end_cause = cause
        self._watch.clock_ticks += 1
        self.world.stop()

    @property
    def ticks_ahead(self) -> int:
        """Control ticks for which there are references."""
        return self._references.rows - 1 - self._row()

    @property
    def at_segment_end(self) -> bool:
        """Whether the robot is where its segment wants the next observation."""
        segment = self._references.segment
        return self._watch.control_tick == segment.first_tick + segment.n_ticks

    @property
    def end_cause(self) -> EndCause | None:
        """Why the walk has ended, if it has."""
        return self._watch.end_cause

    @property
    def clock_ticks(self) -> int:
        """Control ticks of the simulation's clock, over all walks."""
        return self._watch.clock_ticks

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
        self._check_open()
        snapshot = BipedSnapshot(
            world_state=self.world.save(),
            watch=self._watch.copy(),
            disturbance=self._disturbance,
            rng_state=copy.deepcopy(dict(self._rng.bit_generator.state)),
            references=self._references,
        )
        self._snapshots.add(snapshot)
        return snapshot

    def restore(self, snapshot: BipedSnapshot) -> None:
        """Go back to a snapshot of this biped.

        Raises:
            SnapshotError: it is another biped's, or was released.
        """
        self._check_own(snapshot)
        self.world.load(snapshot.world_state)
        self._watch = snapshot.watch.copy()
        self._disturbance = snapshot.disturbance
        if self.settings.disturbances.mass_error > 0.0:
            self.world.set_mass_factors(snapshot.disturbance.mass_factors)
        self._rng.bit_generator.state = snapshot.rng_state
        self._references = snapshot.references
        self._rows.clear()

    def release(self, snapshot: BipedSnapshot) -> None:
        """Free a snapshot that is no longer needed.

        Raises:
            SnapshotError: it is another biped's, or was released before.
        """
        self._check_own(snapshot)
        self._snapshots.remove(snapshot)
        self.world.release(snapshot.world_state)

    def close(self) -> None:
        """End the world; harmless when repeated."""
        self._open = False
        self.world.close()

    # -- inner steps ---------------------------------------------------------------

    def _check_open(self) -> None:
        if not self._open:
            raise WorldClosedError("this world has been closed")

    def _check_own(self, snapshot: BipedSnapshot) -> None:
        self._check_open()
        # The engine numbers states per world and uses numbers again.
        if snapshot not in self._snapshots:
            raise SnapshotError(
                f"snapshot {snapshot.world_state} is not kept by this robot's world"
            )

    def _check_walking(self) -> None:
        self._check_open()
        if self._watch.end_cause is not None:
            raise ValueError(f"the walk is over: {self._watch.end_cause}")

    def _settle(self) -> FloorContact:
        """Let the robot come to rest in the stance; return what the floor feels."""
        pose = (self._start.waist[:1], self._start.left_foot[:1], self._start.right_foot[:1])  # fmt: skip  # noqa: E501
        q = self.robot.leg_joint_positions(*pose)[0]
        self.world.place(pose[0][0], q)
        still, measured = np.zeros_like(q), np.zeros(3 * len(q))
        contact = NO_CONTACT
        for _ in range(_SETTLING_TICKS):
            contact = self.world.step(q, still, measured)
        return contact

    def _row(self) -> int:
        """Return the row of the references at which the robot is."""
        return self._watch.control_tick - self._references.segment.first_tick


def _measured(
    value: Sequence[float],
    origin: Sequence[float],
    noise: Sequence[float],
    divisor: float = 1.0,
) -> tuple[float, float]:
    """Return (value - origin) / divisor + noise in x and y; zeros where that is NaN."""
    x = (value[0] - origin[0]) / divisor + noise[0]
    y = (value[1] - origin[1]) / divisor + noise[1]
    return (x, y) if math.isfinite(x + y) else (0.0, 0.0)
