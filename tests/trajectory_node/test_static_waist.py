"""The static walk: the CoM above the reference ZMP at every tick."""

import numpy as np
import pytest
from tests.robots import SHIPPED

from trajectory_node.errors import InfeasibleGaitError, TrajectoryError
from trajectory_node.gait import plan_gait
from trajectory_node.settings import GaitSettings
from trajectory_node.static_waist import static_waist

GAITS = [
    {},
    {"double_support_s": 0.9},
    {"step_period_s": 1.0, "double_support_s": 0.5},
    {"step_length_m": 0.15},
    {"step_length_m": -0.1},
    {"waist_height_m": 0.42},
    {"swing_height_m": 0.08},
    {"steps": 1},
    {"steps": 8},
]
EVERY_GAIT = pytest.mark.parametrize("gait", GAITS, ids=str)


def walk(**gait: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the static waist (n, 3), the CoM (n, 3) and the reference ZMP (n, 2)."""
    settings = GaitSettings(**gait)
    plan = plan_gait(settings, SHIPPED.settings)
    waist = static_waist(SHIPPED, plan, settings.waist_height_m)
    q = SHIPPED.leg_joint_positions(waist, plan.left_foot, plan.right_foot)
    return waist, SHIPPED.com_position(waist, q), plan.zmp_reference


@EVERY_GAIT
def test_the_com_stays_above_the_reference_zmp(gait):
    _, com, zmp_reference = walk(**gait)
    np.testing.assert_allclose(com[:, :2], zmp_reference, rtol=0, atol=1e-4)


@EVERY_GAIT
def test_the_waist_keeps_its_height(gait):
    waist, _, _ = walk(**gait)
    height = GaitSettings(**gait).waist_height_m
    np.testing.assert_array_equal(waist[:, 2], height)


@EVERY_GAIT
def test_the_waist_is_at_rest_at_the_start_and_at_the_end(gait):
    waist, _, _ = walk(**gait)
    ends = waist[:50], waist[-600:]
    assert max(np.ptp(end, axis=0).max() for end in ends) < 1e-12


@pytest.mark.parametrize(
    ("gait", "reason"),
    [
        (
            {"step_length_m": 0.3},
            r"tick 932: hip and ankle of the right leg are 0\.480\d* m apart, but the",
        ),
        ({"step_length_m": -0.4}, "hip and ankle of the .* leg are"),
        ({"waist_height_m": 0.55}, "tick 0: hip and ankle of the left leg are"),
        ({"waist_height_m": 0.25}, "tick 0: hip and ankle of the left leg are"),
        ({"swing_height_m": 0.2}, "tick 1716: left_ankle_pitch at -1.20"),
    ],
)
def test_a_gait_beyond_the_legs_is_refused_with_the_reason(gait, reason):
    with pytest.raises(InfeasibleGaitError, match=f"cannot walk this gait: .*{reason}"):
        walk(**gait)


def test_an_infeasible_gait_is_a_trajectory_error():
    assert issubclass(InfeasibleGaitError, TrajectoryError)
