"""Balancing a bicycle: the task of Randløv and Alstrøm (ICML 1998), without the goal.

    gymnasium.make("biped_lab:BicycleBalance-v0")

Both wheels roll without slipping at a constant speed. The rider turns the handlebars by
a torque and leans sideways; how far he leans is uncertain. Dynamics, constants, actions
and noise are the paper's; integration is semi-implicit Euler's at its 0.01 s.

    input        index  unit     limits
    θ            0      rad      ± 80°, where the handlebars stop
    dθ/dt        1      rad/s
    ω            2      rad      ± 12°, beyond which it has fallen
    dω/dt        3      rad/s
    d²ω/dt²      4      rad/s²

θ turns the handlebars to the right, ω is a tilt to the right.

    component    alternatives
    torque       -2, 0, 2 N m on the handlebars
    lean         -2, 0, 2 cm of the rider's centre of mass, plus noise within ± 2 cm

An episode terminates when the bicycle has fallen. Every step before is rewarded by 1.
"""

from __future__ import annotations

import math
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box, MultiDiscrete
from numpy.typing import NDArray

PERIOD_S = 0.01
MOST_TILT_RAD = math.pi / 15
MOST_STEER_RAD = math.radians(80.0)
TORQUES_NM = (-2.0, 0.0, 2.0)
LEANS_M = (-0.02, 0.0, 0.02)
LEAN_NOISE_M = 0.02

GRAVITY_M_S2 = 9.82
SPEED_M_S = 10.0 / 3.6
WHEELBASE_M = 1.11
TRAIL_TO_MASS_M = 0.66
"""c: horizontal distance from the front wheel's contact to the centre of mass."""
MASS_HEIGHT_M = 0.94
RIDER_ABOVE_M = 0.30
"""d_CM: height of the rider's centre of mass above the bicycle's."""
WHEEL_RADIUS_M = 0.34
BICYCLE_KG, RIDER_KG, TYRE_KG = 15.0, 60.0, 1.7

_MASS_KG = BICYCLE_KG + RIDER_KG
_WHEEL_RAD_S = SPEED_M_S / WHEEL_RADIUS_M
_TYRE_KG_M2 = TYRE_KG * WHEEL_RADIUS_M**2
_ROLL_KG_M2 = (
    13.0 / 3.0 * BICYCLE_KG * MASS_HEIGHT_M**2
    + RIDER_KG * (MASS_HEIGHT_M + RIDER_ABOVE_M) ** 2
)
_SPIN_KG_M2, _TURN_KG_M2, _STEER_KG_M2 = (
    _TYRE_KG_M2 * factor for factor in (1.0, 1.5, 0.5)
)
"""I_dc, I_dv, I_dl of a tyre."""


def accelerations(
    steer: float, steer_rate: float, tilt: float, tilt_rate: float,
    torque_nm: float, lean_m: float,
) -> tuple[float, float]:  # fmt: skip
    """Return (d²θ/dt², d²ω/dt²) [rad/s²] by the paper's equations of motion.

    Args:
        steer: θ [rad]
        steer_rate: dθ/dt [rad/s]
        tilt: ω [rad]
        tilt_rate: dω/dt [rad/s]
        torque_nm: on the handlebars.
        lean_m: of the rider, to the right.
    """
    # Curvatures, the reciprocals of the paper's radii: 0 when it goes straight on.
    front = abs(math.sin(steer)) / WHEELBASE_M
    rear = abs(math.tan(steer)) / WHEELBASE_M
    mass = rear / math.hypot(1.0, rear * (WHEELBASE_M - TRAIL_TO_MASS_M))
    centrifugal = math.copysign(SPEED_M_S**2, steer) * (
        TYRE_KG * WHEEL_RADIUS_M * (front + rear) + _MASS_KG * MASS_HEIGHT_M * mass
    )
    leaning = tilt + math.atan(lean_m / MASS_HEIGHT_M)
    tilting = (
        _MASS_KG * MASS_HEIGHT_M * GRAVITY_M_S2 * math.sin(leaning)
        - math.cos(leaning) * (_SPIN_KG_M2 * _WHEEL_RAD_S * steer_rate + centrifugal)
    ) / _ROLL_KG_M2
    steering = (torque_nm - _TURN_KG_M2 * _WHEEL_RAD_S * tilt_rate) / _STEER_KG_M2
    return steering, tilting


class BicycleBalanceEnv(gymnasium.Env[NDArray[np.float64], NDArray[np.int64]]):
    """The bicycle as an environment; see the module's tables."""

    def __init__(self) -> None:
        """Stand still until `reset`."""
        low = np.array([MOST_STEER_RAD, np.inf, MOST_TILT_RAD, np.inf, np.inf])
        # It is seen once more after it has fallen.
        low[2] = math.pi
        self.observation_space = Box(-low, low, dtype=np.float64)
        self.action_space = MultiDiscrete([len(TORQUES_NM), len(LEANS_M)])
        self.state = np.zeros(5)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float64], dict[str, Any]]:
        """Set it upright, going straight on."""
        super().reset(seed=seed)
        self.state = np.zeros(5)
        return self.state.copy(), {}

    def step(
        self, action: NDArray[np.int64]
    ) -> tuple[NDArray[np.float64], float, bool, bool, dict[str, Any]]:
        """Ride on for one period."""
        noise = self.np_random.uniform(-LEAN_NOISE_M, LEAN_NOISE_M)
        steer, steer_rate, tilt, tilt_rate, _ = self.state.tolist()
        steering, tilting = accelerations(
            steer, steer_rate, tilt, tilt_rate,
            TORQUES_NM[action[0]], LEANS_M[action[1]] + noise,
        )  # fmt: skip
        tilt_rate += PERIOD_S * tilting
        tilt += PERIOD_S * tilt_rate
        steer_rate += PERIOD_S * steering
        steer += PERIOD_S * steer_rate
        if abs(steer) > MOST_STEER_RAD:
            steer, steer_rate = math.copysign(MOST_STEER_RAD, steer), 0.0
        self.state = np.array([steer, steer_rate, tilt, tilt_rate, tilting])
        fallen = abs(tilt) > MOST_TILT_RAD
        return self.state.copy(), float(not fallen), fallen, False, {}
