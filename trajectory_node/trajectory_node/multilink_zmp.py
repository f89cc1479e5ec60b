"""ZMP of a motion by its kinematics: all links as point masses.

An independent check on the contact forces of the simulation, and a quick plant for
questions that need no physics engine.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from biped_description.robot import Robot

GRAVITY_M_S2 = 9.81


def multilink_zmp(
    robot: Robot, waist: NDArray[np.float64], q: NDArray[np.float64], period_s: float
) -> NDArray[np.float64]:
    """Return the (n, 2) ZMP on the floor, world frame [m].

    With link CoMs (x, y, z) and masses m:
    `x_zmp = sum m ((z'' + g) x - x'' z) / sum m (z'' + g)`, y alike.

    Args:
        robot: that moves.
        waist: (n, 3) positions of the hip line's middle, equally spaced in time [m].
        q: (n, 12) joint positions [rad].
        period_s: time between rows [s].
    """
    com = robot.link_com_positions(waist, q)
    acceleration = np.gradient(
        np.gradient(com, period_s, axis=0, edge_order=2), period_s, axis=0, edge_order=2
    )
    mass = robot.link_masses_kg[:, None]
    vertical = acceleration[:, :, 2:] + GRAVITY_M_S2
    moment = mass * (vertical * com[:, :, :2] - acceleration[:, :, :2] * com[:, :, 2:])
    return np.asarray(moment.sum(axis=1) / (mass * vertical).sum(axis=1))
