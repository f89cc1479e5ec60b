"""PyBullet's worlds: side by side, their readings, and their end."""

import numpy as np
import pytest
from tests.robots import SHIPPED
from tests.sim_node.bullet import (
    FRICTION,
    LINKS,
    dynamics,
    momentum,
    put_base,
    put_joint,
    throw_base,
)
from tests.sim_node.plain_world import PlainWorld

from sim_node.bullet_api import declared
from sim_node.bullet_kernels import read_joints
from sim_node.errors import SimulationError, SnapshotError, WorldClosedError
from sim_node.pybullet_world import PyBulletWorld

STANDING = np.zeros(12)
IN_THE_AIR = np.array([0.3, -0.2, 3.0])


def new_world(friction: float = 0.9, torque_share: float = 1.0) -> PyBulletWorld:
    limits_nm = torque_share * SHIPPED.torque_limit_nm
    return PyBulletWorld(SHIPPED, friction, limits_nm)


def step(world, q):
    """Hold the joints at q for a control tick; return what they measure (3, 12)."""
    measured = np.empty(36)
    world.step(q, STANDING, measured)
    return measured.reshape(3, 12)


@pytest.fixture
def world():
    world = new_world()
    yield world
    world.close()


# -- readings --------------------------------------------------------------------------


def test_the_waist_is_where_the_robot_was_placed(world):
    world.place(IN_THE_AIR, STANDING)
    np.testing.assert_allclose(world.waist()[0], IN_THE_AIR, rtol=0, atol=1e-8)


def test_the_waist_of_a_tilted_robot_is_below_its_torso(world):
    quarter_turn_about_x = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
    put_base(world, (0.0, 0.0, 3.0), quarter_turn_about_x)
    expected = [0.0, SHIPPED.settings.torso_com_height_m, 3.0]
    np.testing.assert_allclose(world.waist()[0], expected, rtol=0, atol=1e-8)


def test_the_waist_of_a_spinning_robot_swings_about_its_torso(world):
    world.place(IN_THE_AIR, STANDING)
    throw_base(world, (1.0, 0.0, 0.0), spin=(0.0, 2.0, 0.0))
    expected = [1.0 - 2.0 * SHIPPED.settings.torso_com_height_m, 0.0, 0.0]
    np.testing.assert_allclose(world.waist()[1], expected, rtol=0, atol=1e-7)


def test_the_joints_are_where_they_were_placed(world):
    q = np.linspace(-0.3, 0.3, 12)
    world.place(IN_THE_AIR, q)
    measured = np.empty(36)
    read_joints(world.client, world.robot, world.joint_numbers, measured)
    np.testing.assert_allclose(measured[:12], q, rtol=0, atol=1e-12)


def test_a_placed_robot_is_at_rest(world):
    world.place(IN_THE_AIR, STANDING)
    np.testing.assert_array_equal(momentum(world), np.zeros(3))


# -- mechanics -------------------------------------------------------------------------


def test_a_falling_robot_gains_momentum_by_its_weight(world):
    world.place(IN_THE_AIR, STANDING)
    step(world, STANDING)
    expected = [0.0, 0.0, -9.81 * SHIPPED.mass_kg * 0.002]
    np.testing.assert_allclose(momentum(world), expected, rtol=0, atol=1e-9)


def test_a_push_lasts_one_tick_and_adds_its_impulse(world):
    world.place(IN_THE_AIR, STANDING)
    world.push((30.0, -40.0, 0.0))
    for _ in range(3):
        step(world, STANDING)
    np.testing.assert_allclose(momentum(world)[:2], [0.06, -0.08], rtol=1e-3)


def test_the_motors_hold_their_references_in_free_fall(world):
    q = np.linspace(0.1, 0.5, 12)
    world.place(IN_THE_AIR, q)
    for _ in range(100):
        positions, _, _ = step(world, q)
    np.testing.assert_allclose(positions, q, rtol=0, atol=1e-6)


def test_without_torque_the_joints_are_free():
    world = new_world(torque_share=0.0)
    world.place(IN_THE_AIR, STANDING)
    put_joint(world, 4, 0.0, 3.0)
    _, velocities, _ = step(world, STANDING)
    assert velocities[4] == pytest.approx(3.0, abs=0.05)
    world.close()


def test_sliding_soles_are_braked_by_friction_times_weight():
    world = new_world(friction=0.05)
    waist, left_foot = np.array([[0.0, 0.0, 0.475]]), np.array([[0.0, 0.09, 0.0]])
    q = SHIPPED.leg_joint_positions(waist, left_foot, left_foot * (1.0, -1.0, 1.0))[0]
    world.place(waist[0], q)
    for _ in range(150):
        step(world, q)
    throw_base(world, (1.0, 0.0, 0.0))
    for _ in range(100):
        step(world, q)
    speed = momentum(world)[0] / SHIPPED.mass_kg
    world.close()
    assert speed == pytest.approx(1.0 - 0.05 * 9.81 * 0.2, abs=0.005)


def test_mass_factors_scale_mass_and_inertia(world):
    def mass_properties():
        return np.array([dynamics(world, link)[:4] for link in LINKS])

    nominal = mass_properties()
    factors = np.linspace(0.7, 1.3, 13)
    world.set_mass_factors(np.ones(13) * 2.0)
    world.set_mass_factors(factors)
    expected = factors[:, None] * nominal
    np.testing.assert_allclose(mass_properties(), expected, rtol=1e-12)


# -- the same by PyBullet's Python functions -------------------------------------------


def everything_measured(world, segments):
    """Follow segments; return all that joints, floor and waist measure, by tick."""
    measured = []
    for segment in segments:
        pose = segment.waist, segment.left_foot, segment.right_foot
        motion = SHIPPED.leg_motion(*pose, 0.002)
        for q, dq in zip(motion.q, motion.dq, strict=False):
            joints = np.empty(36)
            contact = world.step(q, dq, joints)
            position, velocity = world.waist()
            measured.append([*joints, *contact, *position, *velocity])
    return measured


def test_it_is_the_world_of_pybullets_python_functions_bit_for_bit(shaky_walk):
    """Walk, be pushed, go back, and walk on with other masses, in both worlds."""
    start, walked = shaky_walk[0], []
    pose = start.waist[:1], start.left_foot[:1], start.right_foot[:1]
    for kind in (PyBulletWorld, PlainWorld):
        world = kind(SHIPPED, 0.7, 0.9 * SHIPPED.torque_limit_nm)
        world.place(start.waist[0], SHIPPED.leg_joint_positions(*pose)[0])
        measured = everything_measured(world, shaky_walk[:50])
        handle = world.save()
        world.push((20.0, -10.0, 0.0))
        measured += everything_measured(world, shaky_walk[50:80])
        world.load(handle)
        world.release(handle)
        world.set_mass_factors(np.linspace(0.9, 1.1, 13))
        measured += everything_measured(world, shaky_walk[50:80])
        world.close()
        walked.append(measured)
    np.testing.assert_array_equal(*walked)


def test_a_library_without_the_api_is_refused_by_the_name_of_what_it_lacks():
    with pytest.raises(ImportError, match=r"libc\.so.* does not export b3Connect"):
        declared("libc.so.6")


# -- states ----------------------------------------------------------------------------


def test_a_state_that_was_never_kept_is_refused(world):
    with pytest.raises(SnapshotError, match=r"^state 17 is not kept by this world$"):
        world.load(17)


def test_a_released_state_is_refused(world):
    handle = world.save()
    world.release(handle)
    with pytest.raises(SnapshotError):
        world.load(handle)


# -- several worlds --------------------------------------------------------------------


def test_closing_one_world_leaves_the_other(new_walker, shaky_walk):
    alone, one, other = (new_walker() for _ in range(3))
    alone.walk(shaky_walk[:40])
    one.walk(shaky_walk[:20])
    other.walk(shaky_walk[:20])
    other.robot.close()
    one.go_on(shaky_walk[20:40])
    np.testing.assert_array_equal(one.everything, alone.everything)


def test_a_new_world_does_not_disturb_a_walk_under_way(new_walker, shaky_walk):
    alone, one = new_walker(), new_walker()
    alone.walk(shaky_walk[:40])
    one.walk(shaky_walk[:20])
    new_walker().walk(shaky_walk[:10])
    one.go_on(shaky_walk[20:40])
    np.testing.assert_array_equal(one.everything, alone.everything)


def test_the_friction_of_one_world_is_not_that_of_another():
    slippery, rough = new_world(friction=0.1), new_world(friction=0.8)
    frictions = [dynamics(each, each.left_sole)[FRICTION] for each in (slippery, rough)]
    slippery.close()
    rough.close()
    assert frictions == [0.1, 0.8]


# -- the end ---------------------------------------------------------------------------


def test_a_world_can_be_closed_twice(world):
    world.close()
    world.close()
    assert not world.client


@pytest.mark.parametrize("call", ["begin_walk", "snapshot", "restore", "release"])
def test_a_closed_world_is_refused_by_name(walker, call):
    walker.robot.begin_walk(1)
    snapshot = walker.robot.snapshot()
    argument = {"begin_walk": (2,), "snapshot": ()}.get(call, (snapshot,))
    walker.robot.close()
    with pytest.raises(WorldClosedError, match=r"^this world has been closed$"):
        getattr(walker.robot, call)(*argument)


@pytest.mark.parametrize("error", [WorldClosedError, SnapshotError])
def test_every_error_is_a_simulation_error(error):
    assert issubclass(error, SimulationError)
