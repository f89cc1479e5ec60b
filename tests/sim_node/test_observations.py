"""What the robot reports at each learning tick, against its own 500 Hz records."""

import dataclasses
import hashlib

import msgspec
import numpy as np
import pytest
from tests.robots import SHIPPED

from msgs_json.observation import StampedPhase
from sim_node.biped import SimulatedBiped
from sim_node.settings import SimSettings
from sim_node.tick_sums import TickRows, TickSums

DT = 0.002  # control tick [s]
STRETCH = 230  # learning ticks, past two single supports


@pytest.fixture(scope="module")
def walked(build_walker, shaky_walk):
    """Walk a stretch; return (segment, ticks, observation) of each learning tick."""
    walker = build_walker({"zmp_error_m": 1.0})
    observations = walker.walk(shaky_walk[:STRETCH])[1:]
    walker.robot.close()
    ticks = [walker.ticks[i : i + 10] for i in range(0, 10 * STRETCH, 10)]
    return list(zip(shaky_walk[:STRETCH], ticks, observations, strict=True))


@pytest.fixture(scope="module")
def static_observations(build_walker, static_walk):
    """Walk the whole static walk; the standing robot's observation comes first."""
    walker = build_walker({"zmp_error_m": 1.0})
    observations = walker.walk(static_walk)
    walker.robot.close()
    return observations


def joint_references(segment):
    pose = segment.waist, segment.left_foot, segment.right_foot
    return SHIPPED.leg_joint_positions(*pose)


# -- standing --------------------------------------------------------------------------


def test_a_standing_robot_is_measured_on_both_feet(walker):
    assert walker.robot.begin_walk(1).phase.measured_double_support


def test_a_standing_robot_has_its_zmp_on_the_reference(walker):
    assert np.abs(walker.robot.begin_walk(1).zmp_error_m).max() < 1e-4


def test_a_standing_robot_has_walked_no_tick(walker):
    assert walker.robot.begin_walk(1).control_tick == 0


def test_a_standing_robot_has_cost_nothing(walker):
    observation = walker.robot.begin_walk(1)
    costs = [getattr(observation, name) for name in TickSums._fields]
    assert costs == [0.0] * len(TickSums._fields)


def test_a_standing_robot_weighs_what_its_links_weigh(walker, static_walk):
    walker.walk(static_walk[:1])
    assert walker.load_n[-1] == pytest.approx(9.81 * SHIPPED.mass_kg, rel=1e-4)


def test_every_observation_carries_its_episode(walker, static_walk):
    observations = walker.walk(static_walk[:3], episode=7)
    assert {observation.episode for observation in observations} == {7}


# -- control ticks ---------------------------------------------------------------------


def test_every_control_tick_is_recorded_once(sturdy_walker, shaky_walk):
    sturdy_walker.walk(shaky_walk[:20])
    numbers = [tick.control_tick for tick in sturdy_walker.ticks]
    assert numbers == list(range(1, 201))


def test_the_failing_tick_is_the_last_to_be_recorded(walker, static_walk):
    end = walker.walk(static_walk)[-1]
    assert walker.ticks[-1].control_tick == end.control_tick


def test_a_control_tick_aims_at_the_next_row_of_the_segment(walked):
    for segment, ticks, _ in walked:
        found = [tick.joint_reference for tick in ticks]
        np.testing.assert_array_equal(found, joint_references(segment)[1:])


def test_the_zmp_error_of_a_control_tick_is_measured_minus_reference(walked):
    for segment, ticks, _ in walked:
        zmp = np.array([(t.contact.zmp_x_m, t.contact.zmp_y_m) for t in ticks])
        expected = np.linalg.norm(zmp - segment.zmp_reference[1:], axis=1)
        found = [tick.zmp_error_m for tick in ticks]
        np.testing.assert_allclose(found, expected, rtol=1e-12)


# -- phase -----------------------------------------------------------------------------


def test_planned_flags_are_those_of_the_last_control_tick(walked):
    for segment, _, observation in walked:
        phase = observation.phase
        assert (
            phase.planned_right_support,
            phase.planned_double_support,
            phase.step_index,
        ) == (
            segment.right_support[10],
            segment.double_support[10],
            segment.step_index[10],
        )


@pytest.mark.parametrize("step", range(5))
def test_in_the_middle_of_a_single_support_the_planned_leg_is_measured(
    static_observations, step
):
    middle_s = 0.2 + 1.05 + 0.5 * 0.825 + 1.875 * step
    phase = static_observations[round(middle_s / 0.02)].phase
    assert (
        phase.planned_right_support,
        phase.planned_double_support,
        phase.measured_right_support,
        phase.measured_double_support,
        phase.step_index,
    ) == (step % 2 == 1, False, step % 2 == 1, False, step + 1)


def test_while_the_robot_shifts_over_both_feet_carry_it(static_observations):
    phase = static_observations[36].phase
    assert (phase.planned_double_support, phase.measured_double_support) == (True, True)


def test_the_measured_leg_is_the_one_that_carries_more(walked):
    for _, ticks, observation in walked:
        contact = ticks[-1].contact
        more_on_the_right = contact.right_load_n > contact.left_load_n
        assert observation.phase.measured_right_support == more_on_the_right


# -- state inputs ----------------------------------------------------------------------


def test_the_waist_is_seen_from_the_planned_support_foot(sturdy_walker, shaky_walk):
    sturdy_walker.walk([])
    for segment in shaky_walk[:STRETCH]:
        (observation,) = sturdy_walker.go_on([segment])
        feet = segment.left_foot, segment.right_foot
        foot = feet[observation.phase.planned_right_support][10]
        waist, _ = sturdy_walker.robot.world.waist()
        np.testing.assert_array_equal(
            observation.waist_in_support_foot_m, waist[:2] - foot[:2]
        )


def test_the_waist_accelerates_by_the_change_of_its_velocity(sturdy_walker, shaky_walk):
    sturdy_walker.walk([])
    _, before = sturdy_walker.robot.world.waist()
    for segment in shaky_walk[:100]:
        (observation,) = sturdy_walker.go_on([segment])
        _, after = sturdy_walker.robot.world.waist()
        expected = np.subtract(after, before)[:2] / 0.02
        np.testing.assert_allclose(
            observation.waist_acceleration_m_s2, expected, rtol=0, atol=1e-12
        )
        before = after


def test_the_waist_accelerates_as_its_reference_does(static_observations, static_walk):
    observations = static_observations[1:231]
    waist = np.array([s.waist[0] for s in static_walk[:232]])
    # The change of velocity over 20 ms belongs to the middle of the learning tick.
    expected = np.diff(waist, n=2, axis=0)[:, :2] / 0.02**2
    middle = 0.5 * (expected[1:] + expected[:-1])
    found = np.array([each.waist_acceleration_m_s2 for each in observations[1:]])
    np.testing.assert_allclose(found, middle, rtol=0, atol=0.05)


def test_the_zmp_error_is_that_of_the_last_control_tick(walked):
    for segment, ticks, observation in walked:
        contact = ticks[-1].contact
        zmp = np.array([contact.zmp_x_m, contact.zmp_y_m])
        np.testing.assert_array_equal(
            observation.zmp_error_m, zmp - segment.zmp_reference[10]
        )


def test_a_walk_that_fails_shows_the_error_that_ended_it(walker, static_walk):
    end = walker.walk(static_walk)[-1]
    assert np.hypot(*end.zmp_error_m) == pytest.approx(walker.ticks[-1].zmp_error_m)


# -- worst values and costs ------------------------------------------------------------


def test_the_worst_zmp_error_is_that_of_all_control_ticks(walked):
    for _, ticks, observation in walked:
        assert observation.worst_zmp_error_m == max(t.zmp_error_m for t in ticks)


def test_the_worst_joint_velocity_is_that_of_all_joints_and_ticks(walked):
    for _, ticks, observation in walked:
        worst = max(abs(dq) for t in ticks for dq in t.joint_velocity)
        assert observation.worst_joint_velocity_rad_s == worst


def test_the_zmp_integral_is_the_sum_of_squares_weighted_by_time(walked):
    for _, ticks, observation in walked:
        total = 0.0
        for tick in ticks:
            total += tick.zmp_error_m**2 * (tick.control_tick * DT) * DT
        assert observation.zmp_error_integral_m2_s2 == pytest.approx(total, rel=1e-12)


def test_the_joint_integral_is_the_sum_of_squared_tracking_errors(walked):
    for _, ticks, observation in walked:
        total = 0.0
        for tick in ticks:
            for q, aim in zip(tick.joint_position, tick.joint_reference, strict=True):
                total += (aim - q) ** 2 * DT
        assert observation.joint_error_integral_rad2_s == pytest.approx(
            total, rel=1e-12
        )


def test_the_torque_integral_is_the_sum_of_squared_torques(walked):
    for _, ticks, observation in walked:
        total = 0.0
        for tick in ticks:
            for torque in tick.joint_torque:
                total += torque**2 * DT
        assert observation.torque_integral_n2m2_s == pytest.approx(total, rel=1e-12)


def test_the_mean_joint_error_is_that_of_the_last_control_tick(walked):
    for _, ticks, observation in walked:
        last = ticks[-1]
        expected = np.abs(np.subtract(last.joint_reference, last.joint_position)).mean()
        assert observation.mean_joint_error_rad == pytest.approx(expected, rel=1e-12)


def test_the_mean_velocity_error_is_that_of_the_last_control_tick(walked):
    for segment, ticks, observation in walked:
        aim = np.diff(joint_references(segment), axis=0)[-1] / DT
        expected = np.abs(aim - ticks[-1].joint_velocity).mean()
        found = observation.mean_joint_velocity_error_rad_s
        assert found == pytest.approx(expected, rel=1e-9)


def test_a_tick_that_fails_midway_counts_up_to_the_failure(walker, static_walk):
    end = walker.walk(static_walk)[-1]
    ticks = walker.ticks[10 * (end.control_tick // 10) :]
    expected = (np.square([tick.joint_torque for tick in ticks])).sum() * DT
    assert 0 < len(ticks) < 10
    assert end.torque_integral_n2m2_s == pytest.approx(expected, rel=1e-12)


def test_a_tick_that_fails_midway_shows_the_velocity_error_of_the_failure(
    walker, static_walk
):
    end = walker.walk(static_walk)[-1]
    segment = static_walk[end.control_tick // 10]
    row = end.control_tick % 10
    aim = np.diff(joint_references(segment), axis=0)[row - 1] / DT
    expected = np.abs(aim - walker.ticks[-1].joint_velocity).mean()
    found = end.mean_joint_velocity_error_rad_s
    assert found == pytest.approx(expected, rel=1e-9)


def test_a_short_segment_counts_its_own_ticks_only(sturdy_walker, shaky_walk):
    sturdy_walker.walk(shaky_walk[:3])
    sturdy_walker.forget()
    short = dataclasses.replace(shaky_walk[3], n_ticks=4)
    observation = sturdy_walker.robot.execute(short)
    expected = (sturdy_walker.joints[2] ** 2).sum() * DT
    assert (observation.control_tick, observation.torque_integral_n2m2_s) == (
        34,
        pytest.approx(expected, rel=1e-12),
    )


def added(rows, numbers):
    """Add (ticks, 63) numbers to the rows."""
    rows.joints(len(numbers))[:] = numbers[:, :36]
    zmp = [tuple(row) for row in numbers[:, 60:].tolist()]
    rows.add(numbers[:, 36:48], numbers[:, 48:60], zmp)
    return rows


def test_no_control_tick_sums_up_to_nothing():
    assert TickRows().sum_up(7, hashlib.sha256()) == TickSums()


@pytest.mark.parametrize("column", range(63))
def test_the_hash_takes_in_every_number(column):
    hashes = []
    for value in (0.0, 1e-15):
        numbers = np.zeros((1, 63))
        numbers[0, column] = value
        hashes.append(hashlib.sha256())
        added(TickRows(), numbers).sum_up(1, hashes[-1])
    assert hashes[0].digest() != hashes[1].digest()


def test_more_ticks_than_there_was_room_for_are_kept():
    numbers = np.random.default_rng(3).normal(size=(200, 63))
    rows, trajectory = TickRows(), hashlib.sha256()
    for part in np.split(numbers, 50):
        added(rows, part)
    rows.sum_up(200, trajectory)
    assert trajectory.digest() == hashlib.sha256(numbers).digest()


def test_an_undisturbed_walk_stays_clear_of_the_torque_limits(
    sturdy_walker, static_walk
):
    sturdy_walker.walk(static_walk[:300])
    share = np.abs(sturdy_walker.joints[2]).max(axis=0) / SHIPPED.torque_limit_nm
    assert share.max() < 0.9


# -- clock, names and hashes -----------------------------------------------------------


def test_no_two_observations_have_the_same_time(walker, static_walk):
    times = [
        observation.clock_ticks
        for _ in range(3)
        for observation in walker.walk(static_walk[:3])
    ]
    assert times == sorted(set(times))


def test_the_clock_goes_on_by_the_ticks_walked_and_one_per_walk(walker, static_walk):
    times = [o.clock_ticks for _ in range(2) for o in walker.walk(static_walk[:2])]
    assert np.diff(times).tolist() == [10, 10, 1, 10, 10]


def test_control_ticks_carry_the_time_of_the_clock(walker, static_walk):
    begun = walker.walk(static_walk[:2])[0].clock_ticks
    times = [tick.clock_ticks for tick in walker.ticks]
    assert times == list(range(begun + 1, begun + 21))


def test_an_observation_has_the_time_of_its_last_control_tick(walked):
    for _, ticks, observation in walked:
        assert observation.clock_ticks == ticks[-1].clock_ticks


def test_an_observation_names_its_simulation(static_walk):
    robot = SimulatedBiped(
        SHIPPED,
        SimSettings(),
        static_walk[0],
        np.random.default_rng(0),
        name="this one",
    )
    named = robot.begin_walk(1).simulation
    robot.close()
    assert named == "this one"


def test_an_observation_has_the_hash_of_the_walk_so_far(walker, static_walk):
    walker.walk([])
    for segment in static_walk[:3]:
        (observation,) = walker.go_on([segment])
        assert observation.trajectory_sha256 == walker.robot.trajectory_sha256


# -- control ticks as they are told ----------------------------------------------------


def test_a_control_tick_tells_the_joint_velocity_asked_for(walked):
    for segment, ticks, _ in walked:
        expected = np.diff(joint_references(segment), axis=0) / DT
        found = [tick.joint_velocity_reference for tick in ticks]
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)


def test_a_control_tick_tells_the_zmp_asked_for(walked):
    for segment, ticks, _ in walked:
        found = [tick.zmp_reference for tick in ticks]
        np.testing.assert_array_equal(found, segment.zmp_reference[1:])


def test_a_control_tick_tells_its_planned_phase(walked):
    for segment, ticks, _ in walked:
        for row, tick in enumerate(ticks, 1):
            assert tick.phase.clock_ticks == tick.clock_ticks
            assert (
                tick.phase.planned_right_support,
                tick.phase.planned_double_support,
                tick.phase.step_index,
            ) == (
                segment.right_support[row],
                segment.double_support[row],
                segment.step_index[row],
            )


def test_the_last_control_tick_has_the_phase_of_the_observation(walked):
    for _, ticks, observation in walked:
        flags = msgspec.structs.asdict(observation.phase)
        assert ticks[-1].phase == StampedPhase(
            clock_ticks=observation.clock_ticks, **flags
        )


# -- the time since the last observation -----------------------------------------------


def test_a_short_segment_divides_the_acceleration_by_its_own_time(
    sturdy_walker, shaky_walk
):
    sturdy_walker.walk(shaky_walk[:30])
    _, before = sturdy_walker.robot.world.waist()
    short = dataclasses.replace(shaky_walk[30], n_ticks=4)
    observation = sturdy_walker.robot.execute(short)
    _, after = sturdy_walker.robot.world.waist()
    expected = np.subtract(after, before)[:2] / (4 * DT)
    np.testing.assert_allclose(
        observation.waist_acceleration_m_s2, expected, rtol=0, atol=1e-12
    )
