"""Where the static walk gets to, and how well the physics follows its plan."""

import numpy as np
import pytest
from tests.robots import SHIPPED

from msgs_json.end_cause import EndCause
from trajectory_node.settings import CorrectionSettings, GaitSettings
from trajectory_node.waist_reference import WaistReference

CONTROL_TICKS = 5625


class CompletedWalk:
    """The static walk from start to end, its ZMP limit raised out of reach."""

    def __init__(self, walker, segments) -> None:
        self.observations = walker.walk([])
        self.waist = []  # at the end of each learning tick
        for segment in segments:
            self.observations += walker.go_on([segment])
            self.waist.append(walker.robot.world.waist()[0])
        self.ticks = walker.ticks
        self.zmp_m = walker.zmp_m


@pytest.fixture(scope="module")
def completed(build_walker, static_walk):
    walker = build_walker({"zmp_error_m": 1.0})
    yield CompletedWalk(walker, static_walk)
    walker.robot.close()


@pytest.fixture(scope="module")
def reference():
    return WaistReference(SHIPPED, GaitSettings(), CorrectionSettings())


def test_the_static_walk_fails_by_its_zmp_error(walker, static_walk):
    assert walker.walk(static_walk)[-1].end_cause is EndCause.ZMP_ERROR


def test_the_static_walk_fails_between_2_and_2_4_s(walker, static_walk):
    fell_at_s = 0.002 * walker.walk(static_walk)[-1].control_tick
    assert 2.0 < fell_at_s < 2.4


def test_the_walk_ends_at_the_very_tick_that_exceeds_the_limit(walker, static_walk):
    walker.walk(static_walk)
    exceeding = [tick.zmp_error_m >= 0.065 for tick in walker.ticks]
    assert exceeding.index(True) == len(walker.ticks) - 1


def test_with_a_wide_zmp_limit_the_static_walk_gets_to_its_end(completed):
    assert completed.observations[-1].control_tick == CONTROL_TICKS


def test_with_a_wide_zmp_limit_nothing_ends_the_static_walk(completed):
    assert {each.end_cause for each in completed.observations} == {None}


def test_the_worst_zmp_error_is_that_of_the_kinematics(completed):
    worst = max(tick.zmp_error_m for tick in completed.ticks)
    assert worst == pytest.approx(0.067, abs=0.002)


def test_the_waist_stays_within_1_mm_of_its_reference(completed, reference):
    ends = np.minimum(10 * np.arange(1, 564), CONTROL_TICKS)
    expected = reference.static_waist[ends]
    np.testing.assert_allclose(completed.waist, expected, rtol=0, atol=0.001)


def test_the_joints_stay_within_0_003_rad_of_their_references(completed):
    q = [tick.joint_position for tick in completed.ticks]
    references = [tick.joint_reference for tick in completed.ticks]
    np.testing.assert_allclose(q, references, rtol=0, atol=0.003)


def test_five_steps_with_the_last_closing_the_feet_go_0_4_m(completed):
    gone = np.subtract(completed.waist[-1], completed.waist[0])
    np.testing.assert_allclose(gone, [0.4, 0.0, 0.0], rtol=0, atol=0.001)


def test_at_the_end_the_robot_stands_still(completed):
    assert completed.observations[-1].worst_joint_velocity_rad_s < 1e-6


def test_at_the_end_the_zmp_is_on_its_reference(completed, reference):
    assert completed.observations[-1].worst_zmp_error_m < 1e-4
