"""What drives the joints: ideal servos, servos that lag, or PID controllers.

A lagging servo takes back shares of its errors in position and velocity per tick,
whatever the load, as far as its torque goes. A PID servo pulls by

    u = stiffness (e + integral) + damping de,  at most its torque limit,

against the load and against its rotor's inertia and the gear's dry friction. e = q^ - q
and de = dq^ - dq are its errors to the references of the tick; the integral of
`integral_per_s` e stands still while the torque is at its limit. It gives way under
load until its integral has grown.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from biped_common.settings import Settings, SettingsError, setting
from biped_common.timing import CONTROL_PERIOD_S

Array: TypeAlias = NDArray[np.float64]

SERVO_KINDS: Final = {
    "ideal": (),
    "lag": ("bandwidth_hz",),
    "pid": (
        "stiffness_nm_rad",
        "damping_nm_s_rad",
        "integral_per_s",
        "rotor_inertia_kg_m2",
        "friction_nm",
        "delay_ticks",
    ),
}
"""The settings that each kind of servo has."""


class ServoShares(NamedTuple):
    """Shares of its errors that a servo takes back in a tick."""

    position: float
    velocity: float


@dataclass(frozen=True)
class ServoSettings(Settings):
    """The servos, all joints alike."""

    kind: str = setting(
        "ideal",
        "",
        "ideal: on its reference; lag: follows it; pid: gives way to the load, too",
        choices=tuple(SERVO_KINDS),
    )
    bandwidth_hz: float = setting(
        10.0, "Hz", "of lag, critically damped", above=0.0, upper=250.0
    )
    stiffness_nm_rad: float = setting(30e3, "N m/rad", "of pid, on position", above=0.0)
    damping_nm_s_rad: float = setting(
        125.0, "N m s/rad", "of pid, on velocity", above=0.0
    )
    integral_per_s: float = setting(
        3.0,
        "1/s",
        "of pid, what a lasting error grows by, as the stiffness feels it; 0: none",
        lower=0.0,
    )
    rotor_inertia_kg_m2: float = setting(
        0.5, "kg m^2", "of pid, seen from the joint", above=0.0
    )
    friction_nm: float = setting(1.0, "N m", "of pid, dry, in the gear", lower=0.0)
    delay_ticks: int = setting(
        1,
        "control ticks",
        "of pid, until what was measured has an effect",
        lower=0,
        upper=1,
    )

    @property
    def shares(self) -> ServoShares:
        """What an ideal or a lagging servo takes back of its errors; pid takes none.

        The error e of a servo that lags moves by (z - p)^2 e = 0, p = exp(-2 pi f dt).
        """
        assert self.kind != "pid"
        if self.kind == "ideal":
            return ServoShares(0.5, 1.0)
        p = math.exp(-2.0 * math.pi * self.bandwidth_hz * CONTROL_PERIOD_S)
        return ServoShares((1.0 - p) ** 2, 1.0 - p**2)

    def check_together(self) -> None:
        """Refuse what has no effect, and gains of pid that are unstable at 2 ms.

        These are judged on a rotor alone, which no mode of the robot has less inertia
        than. With gains K, D and R per tick, it moves by

            z^delay (z - 1)^2 + D (z - 1) + K z (1 + R z / (z - 1)) = 0.

        What an integral does to the whole robot, which is heavier, is not asked.
        """
        for each in fields(self):
            value = getattr(self, each.name)
            if (
                each.name not in ("kind", *SERVO_KINDS[self.kind])
                and value != each.default
            ):
                reason = f"has no effect with kind = {self.kind}"
                raise SettingsError(each.name, value, reason)
        if self.kind != "pid":
            return
        inertia = self.rotor_inertia_kg_m2
        stiffness = self.stiffness_nm_rad * CONTROL_PERIOD_S**2 / inertia
        damping = self.damping_nm_s_rad * CONTROL_PERIOD_S / inertia
        growth = self.integral_per_s * CONTROL_PERIOD_S
        z, still = np.poly1d([1.0, 0.0]), np.poly1d([1.0, -1.0])
        motion = z**self.delay_ticks * still**2 + damping * still + stiffness * z
        if growth > 0.0:
            motion = motion * still + stiffness * growth * z**2
        if np.abs(motion.roots).max() >= 1.0:
            raise SettingsError(
                "stiffness_nm_rad",
                self.stiffness_nm_rad,
                f"unstable at 2 ms with damping_nm_s_rad = {self.damping_nm_s_rad}, "
                f"integral_per_s = {self.integral_per_s}, "
                f"rotor_inertia_kg_m2 = {inertia}, delay_ticks = {self.delay_ticks}",
            )


class PidServos:
    """PID servos of some joints: the torques by which they pull, tick by tick."""

    def __init__(
        self, servo: ServoSettings, torque_limits_nm: Array, kept: Array
    ) -> None:
        """Keep all that they remember in `kept`.

        Args:
            servo: their constants.
            torque_limits_nm: one a joint.
            kept: (2, joints), zeros at rest: torques that a delay holds back [N m]
                and integrals [rad].
        """
        self._servo = servo
        self._limits_nm = torque_limits_nm
        self._kept = kept

    def pull(self, position_error_rad: Array, velocity_error_rad_s: Array) -> Array:
        """Return the (joints,) torques of a tick [N m]; with a delay, of the last one.

        Args:
            position_error_rad: (joints,) reference less position.
            velocity_error_rad_s: (joints,)
        """
        servo, (late, integral) = self._servo, self._kept
        grown = integral + servo.integral_per_s * CONTROL_PERIOD_S * position_error_rad
        wanted = servo.stiffness_nm_rad * (position_error_rad + grown)
        wanted += servo.damping_nm_s_rad * velocity_error_rad_s
        torques = np.clip(wanted, -self._limits_nm, self._limits_nm)
        pulled: Array = late.copy() if servo.delay_ticks else torques
        late[:] = torques
        integral[:] = np.where(torques == wanted, grown, integral)
        return pulled


IDEAL_SERVO = ServoSettings()
