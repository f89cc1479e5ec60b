"""What drives the joints: ideal servos, servos that lag, or PD controllers.

A lagging servo takes back shares of its errors in position and velocity per tick,
whatever the load, as far as its torque goes. A PD servo pulls by

    u = stiffness (q^ - q) + damping (dq^ - dq),  at most its torque limit,

against the load and against its rotor's inertia and the gear's dry friction, and gives
way under load. q^ and dq^ are the references of the tick.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from biped_common.settings import Settings, SettingsError, setting
from biped_common.timing import CONTROL_PERIOD_S


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
        "ideal: on its reference; lag: follows it; pd: gives way to the load, too",
        choices=("ideal", "lag", "pd"),
    )
    bandwidth_hz: float = setting(
        10.0, "Hz", "of lag, critically damped", above=0.0, upper=250.0
    )
    stiffness_nm_rad: float = setting(30e3, "N m/rad", "of pd, on position", above=0.0)
    damping_nm_s_rad: float = setting(
        125.0, "N m s/rad", "of pd, on velocity", above=0.0
    )
    rotor_inertia_kg_m2: float = setting(
        0.5, "kg m^2", "of pd, seen from the joint", above=0.0
    )
    friction_nm: float = setting(1.0, "N m", "of pd, dry, in the gear", lower=0.0)
    delay_ticks: int = setting(
        1,
        "control ticks",
        "of pd, until what was measured has an effect",
        lower=0,
        upper=1,
    )

    @property
    def shares(self) -> ServoShares:
        """What an ideal or a lagging servo takes back of its errors.

        The error e of a servo that lags moves by (z - p)^2 e = 0, p = exp(-2 pi f dt).
        """
        if self.kind == "ideal":
            return ServoShares(0.5, 1.0)
        p = math.exp(-2.0 * math.pi * self.bandwidth_hz * CONTROL_PERIOD_S)
        return ServoShares((1.0 - p) ** 2, 1.0 - p**2)

    def check_together(self) -> None:
        """Refuse gains of pd that are unstable at 2 ms.

        No mode of the robot has less inertia than the rotors, so that it is stable if a
        rotor alone is. With its gains K and D in ticks, that moves by
        (z - 1)^2 + D (z - 1) + K z = 0 without the delay, and by
        z (z - 1)^2 + D (z - 1) + K z = 0 with it; the bounds are Jury's.
        """
        if self.kind != "pd":
            return
        inertia = self.rotor_inertia_kg_m2
        stiffness = self.stiffness_nm_rad * CONTROL_PERIOD_S**2 / inertia
        damping = self.damping_nm_s_rad * CONTROL_PERIOD_S / inertia
        if self.delay_ticks:
            stable = damping < 1.0 and stiffness < damping * (1.0 - damping)
        else:
            stable = stiffness + 2.0 * damping < 4.0
        if not stable:
            raise SettingsError(
                "stiffness_nm_rad",
                self.stiffness_nm_rad,
                f"unstable at 2 ms with damping_nm_s_rad = {self.damping_nm_s_rad}, "
                f"rotor_inertia_kg_m2 = {inertia}, delay_ticks = {self.delay_ticks}",
            )


IDEAL_SERVO = ServoSettings()
