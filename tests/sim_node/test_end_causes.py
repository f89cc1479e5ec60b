"""Every way in which a walk can end, brought about in the physics itself."""

import dataclasses

import msgspec
import numpy as np
import pytest
from tests.robots import SHIPPED
from tests.sim_node.bullet import put_base, put_joint, raise_robot, throw_base

from biped_description.joints import KNEE
from biped_description.robot import Robot
from biped_description.settings import RobotSettings
from msgs_json.end_cause import EndCause
from msgs_json.observation import Observation
from msgs_json.wire import decode, encode
from sim_node.biped import SimulatedBiped
from sim_node.errors import WorldClosedError
from trajectory_node.settings import CorrectionSettings, GaitSettings
from trajectory_node.waist_reference import WaistReference

SLOW = Robot(RobotSettings(velocity_limit_rad_s=0.3))


def shift_waist(segment, offset, first_row=0):
    """Return the segment with its waist displaced from a row on [m]."""
    waist = segment.waist.copy()
    waist[first_row:] += offset
    return dataclasses.replace(segment, waist=waist)


# -- limits ----------------------------------------------------------------------------


def test_a_smaller_zmp_limit_ends_the_walk_earlier(new_walker, static_walk):
    end = new_walker({"zmp_error_m": 0.02}).walk(static_walk)[-1]
    assert (end.end_cause, end.control_tick < 1000) == (EndCause.ZMP_ERROR, True)


def test_a_joint_that_turns_too_fast_ends_the_walk(new_walker, static_walk):
    walker = new_walker(robot=SLOW)
    assert walker.walk(static_walk)[-1].end_cause is EndCause.JOINT_VELOCITY


def test_it_ends_at_the_very_tick_in_which_the_joint_is_too_fast(
    new_walker, static_walk
):
    walker = new_walker(robot=SLOW)
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
    saturated = (
        np.abs(walker.joints[2]) >= 0.999 * 0.35 * SHIPPED.torque_limit_nm
    ).any(axis=1)
    assert (saturated[-400:].all(), saturated[:-400].sum() > 400) == (True, True)


def test_a_robot_in_the_air_has_its_feet_unloaded(walker, static_walk):
    walker.walk(static_walk[:1])
    raise_robot(walker.robot.world, 0.5)
    assert walker.go_on(static_walk[1:])[-1].end_cause is EndCause.FEET_UNLOADED


@pytest.mark.parametrize(("lasting_s", "ticks"), [(0.05, 25), (0.1, 50)])
def test_the_feet_must_be_unloaded_for_a_while(
    new_walker, static_walk, lasting_s, ticks
):
    walker = new_walker({"unloaded_feet_s": lasting_s})
    walker.walk(static_walk[:1])
    raise_robot(walker.robot.world, 0.5)
    assert walker.go_on(static_walk[1:])[-1].control_tick == 10 + ticks


def test_a_hop_shorter_than_that_is_forgiven(new_walker, static_walk):
    walker = new_walker({"unloaded_feet_s": 0.1, "zmp_error_m": 1.0})
    walker.walk(static_walk[:1])
    raise_robot(walker.robot.world, 0.002)  # 20 ms of free fall
    walker.go_on(static_walk[1:15])
    unloaded_ticks = np.count_nonzero(walker.load_n == 0.0)
    assert (5 < unloaded_ticks < 50, len(walker.ticks)) == (True, 150)


def test_the_time_of_several_hops_does_not_add_up(new_walker, static_walk):
    walker = new_walker({"unloaded_feet_s": 0.05, "zmp_error_m": 1.0})
    walker.walk(static_walk[:1])
    for hop in range(4):
        raise_robot(walker.robot.world, 0.002)
        walker.go_on(static_walk[1 + 5 * hop : 6 + 5 * hop])
    unloaded_ticks = np.count_nonzero(walker.load_n == 0.0)
    assert (unloaded_ticks > 25, len(walker.ticks)) == (True, 210)


def test_a_robot_pressed_into_the_floor_is_a_fault(walker, static_walk):
    walker.walk(static_walk[:1])
    raise_robot(walker.robot.world, -0.02)
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
        throw_base(world, (np.nan, 0.0, 0.0))
    else:
        put_joint(world, KNEE, 0.9, np.nan)
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


def test_an_end_without_a_control_tick_has_a_moment_of_its_own(walker, static_walk):
    before = walker.walk(static_walk[:3])[-1].clock_ticks
    end = walker.robot.execute(shift_waist(static_walk[3], (0.0, 0.0, 0.2), 10))
    assert end.clock_ticks == before + 1


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


# -- physics that is no number ---------------------------------------------------------


def spoil(walker, what):
    """Make the position or the velocity of base or joint no number."""
    world = walker.robot.world
    if what == "base_position":
        put_base(world, (np.nan, 0.0, 0.0))
    elif what == "base_velocity":
        throw_base(world, (np.nan, 0.0, 0.0))
    else:
        put_joint(world, KNEE, 0.9, np.nan)


EVERY_SPOIL = pytest.mark.parametrize(
    "what", ["base_position", "base_velocity", "joint_velocity"]
)


@EVERY_SPOIL
def test_whatever_is_no_number_is_found(walker, static_walk, what):
    walker.walk(static_walk[:1])
    spoil(walker, what)
    assert walker.go_on(static_walk[1:3])[-1].end_cause is EndCause.PHYSICS_NAN


@EVERY_SPOIL
def test_an_observation_holds_numbers_only(walker, static_walk, what):
    walker.walk(static_walk[:1])
    spoil(walker, what)
    end = walker.go_on(static_walk[1:3])[-1]
    numbers = [value for value in msgspec.structs.astuple(end) if value is not None]
    found = [n for n in numbers if isinstance(n, (float, tuple))]
    assert all(np.isfinite(each).all() for each in found)


@EVERY_SPOIL
def test_an_observation_without_numbers_goes_over_the_wire(walker, static_walk, what):
    walker.walk(static_walk[:1])
    spoil(walker, what)
    end = walker.go_on(static_walk[1:3])[-1]
    assert decode(Observation, encode(end)) == end


@pytest.mark.parametrize(
    ("mishap", "cause"),
    [
        (lambda world: raise_robot(world, 0.8), EndCause.FEET_UNLOADED),
        (lambda world: raise_robot(world, -0.2), EndCause.FOOT_THROUGH_FLOOR),
        (lambda world: throw_base(world, (np.nan, 0.0, 0.0)), EndCause.PHYSICS_NAN),
    ],
)
def test_nothing_of_a_mishap_is_left_in_the_next_walk(
    new_walker, shaky_walk, mishap, cause
):
    unharmed, harmed = (
        new_walker({"zmp_error_m": 1.0}),
        new_walker({"zmp_error_m": 1.0}),
    )
    unharmed.walk(shaky_walk[:100])
    harmed.walk(shaky_walk[:5])
    mishap(harmed.robot.world)
    assert harmed.go_on(shaky_walk[5:20])[-1].end_cause is cause
    harmed.forget()
    harmed.walk(shaky_walk[:100])
    np.testing.assert_array_equal(harmed.everything, unharmed.everything)


# -- references taken over while walking on --------------------------------------------


def advance(robot, ticks):
    return [robot.advance() for _ in range(ticks)][-1]


def test_control_ticks_one_by_one_make_the_same_walk(new_walker, shaky_walk):
    whole, by_ticks = new_walker(), new_walker()
    observed = whole.walk(shaky_walk[:20])
    found = [by_ticks.robot.begin_walk(1)]
    for segment in shaky_walk[:20]:
        by_ticks.robot.follow(segment)
        advance(by_ticks.robot, 10)
        found.append(by_ticks.robot.observe())
    assert found == observed


def test_a_standing_robot_has_no_references(walker):
    walker.robot.begin_walk(1)
    assert walker.robot.ticks_ahead == 0
    with pytest.raises(ValueError, match=r"^no reference for tick 1$"):
        walker.robot.advance()


def test_references_are_used_up_tick_by_tick(walker, static_walk):
    walker.robot.begin_walk(1)
    walker.robot.follow(static_walk[0])
    left = [walker.robot.ticks_ahead]
    for _ in range(10):
        walker.robot.advance()
        left.append(walker.robot.ticks_ahead)
    assert left == list(range(10, -1, -1))


def test_beyond_the_references_there_is_no_way(walker, static_walk):
    walker.robot.begin_walk(1)
    walker.robot.follow(static_walk[0])
    advance(walker.robot, 10)
    with pytest.raises(ValueError, match=r"^no reference for tick 11$"):
        walker.robot.advance()


def test_a_segment_that_comes_late_is_followed_from_the_present_tick(
    sturdy_walker, static_walk
):
    ahead = WaistReference(SHIPPED, GaitSettings(), CorrectionSettings(), 50)
    first, second = (ahead.segment(np.zeros(2)) for _ in range(2))
    sturdy_walker.robot.begin_walk(1)
    sturdy_walker.robot.follow(first)
    advance(sturdy_walker.robot, 14)
    sturdy_walker.robot.follow(second)
    assert sturdy_walker.robot.ticks_ahead == 55


@pytest.mark.parametrize("index", [0, 2])
def test_a_segment_that_is_not_about_the_present_tick_is_not_followed(
    walker, static_walk, index
):
    walker.walk(static_walk[:1])
    message = f"segment of ticks {10 * index} to {10 * index + 10}, the robot is at"
    with pytest.raises(ValueError, match=message):
        walker.robot.follow(static_walk[index])


def test_look_ahead_is_followed_as_far_as_the_legs_can(walker, static_walk):
    segment = dataclasses.replace(static_walk[0], n_ticks=5)
    walker.robot.begin_walk(1)
    walker.robot.follow(shift_waist(segment, (0.0, 0.0, 0.2), 8))
    assert (walker.robot.ticks_ahead, walker.robot.end_cause) == (7, None)


def test_a_segment_that_the_legs_cannot_follow_ends_the_walk_at_once(
    walker, static_walk
):
    walker.robot.begin_walk(1)
    walker.robot.follow(shift_waist(static_walk[0], (0.0, 0.0, 0.2), 10))
    assert walker.robot.end_cause is EndCause.IK_UNREACHABLE


# -- ends from outside -----------------------------------------------------------------


@pytest.mark.parametrize("cause", [EndCause.PEER_SILENT, EndCause.RESET])
def test_an_end_from_outside_is_observed(walker, static_walk, cause):
    walker.walk(static_walk[:2])
    walker.robot.end(cause)
    end = walker.robot.observe()
    assert (end.end_cause, end.control_tick) == (cause, 20)


def test_an_end_from_outside_takes_a_tick_of_the_clock(walker, static_walk):
    walker.walk(static_walk[:2])
    before = walker.robot.clock_ticks
    walker.robot.end(EndCause.RESET)
    assert walker.robot.clock_ticks == before + 1


def test_a_walk_ended_from_outside_does_not_go_on(walker, static_walk):
    walker.walk(static_walk[:2])
    walker.robot.end(EndCause.RESET)
    with pytest.raises(ValueError, match=r"^the walk is over: reset$"):
        walker.robot.execute(static_walk[2])


# -- more misuse -----------------------------------------------------------------------


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_zmp_reference_that_is_no_number_is_refused(walker, static_walk, bad):
    rows = static_walk[3].zmp_reference.copy()
    rows[4, 1] = bad
    walker.walk(static_walk[:3])
    with pytest.raises(ValueError, match="not finite"):
        walker.robot.execute(dataclasses.replace(static_walk[3], zmp_reference=rows))


@pytest.mark.parametrize("n_ticks", [0, -1])
@pytest.mark.parametrize("way", [SimulatedBiped.execute, SimulatedBiped.follow])
def test_a_segment_without_a_tick_is_refused(walker, static_walk, n_ticks, way):
    walker.walk(static_walk[:3])
    with pytest.raises(ValueError, match="segment"):
        way(walker.robot, dataclasses.replace(static_walk[3], n_ticks=n_ticks))


def test_a_closed_robot_does_not_walk(walker, static_walk):
    walker.walk(static_walk[:3])
    walker.robot.close()
    with pytest.raises(WorldClosedError):
        walker.robot.execute(static_walk[3])


def test_a_closed_robot_begins_no_walk(walker):
    walker.robot.close()
    with pytest.raises(WorldClosedError):
        walker.robot.begin_walk(1)
