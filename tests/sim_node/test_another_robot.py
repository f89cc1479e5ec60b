"""A robot of another size walks a gait that fits it, to its end."""

import numpy as np
import pytest
from tests.robots import SHIPPED, TALL, TALL_RUN

from trajectory_node.errors import InfeasibleGaitError
from trajectory_node.waist_reference import WaistReference


@pytest.fixture(scope="module")
def reference():
    return WaistReference(TALL, TALL_RUN.gait, TALL_RUN.correction)


@pytest.fixture(scope="module")
def walked(build_walker, reference):
    """Walk the tall robot's whole static walk, its ZMP limit raised out of reach."""
    learning_ticks = -(-reference.ticks // 10)
    segments = [reference.segment(np.zeros(2)) for _ in range(learning_ticks)]
    walker = build_walker({"zmp_error_m": 1.0}, robot=TALL, start=reference.stance())
    walker.observations = walker.walk(segments)
    walker.waist_m = walker.robot.world.waist()[0]
    yield walker
    walker.robot.close()


def test_it_walks_all_its_ticks(walked, reference):
    end = walked.observations[-1]
    assert (end.control_tick, end.end_cause) == (reference.ticks, None)


def test_it_goes_as_far_as_its_steps_lead(walked, reference):
    gone_m = reference.static_waist[reference.ticks]
    np.testing.assert_allclose(walked.waist_m, gone_m, rtol=0, atol=0.001)


def test_the_floor_carries_its_weight(walked):
    assert walked.load_n[-1] == pytest.approx(9.81 * TALL.mass_kg, rel=1e-3)


def test_the_shipped_robot_cannot_walk_its_gait():
    with pytest.raises(InfeasibleGaitError, match=r"^the robot cannot walk this gait"):
        WaistReference(SHIPPED, TALL_RUN.gait, TALL_RUN.correction)
