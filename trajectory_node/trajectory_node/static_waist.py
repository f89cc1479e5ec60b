"""The waist trajectory of static walking, from which the learner corrects.

Quasi-static: at every instant the robot's CoM, as if it stood still, lies above the
reference ZMP. Accelerations are ignored, which is why a fast walk of this kind fails.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from biped_description.errors import DescriptionError
from biped_description.robot import Robot
from trajectory_node.errors import InfeasibleGaitError
from trajectory_node.gait import GaitPlan

# Moving the waist by e moves the CoM by about 0.8 e: six corrections leave < 0.1 mm.
_ITERATIONS = 6


def static_waist(
    robot: Robot, plan: GaitPlan, waist_height_m: float
) -> NDArray[np.float64]:
    """Return the (rows, 3) waist positions of the static walk, world frame [m].

    Raises:
        InfeasibleGaitError: the legs cannot reach the footholds from there.
    """
    waist = np.column_stack(
        [plan.zmp_reference, np.full(len(plan.zmp_reference), waist_height_m)]
    )
    try:
        for _ in range(_ITERATIONS):
            q = robot.leg_joint_positions(waist, plan.left_foot, plan.right_foot)
            waist[:, :2] += plan.zmp_reference - robot.com_position(waist, q)[:, :2]
        robot.leg_joint_positions(waist, plan.left_foot, plan.right_foot)
    except DescriptionError as error:
        raise InfeasibleGaitError(
            f"the robot cannot walk this gait: {error}"
        ) from error
    return waist
