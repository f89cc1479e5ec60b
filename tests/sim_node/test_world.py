"""Worlds side by side, their readings, and their end."""

import numpy as np
import pybullet
import pytest
from tests.robots import SHIPPED

from sim_node.errors import SimulationError, SnapshotError, WorldClosedError
from sim_node.world import World

STANDING = np.zeros(12)
IN_THE_AIR = np.array([0.3, -0.2, 3.0])


@pytest.fixture
def world():
    world = World(SHIPPED)
    yield world
    world.close()


def momentum(world):
    """Return the (3,) linear momentum of all links [kg m/s]."""
    base, _ = pybullet.getBaseVelocity(world.robot, physicsClientId=world.client)
    links = pybullet.getLinkStates(
        world.robot,
        list(range(12)),
        computeLinkVelocity=True,
        physicsClientId=world.client,
    )
    velocities = np.array([base, *(link[6] for link in links)])
    return SHIPPED.link_masses_kg @ velocities


# -- readings --------------------------------------------------------------------------


def test_the_waist_is_where_the_robot_was_placed(world):
    world.place(IN_THE_AIR, STANDING)
    np.testing.assert_allclose(world.waist()[0], IN_THE_AIR, rtol=0, atol=1e-8)


def test_the_waist_of_a_tilted_robot_is_below_its_torso(world):
    quarter_turn_about_x = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
    pybullet.resetBasePositionAndOrientation(
        world.robot, (0.0, 0.0, 3.0), quarter_turn_about_x, physicsClientId=world.client
    )
    expected = [0.0, SHIPPED.settings.torso_com_height_m, 3.0]
    np.testing.assert_allclose(world.waist()[0], expected, rtol=0, atol=1e-8)


def test_the_waist_of_a_spinning_robot_swings_about_its_torso(world):
    world.place(IN_THE_AIR, STANDING)
    pybullet.resetBaseVelocity(
        world.robot, (1.0, 0.0, 0.0), (0.0, 2.0, 0.0), physicsClientId=world.client
    )
    expected = [1.0 - 2.0 * SHIPPED.settings.torso_com_height_m, 0.0, 0.0]
    np.testing.assert_allclose(world.waist()[1], expected, rtol=0, atol=1e-7)


def test_the_joints_are_where_they_were_placed(world):
    q = np.linspace(-0.3, 0.3, 12)
    world.place(IN_THE_AIR, q)
    positions, _, _ = world.joint_states()
    np.testing.assert_allclose(positions, q, rtol=0, atol=1e-12)


def test_a_placed_robot_is_at_rest(world):
    world.place(IN_THE_AIR, STANDING)
    np.testing.assert_array_equal(momentum(world), np.zeros(3))


# -- mechanics -------------------------------------------------------------------------


def test_a_falling_robot_gains_momentum_by_its_weight(world):
    world.place(IN_THE_AIR, STANDING)
    world.step(STANDING.tolist(), STANDING.tolist())
    expected = [0.0, 0.0, -9.81 * SHIPPED.mass_kg * 0.002]
    np.testing.assert_allclose(momentum(world), expected, rtol=0, atol=1e-9)


def test_a_push_lasts_one_tick_and_adds_its_impulse(world):
    world.place(IN_THE_AIR, STANDING)
    world.push((30.0, -40.0, 0.0))
    for _ in range(3):
        world.step(STANDING.tolist(), STANDING.tolist())
    np.testing.assert_allclose(momentum(world)[:2], [0.06, -0.08], rtol=1e-3)


def test_the_motors_hold_their_references_in_free_fall(world):
    q = np.linspace(0.1, 0.5, 12)
    world.place(IN_THE_AIR, q)
    for _ in range(100):
        world.step(q.tolist(), STANDING.tolist())
    positions, _, _ = world.joint_states()
    np.testing.assert_allclose(positions, q, rtol=0, atol=1e-6)


def test_without_torque_the_joints_are_free(world):
    world.set_torque_limits(np.zeros(12))
    world.place(IN_THE_AIR, STANDING)
    pybullet.resetJointState(
        world.robot, world.joints[4], 0.0, 3.0, physicsClientId=world.client
    )
    world.step(STANDING.tolist(), STANDING.tolist())
    assert world.joint_states()[1][4] == pytest.approx(3.0, abs=0.05)


def test_sliding_soles_are_braked_by_friction_times_weight(world):
    waist, left_foot = np.array([[0.0, 0.0, 0.475]]), np.array([[0.0, 0.09, 0.0]])
    q = SHIPPED.leg_joint_positions(waist, left_foot, left_foot * (1.0, -1.0, 1.0))[0]
    world.set_friction(0.05)
    world.place(waist[0], q)
    for _ in range(150):
        world.step(q.tolist(), STANDING.tolist())
    pybullet.resetBaseVelocity(
        world.robot, (1.0, 0.0, 0.0), physicsClientId=world.client
    )
    for _ in range(100):
        world.step(q.tolist(), STANDING.tolist())
    speed = momentum(world)[0] / SHIPPED.mass_kg
    assert speed == pytest.approx(1.0 - 0.05 * 9.81 * 0.2, abs=0.005)


def test_mass_factors_scale_mass_and_inertia(world):
    def dynamics():
        infos = [
            pybullet.getDynamicsInfo(world.robot, link, physicsClientId=world.client)
            for link in range(-1, 12)
        ]
        return np.array([(info[0], *info[2]) for info in infos])

    nominal = dynamics()
    factors = np.linspace(0.7, 1.3, 13)
    world.set_mass_factors(np.ones(13) * 2.0)
    world.set_mass_factors(factors)
    np.testing.assert_allclose(dynamics(), factors[:, None] * nominal, rtol=1e-12)


def test_a_world_knows_how_many_links_it_has(world):
    assert world.n_links == len(SHIPPED.links)


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
    slippery, rough = World(SHIPPED), World(SHIPPED)
    slippery.set_friction(0.1)
    rough.set_friction(0.8)
    frictions = [
        pybullet.getDynamicsInfo(
            each.robot, each.left_sole, physicsClientId=each.client
        )[1]
        for each in (slippery, rough)
    ]
    slippery.close()
    rough.close()
    assert frictions == [0.1, 0.8]


# -- the end ---------------------------------------------------------------------------


def test_a_world_can_be_closed_twice(world):
    world.close()
    world.close()
    with pytest.raises(WorldClosedError, match="has been closed"):
        world.check_open()


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
