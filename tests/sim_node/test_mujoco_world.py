"""MuJoCo's plant: what it measures, and what it shares with PyBullet's."""

import numpy as np
import pytest
from tests.robots import SHIPPED, TALL, TALL_RUN

from msgs_json.end_cause import EndCause
from sim_node.disturbance import draw_disturbance
from sim_node.errors import SnapshotError
from sim_node.mujoco_world import MuJoCoWorld
from sim_node.settings import DisturbanceSettings
from trajectory_node.waist_reference import WaistReference

STURDY = {"zmp_error_m": 1.0}
STANDING = np.zeros(12)
IN_THE_AIR = np.array([0.3, -0.2, 3.0])
WEIGHT_N = 9.81 * SHIPPED.mass_kg


@pytest.fixture(scope="module")
def engine():
    return "mujoco"


def new_world(friction: float = 0.9, torque_share: float = 1.0) -> MuJoCoWorld:
    return MuJoCoWorld(SHIPPED, friction, torque_share * SHIPPED.torque_limit_nm)


@pytest.fixture
def world():
    return new_world()


def step(world, q, dq=STANDING):
    """Drive the joints for a control tick; return what they measure (3, 12)."""
    measured = np.empty(36)
    world.step(q, dq, measured)
    return measured.reshape(3, 12)


def settled(friction: float = 0.9) -> tuple[MuJoCoWorld, np.ndarray]:
    """Let a robot stand on both feet; return its world and its joint positions."""
    world = new_world(friction)
    waist, left_foot = np.array([[0.0, 0.0, 0.475]]), np.array([[0.0, 0.09, 0.0]])
    q = SHIPPED.leg_joint_positions(waist, left_foot, left_foot * (1.0, -1.0, 1.0))[0]
    world.place(waist[0], q)
    for _ in range(150):
        step(world, q)
    return world, q


@pytest.fixture(scope="module")
def completed(build_walker, static_walk):
    """Walk the static walk to its end, on each engine."""
    walkers = {}
    for engine in ("mujoco", "pybullet", "kinematic"):
        walkers[engine] = walker = build_walker(STURDY, engine=engine)
        walker.observations = walker.walk(static_walk)
        walker.stands_at = walker.robot.world.waist().position
        walker.robot.close()
    return walkers


# -- agreement -------------------------------------------------------------------------


@pytest.mark.parametrize("other", ["pybullet", "kinematic"])
def test_on_the_static_walk_its_zmp_is_within_1_mm_of_another_engines(completed, other):
    apart_m = completed["mujoco"].zmp_m - completed[other].zmp_m
    assert np.sqrt((apart_m**2).sum(axis=1).mean()) < 0.001


def test_its_feet_land_without_a_peak_in_the_zmp(completed):
    worst_m = {
        engine: max(tick.zmp_error_m for tick in walker.ticks)
        for engine, walker in completed.items()
    }
    assert worst_m["mujoco"] == pytest.approx(worst_m["pybullet"], abs=0.0005)


def test_its_servos_need_the_torques_of_the_other_engine(completed):
    torques = [completed[engine].joints[2] for engine in ("mujoco", "pybullet")]
    apart_nm = np.sqrt(np.mean((torques[0] - torques[1]) ** 2))
    assert apart_nm < 0.25 * np.sqrt(np.mean(torques[1] ** 2))


def test_its_joints_are_on_their_references(completed):
    references = [tick.joint_reference for tick in completed["mujoco"].ticks]
    positions = completed["mujoco"].joints[0]
    np.testing.assert_allclose(positions, references, rtol=0, atol=1e-4)


def test_its_walk_ends_where_the_other_engines_does(completed):
    ends = [completed[engine].stands_at for engine in ("mujoco", "pybullet")]
    np.testing.assert_allclose(*ends, rtol=0, atol=1e-4)


def test_its_static_walk_fails_at_the_tick_of_the_other_engines(
    build_walker, static_walk
):
    ends = []
    for engine in ("mujoco", "pybullet"):
        walker = build_walker(engine=engine)
        ends.append(walker.walk(static_walk)[-1])
        walker.robot.close()
    assert [end.end_cause for end in ends] == [EndCause.ZMP_ERROR] * 2
    assert abs(ends[0].control_tick - ends[1].control_tick) <= 2


def test_the_zmp_of_another_robot_is_that_of_the_other_engine(build_walker):
    reference = WaistReference(TALL, TALL_RUN.gait, TALL_RUN.correction)
    start = reference.stance()
    segments = [reference.segment(np.zeros(2)) for _ in range(300)]
    zmp_m = []
    for engine in ("pybullet", "mujoco"):
        walker = build_walker(STURDY, robot=TALL, start=start, engine=engine)
        walker.walk(segments)
        walker.robot.close()
        zmp_m.append(walker.zmp_m)
    assert np.sqrt(((zmp_m[0] - zmp_m[1]) ** 2).sum(axis=1).mean()) < 0.0015


# -- readings --------------------------------------------------------------------------


def test_the_waist_is_where_the_robot_was_placed_and_at_rest(world):
    world.place(IN_THE_AIR, STANDING)
    assert world.waist() == (tuple(IN_THE_AIR), (0.0, 0.0, 0.0))


def test_a_placed_robot_is_upright(world):
    world.place(IN_THE_AIR, STANDING)
    assert world.torso_orientation() == (0.0, 0.0, 0.0, 1.0)


def test_a_robot_pressed_into_the_floor_says_how_deep(world):
    height_m = SHIPPED.settings.stretched_leg_length_m
    world.place(np.array([0.0, 0.0, height_m - 0.02]), STANDING)
    contact = world.step(STANDING, STANDING, np.empty(36))
    assert contact.penetration_m == pytest.approx(0.02)


def test_the_feet_share_the_weight():
    world, q = settled()
    contact = world.step(q, STANDING, np.empty(36))
    loads_n = contact.left_load_n, contact.right_load_n
    assert loads_n == pytest.approx([WEIGHT_N / 2.0] * 2, rel=1e-4)


# -- mechanics -------------------------------------------------------------------------


def test_a_robot_in_the_air_falls(world):
    world.place(IN_THE_AIR, STANDING)
    contact = world.step(STANDING, STANDING, np.empty(36))
    assert not contact.loaded
    assert world.waist().velocity == pytest.approx((0.0, 0.0, -9.81 * 0.002))


def test_a_push_lasts_one_tick(world):
    world.place(IN_THE_AIR, STANDING)
    world.push((30.0, 0.0, 0.0))
    speeds = []
    for _ in range(2):
        step(world, STANDING)
        speeds.append(world.waist().velocity[0])
    # The torso's frame is at the waist, the push above it: the robot turns as well.
    assert 0.0 < speeds[0] < 30.0 * 0.002 / SHIPPED.mass_kg
    assert speeds[1] == pytest.approx(speeds[0], rel=0.01)


def test_the_floor_carries_the_masses_drawn(new_walker, static_walk):
    walker = new_walker(STURDY, {"mass_error": 0.1}, seed=3)
    walker.walk(static_walk[:8])
    drawn = draw_disturbance(
        DisturbanceSettings(mass_error=0.1), 13, np.random.default_rng(3)
    )
    weight_n = 9.81 * (drawn.mass_factors @ SHIPPED.link_masses_kg)
    assert walker.load_n[-1] == pytest.approx(weight_n, rel=1e-3)


@pytest.mark.parametrize("factor", [0.1, 0.3, 1.0])
def test_no_joint_exceeds_the_torque_that_is_there(new_walker, shaky_walk, factor):
    limits = STURDY | {"torque_saturation_s": 10.0, "unloaded_feet_s": 10.0}
    walker = new_walker(limits, {"torque_limit_factor": factor})
    walker.walk(shaky_walk[:100])
    torques_nm = np.abs(walker.joints[2])
    assert (torques_nm <= factor * SHIPPED.torque_limit_nm + 1e-9).all()
    saturated = torques_nm >= 0.999 * factor * SHIPPED.torque_limit_nm
    assert saturated.any() == (factor < 1.0)


def test_without_torque_the_joints_are_free():
    world = new_world(torque_share=0.0)
    world.place(IN_THE_AIR, STANDING)
    driven = np.full(12, 3.0)
    _, velocities, torques = step(world, STANDING, driven)
    assert not torques.any()
    np.testing.assert_allclose(velocities, 0.0, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("friction", "slips"), [(0.9, False), (0.02, True), (0.0, True)]
)
def test_feet_slip_where_friction_is_low(new_walker, shaky_walk, friction, slips):
    walker = new_walker(STURDY | {"unloaded_feet_s": 5.0}, {"friction": friction})
    walker.walk(shaky_walk[:80])
    waist_m = walker.robot.world.waist().position
    off_m = np.hypot(*(waist_m - shaky_walk[79].waist[10])[:2])
    assert (off_m > 0.001) == slips


@pytest.mark.parametrize(
    "world_is_lost_by",
    [
        lambda world, q: world.push((np.nan, 0.0, 0.0)),
        lambda world, q: step(world, np.full(12, np.nan)),
        lambda world, q: world.place(np.full(3, np.nan), q),
    ],
    ids=["push", "servo", "place"],
)
def test_what_is_no_number_stays_none_and_leaves_no_file_behind(
    world_is_lost_by, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    world, q = settled()
    world_is_lost_by(world, q)
    joints = np.empty(36)
    for _ in range(3):
        world.step(q, STANDING, joints)
    assert np.isnan(joints[:12]).any()
    assert np.isnan(world.waist().position).any()
    assert not list(tmp_path.iterdir())


def test_a_walk_in_a_world_that_is_no_number_ends_at_once(walker, static_walk):
    walker.walk(static_walk[:1])
    walker.robot.world.push((np.nan, 0.0, 0.0))
    end = walker.go_on(static_walk[1:])[-1]
    assert (end.end_cause, end.control_tick) == (EndCause.PHYSICS_NAN, 11)


# -- states ----------------------------------------------------------------------------


def test_a_state_that_is_not_kept_is_refused(world):
    handle = world.save()
    world.release(handle)
    with pytest.raises(SnapshotError, match=r"^state 0 is not kept by this world$"):
        world.load(handle)


def test_a_closed_world_keeps_no_states(world):
    handle = world.save()
    world.close()
    world.close()
    with pytest.raises(SnapshotError):
        world.load(handle)
