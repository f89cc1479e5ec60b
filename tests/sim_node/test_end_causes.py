"""Every way in which a walk can end, brought about in the physics itself."""

import dataclasses

import numpy as np
import pybullet
import pytest

from biped_description.joints import TORQUE_LIMIT
from msgs_json.end_cause import EndCause

UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def shift_waist(segment, offset, first_row=0):
    """Return the segment with its waist displaced from a row on [m]."""
    waist = segment.waist.copy()
    waist[first_row:] += offset
    return dataclasses.replace(segment, waist=waist)


def raise_robot(walker, height_m):
    """Lift the robot off the floor, or press it down."""
    world = walker.robot.world
    position, _ = pybullet.getBasePositionAndOrientation(
        world.robot, physicsClientId=world.client
    )
    pybullet.resetBasePositionAndOrientation(
        world.robot,
        np.add(position, (0.0, 0.0, height_m)),
        UPRIGHT,
        physicsClientId=world.client,
    )


# -- limits ----------------------------------------------------------------------------


def test_a_smaller_zmp_limit_ends_the_walk_earlier(new_walker, static_walk):
    end = new_walker({"zmp_error_m": 0.02}).walk(static_walk)[-1]
    assert (end.end_cause, end.control_tick < 1000) == (EndCause.ZMP_ERROR, True)


def test_a_joint_that_turns_too_fast_ends_the_walk(new_walker, static_walk):
    walker = new_walker({"joint_velocity_rad_s": 0.3})
    assert walker.walk(static_walk)[-1].end_cause is EndCause.JOINT_VELOCITY


def test_it_ends_at_the_very_tick_in_which_the_joint_is_too_fast(
    new_walker, static_walk
):
    walker = new_walker({"joint_velocity_rad_s": 0.3})
    walker.walk(static_walk)
    too_fast = np.abs(walker.joints[1]).max(axis=1) >= 0.3
    assert np.flatnonzero(too_fast).tolist() == [len(too_fast) - 1]


def test_weak_motors_saturate(new_walker, static_walk):
    walker = new_walker(disturbances={"torque_limit_factor": 0.3})
    assert walker.walk(static_walk)[-1].end_cause is EndCause.TORQUE_SATURATION


@pytest.mark.parametrize(("lasting_s", "ticks"), [(0.1, 50), (0.15, 75), (0.001, 1)])
def test_saturation_must_last_before_it_ends_the_walk(
    new_walker, static_walk, lasting_s, ticks
):
    # A tenth of the torque cannot hold the robot up: saturated from the first tick on.
    weak = {"torque_limit_factor": 0.1}
    walker = new_walker({"torque_saturation_s": lasting_s, "zmp_error_m": 1.0}, weak)
    end = walker.walk(static_walk)[-1]
    assert (end.end_cause, end.control_tick) == (EndCause.TORQUE_SATURATION, ticks)


def test_a_saturation_that_eases_off_starts_anew(new_walker, shaky_walk):
    lasting = {"torque_saturation_s": 0.8, "zmp_error_m": 1.0}
    walker = new_walker(lasting, {"torque_limit_factor": 0.35})
    assert walker.walk(shaky_walk)[-1].end_cause is EndCause.TORQUE_SATURATION
    saturated = (np.abs(walker.joints[2]) >= 0.999 * 0.35 * TORQUE_LIMIT).any(axis=1)
    assert (saturated[-400:].all(), saturated[:-400].sum() > 400) == (True, True)


def test_a_robot_in_the_air_has_its_feet_unloaded(walker, static_walk):
    walker.walk(static_walk[:1])
    raise_robot(walker, 0.5)
    assert walker.go_on(static_walk[1:])[-1].end_cause is EndCause.FEET_UNLOADED


@pytest.mark.parametrize(("lasting_s", "ticks"), [(0.05, 25), (0.1, 50)])
def test_the_feet_must_be_unloaded_for_a_while(
    new_walker, static_walk, lasting_s, ticks
):
    walker = new_walker({"unloaded_feet_s": lasting_s})
    walker.walk(static_walk[:1])
    raise_robot(walker, 0.5)
    assert walker.go_on(static_walk[1:])[-1].control_tick == 10 + ticks


def test_a_hop_shorter_than_that_is_forgiven(new_walker, static_walk):
    walker = new_walker({"unloaded_feet_s": 0.1, "zmp_error_m": 1.0})
    walker.walk(static_walk[:1])
    raise_robot(walker, 0.002)  # 20 ms of free fall
    walker.go_on(static_walk[1:15])
    unloaded_ticks = np.count_nonzero(walker.load_n == 0.0)
    assert (5 < unloaded_ticks < 50, len(walker.ticks)) == (True, 150)


def test_the_time_of_several_hops_does_not_add_up(new_walker, static_walk):
    walker = new_walker({"unloaded_feet_s": 0.05, "zmp_error_m": 1.0})
    walker.walk(static_walk[:1])
    for hop in range(4):
        raise_robot(walker, 0.002)
        walker.go_on(static_walk[1 + 5 * hop : 6 + 5 * hop])
    unloaded_ticks = np.count_nonzero(walker.load_n == 0.0)
    assert (unloaded_ticks > 25, len(walker.ticks)) == (True, 210)


def test_a_robot_pressed_into_the_floor_is_a_fault(walker, static_walk):
    walker.walk(static_walk[:1])
    raise_robot(walker, -0.02)
    assert walker.go_on(static_walk[1:])[-1].end_cause is EndCause.FOOT_THROUGH_FLOOR


def test_even_standing_sinks_in_by_more_than_a_nanometre(new_walker, static_walk):
    walker = new_walker({"foot_penetration_m": 1e-9})
    end = walker.walk(static_walk)[-1]
    assert (end.end_cause, end.control_tick) == (EndCause.FOOT_THROUGH_FLOOR, 1)


@pytest.mark.parametrize("what", ["base", "joint"])
def test_physics_that_is_no_number_ends_the_walk_at_once(walker, static_walk, what):
    world = walker.robot.world
    walker.walk(static_walk[:1])
    if what == "base":
        pybullet.resetBaseVelocity(
            world.robot, (np.nan, 0.0, 0.0), physicsClientId=world.client
        )
    else:
        pybullet.resetJointState(
            world.robot, world.joints[3], 0.9, np.nan, physicsClientId=world.client
        )
    end = walker.go_on(static_walk[1:])[-1]
    assert (end.end_cause, end.control_tick) == (EndCause.PHYSICS_NAN, 11)


# -- segments that the legs cannot follow ----------------------------------------------


@pytest.mark.parametrize(
    ("offset", "cause"),
    [
        ((0.0, 0.0, 0.2), EndCause.IK_UNREACHABLE),
        ((0.6, 0.0, 0.0), EndCause.IK_UNREACHABLE),
        ((0.0, 0.0, -0.3), EndCause.IK_UNREACHABLE),
        ((0.0, 0.25, -0.125), EndCause.IK_JOINT_LIMIT),
    ],
    ids=["too_high", "too_far", "too_low", "too_oblique"],
)
@pytest.mark.parametrize("first_row", [0, 10])
def test_a_waist_out_of_reach_ends_the_walk(
    walker, static_walk, offset, cause, first_row
):
    walker.walk(static_walk[:3])
    end = walker.robot.execute(shift_waist(static_walk[3], offset, first_row))
    assert end.end_cause is cause


def test_a_segment_that_the_legs_cannot_follow_is_not_begun(walker, static_walk):
    walker.walk(static_walk[:3])
    end = walker.robot.execute(shift_waist(static_walk[3], (0.0, 0.0, 0.2), 10))
    assert (end.control_tick, len(walker.ticks)) == (30, 30)


def test_what_lies_beyond_the_segment_does_not_matter(sturdy_walker, static_walk):
    sturdy_walker.walk(static_walk[:3])
    five_ticks = dataclasses.replace(static_walk[3], n_ticks=5)
    segment = shift_waist(five_ticks, (0.0, 0.0, 0.2), 6)
    assert sturdy_walker.robot.execute(segment).end_cause is None


# -- misuse ----------------------------------------------------------------------------


@pytest.mark.parametrize("index", [2, 4, 0])
def test_a_segment_that_does_not_continue_the_walk_is_refused(
    walker, static_walk, index
):
    walker.walk(static_walk[:3])
    message = f"^segment starts at tick {10 * index}, the robot is at tick 30$"
    with pytest.raises(ValueError, match=message):
        walker.robot.execute(static_walk[index])


@pytest.mark.parametrize("name", ["waist", "left_foot", "right_foot"])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_segment_with_what_is_no_number_is_refused(walker, static_walk, name, bad):
    rows = getattr(static_walk[3], name).copy()
    rows[4, 1] = bad
    walker.walk(static_walk[:3])
    with pytest.raises(ValueError, match="not finite, row 4"):
        walker.robot.execute(dataclasses.replace(static_walk[3], **{name: rows}))


def test_a_refused_segment_leaves_no_trace(new_walker, shaky_walk):
    one, other = new_walker(), new_walker()
    one.walk(shaky_walk[:50])
    other.walk(shaky_walk[:30])
    with pytest.raises(ValueError, match="not finite"):
        other.robot.execute(shift_waist(shaky_walk[30], np.nan))
    with pytest.raises(ValueError, match="segment starts at"):
        other.robot.execute(shaky_walk[31])
    other.go_on(shaky_walk[30:50])
    np.testing.assert_array_equal(one.everything, other.everything)


def test_a_walk_that_is_over_does_not_go_on(walker, static_walk):
    walker.walk(static_walk)
    with pytest.raises(ValueError, match=r"^the walk is over: zmp_error$"):
        walker.robot.execute(static_walk[113])


def test_the_cause_of_the_end_is_not_kept_for_the_next_walk(walker, static_walk):
    walker.walk(static_walk)
    assert walker.walk(static_walk[:1])[-1].end_cause is None
