"""The plant without contact: what it measures, and what it shares with PyBullet's."""

import math

import numpy as np
import pytest
from tests.robots import SHIPPED, TALL, TALL_RUN

from biped_common.settings import SettingsError
from biped_description.robot import Robot
from biped_description.settings import RobotSettings
from msgs_json.end_cause import EndCause
from sim_node.contact import NO_CONTACT
from sim_node.disturbance import draw_disturbance
from sim_node.errors import SnapshotError
from sim_node.kinematic_world import KinematicWorld
from sim_node.settings import DisturbanceSettings, SimSettings
from trajectory_node.settings import CorrectionSettings, GaitSettings
from trajectory_node.waist_reference import WaistReference

STURDY = {"zmp_error_m": 1.0}
WEIGHT_N = 9.81 * SHIPPED.mass_kg


@pytest.fixture(scope="module")
def engine():
    return "kinematic"


@pytest.fixture(scope="module")
def completed(build_walker, static_walk):
    """Walk the static walk to its end."""
    walker = build_walker(STURDY, engine="kinematic")
    walker.observations = walker.walk(static_walk)
    yield walker
    walker.robot.close()


# -- motion ----------------------------------------------------------------------------


def test_the_joints_are_on_their_references(completed):
    references = np.array([tick.joint_reference for tick in completed.ticks])
    np.testing.assert_allclose(completed.joints[0], references, rtol=0, atol=1e-14)


def test_the_joints_move_at_their_reference_velocities(completed):
    velocities = [tick.joint_velocity_reference for tick in completed.ticks]
    np.testing.assert_array_equal(completed.joints[1], velocities)


def test_the_joints_need_no_torque(completed):
    np.testing.assert_array_equal(completed.joints[2], 0.0)


def test_the_waist_is_on_its_reference(new_walker, shaky_walk):
    walker = new_walker(STURDY)
    walker.robot.begin_walk(1)
    for segment in shaky_walk[:300]:
        walker.go_on([segment])
        waist = walker.robot.world.waist().position
        np.testing.assert_allclose(waist, segment.waist[10], rtol=0, atol=1e-12)


def test_the_waist_moves_by_its_velocity(walker, shaky_walk):
    walker.walk(shaky_walk[:50])
    before = walker.robot.world.waist().position
    walker.robot.follow(shaky_walk[50])
    walker.robot.advance()
    after, velocity = walker.robot.world.waist()
    moved = np.subtract(after, before)
    np.testing.assert_allclose(velocity, moved / 0.002, rtol=0, atol=1e-9)


def test_the_torso_is_upright(walker):
    assert walker.robot.world.torso_orientation() == (0.0, 0.0, 0.0, 1.0)


# -- contact ---------------------------------------------------------------------------


@pytest.mark.parametrize("axis", [0, 1], ids=["x", "y"])
def test_on_the_static_walk_its_zmp_is_that_of_contact(
    completed, build_walker, static_walk, axis
):
    contact = build_walker(STURDY)
    contact.walk(static_walk)
    contact.robot.close()
    difference = completed.zmp_m[:, axis] - contact.zmp_m[:, axis]
    assert np.sqrt(np.mean(difference**2)) < 0.0005


@pytest.mark.parametrize("axis", [0, 1], ids=["x", "y"])
def test_the_zmp_of_another_robot_is_that_of_contact(build_walker, axis):
    reference = WaistReference(TALL, TALL_RUN.gait, TALL_RUN.correction)
    start = reference.stance()
    segments = [reference.segment(np.zeros(2)) for _ in range(300)]
    zmp_m = []
    for engine in ("pybullet", "kinematic"):
        walker = build_walker(STURDY, robot=TALL, start=start, engine=engine)
        walker.walk(segments)
        walker.robot.close()
        zmp_m.append(walker.zmp_m[:, axis])
    assert np.sqrt(np.mean((zmp_m[0] - zmp_m[1]) ** 2)) < 0.0015


@pytest.mark.parametrize(
    ("double_support_s", "peak_mm"), [(1.05, 67.0), (1.00, 74.0), (0.90, 91.0)]
)
def test_the_static_walk_misses_its_zmp_the_more_the_faster_it_is(
    new_walker, double_support_s, peak_mm
):
    gait = GaitSettings(double_support_s=double_support_s)
    reference = WaistReference(SHIPPED, gait, CorrectionSettings())
    walker = new_walker(STURDY)
    walker.walk([reference.segment(np.zeros(2)) for _ in range(562)])
    worst_mm = 1000 * max(tick.zmp_error_m for tick in walker.ticks)
    assert worst_mm == pytest.approx(peak_mm, abs=2.0)


def test_the_feet_carry_the_weight(completed):
    assert completed.load_n[-1] == pytest.approx(WEIGHT_N)
    assert np.abs(completed.load_n - WEIGHT_N).max() < 0.1 * WEIGHT_N


def test_a_standing_robot_stands_on_both_feet_alike(walker, static_walk):
    walker.walk(static_walk[:1])
    contact = walker.ticks[-1].contact
    assert contact.left_load_n == pytest.approx(contact.right_load_n)


@pytest.mark.parametrize("step", range(5))
def test_in_single_support_the_planned_leg_carries_all(completed, step):
    middle_s = 0.2 + 1.05 + 0.5 * 0.825 + 1.875 * step
    contact = completed.ticks[round(middle_s / 0.002)].contact
    loads = contact.left_load_n, contact.right_load_n
    assert (loads[step % 2] > 0.0, loads[1 - step % 2]) == (True, 0.0)


def test_planned_and_measured_double_support_agree(completed):
    differ = [
        observation.control_tick
        for observation in completed.observations
        if observation.phase.planned_double_support
        != observation.phase.measured_double_support
    ]
    # The foot leaves the floor and comes down so slowly that a few ticks differ.
    assert len(differ) <= 2 * 5


def test_a_robot_that_falls_faster_than_gravity_has_no_contact():
    world = KinematicWorld(SHIPPED, 0.9, SHIPPED.torque_limit_nm)
    pose = np.array([[0.0, 0.0, 0.475]]), np.array([[0.0, 0.09, 0.0]])
    q = SHIPPED.leg_joint_positions(*pose, pose[1] * (1.0, -1.0, 1.0))[0]
    world.place(pose[0][0], q)
    folding = np.zeros(12)
    folding[[2, 3, 4]] = folding[[8, 9, 10]] = -1.0, 2.0, -1.0
    assert world.step(q, folding, np.empty(36)) == NO_CONTACT


# -- limits ----------------------------------------------------------------------------


def test_the_static_walk_fails_by_its_zmp_error_about_when_it_does_in_contact(
    walker, static_walk
):
    end = walker.walk(static_walk)[-1]
    assert end.end_cause is EndCause.ZMP_ERROR
    assert 0.002 * end.control_tick == pytest.approx(2.26, abs=0.05)


def test_a_joint_that_turns_too_fast_ends_the_walk(new_walker, static_walk):
    slow = Robot(RobotSettings(velocity_limit_rad_s=0.3))
    walker = new_walker(robot=slow)
    assert walker.walk(static_walk)[-1].end_cause is EndCause.JOINT_VELOCITY


# -- disturbances ----------------------------------------------------------------------


def test_a_push_shifts_the_zmp_by_its_moment(new_walker, static_walk):
    push = {"push_force_n": 10.0, "push_time_s": 0.1, "push_duration_s": 0.02}
    calm, pushed = new_walker(STURDY), new_walker(STURDY, push)
    calm.walk(static_walk[:10])
    pushed.walk(static_walk[:10])
    shift = pushed.zmp_m - calm.zmp_m
    height_m = 0.475 + SHIPPED.settings.torso_com_height_m
    expected = np.zeros(100)
    expected[50:60] = 10.0 * height_m / WEIGHT_N
    np.testing.assert_allclose(np.hypot(*shift.T), expected, rtol=0, atol=1e-9)


def test_the_floor_carries_the_masses_drawn(new_walker, static_walk):
    walker = new_walker(STURDY, {"mass_error": 0.1}, seed=3)
    walker.walk(static_walk[:1])
    drawn = draw_disturbance(
        DisturbanceSettings(mass_error=0.1), 13, np.random.default_rng(3)
    )
    weight_n = 9.81 * (drawn.mass_factors @ SHIPPED.link_masses_kg)
    assert walker.load_n[0] == pytest.approx(weight_n)


@pytest.mark.parametrize(
    ("name", "value", "nominal"),
    [("friction", 0.5, 0.9), ("torque_limit_factor", 0.5, 1.0)],
)
def test_a_disturbance_without_effect_is_refused_by_name(name, value, nominal):
    disturbances = DisturbanceSettings(**{name: value})
    message = (
        rf"^disturbances\.{name} = {value}: must be {nominal}: it has no effect with "
        "engine = kinematic$"
    )
    with pytest.raises(SettingsError, match=message):
        SimSettings("kinematic", disturbances=disturbances)
    assert SimSettings("pybullet", disturbances=disturbances).disturbances.random is (
        False
    )


# -- states ----------------------------------------------------------------------------


def test_a_state_that_is_not_kept_is_refused():
    world = KinematicWorld(SHIPPED, math.inf, SHIPPED.torque_limit_nm)
    handle = world.save()
    world.release(handle)
    with pytest.raises(SnapshotError, match=r"^state 0 is not kept by this world$"):
        world.load(handle)
