"""Every quantity of the gait and of the waist correction, with unit and range."""

from __future__ import annotations

from dataclasses import dataclass

from biped_common.settings import Settings, SettingsError, section, setting
from biped_common.timing import control_ticks
from biped_description.settings import RobotSettings
from biped_ros.processor import ProcessorSettings

# A foot or the ZMP cannot be moved in less time than this.
_SHORTEST_PHASE_S = 0.1
_ROUNDING_S = 1e-9
LONGEST_LOOK_AHEAD_TICKS = 600
"""The plan runs on beyond the walk's end, standing, for look-ahead."""


@dataclass(frozen=True)
class GaitSettings(Settings):
    """The walk: stand, shift over the left foot, `steps` steps, close, stand."""

    step_period_s: float = setting(
        1.875, "s", "T_step: one single plus one double support", above=0.0, upper=10.0
    )
    double_support_s: float = setting(
        1.05,
        "s",
        "T_ds; smaller makes the task harder",
        lower=_SHORTEST_PHASE_S,
        upper=5.0,
    )
    stand_s: float = setting(0.2, "s", "standing before the first shift", lower=0.0)
    steps: int = setting(5, "steps", "single supports; the last of several closes the feet", lower=1, upper=50)  # fmt: skip  # noqa: E501
    step_length_m: float = setting(0.10, "m", "advance of each foothold over the other foot's", lower=-0.5, upper=0.5)  # fmt: skip  # noqa: E501
    swing_height_m: float = setting(0.03, "m", "clearance of the swing foot at mid-swing", lower=0.0, upper=0.2)  # fmt: skip  # noqa: E501
    waist_height_m: float = setting(0.475, "m", "constant height of the hip line", above=0.0, upper=2.0)  # fmt: skip  # noqa: E501

    @property
    def single_support_s(self) -> float:
        """T_ss = T_step - T_ds [s]."""
        return self.step_period_s - self.double_support_s

    @property
    def duration_s(self) -> float:
        """t_w: the whole walk, (steps + 1) T_step [s]."""
        return (self.steps + 1) * self.step_period_s

    @property
    def walk_ticks(self) -> int:
        """Control ticks of the whole walk."""
        return control_ticks(self.duration_s)

    def check_together(self) -> None:
        """Refuse values at odds with one another."""
        if self.double_support_s >= self.step_period_s:
            raise SettingsError(
                "double_support_s",
                self.double_support_s,
                f"must be below step_period_s = {self.step_period_s} s",
            )
        if self.single_support_s < _SHORTEST_PHASE_S - _ROUNDING_S:
            raise SettingsError(
                "double_support_s",
                self.double_support_s,
                f"must leave {_SHORTEST_PHASE_S} s of single support in a step",
            )
        if self.stand_s > self.single_support_s + _ROUNDING_S:
            raise SettingsError(
                "stand_s",
                self.stand_s,
                "must be at most the single support of "
                f"{self.single_support_s:g} s, or no time is left to stand at the end",
            )


@dataclass(frozen=True)
class CorrectionSettings(Settings):
    """The B-spline that smooths the learner's actions (Section 4.2)."""

    knot_spacing_s: float = setting(
        0.4, "s", "h of the B-spline; below 0.2 s random actions shake the robot over",
        lower=0.2, upper=2.0,
    )  # fmt: skip
    order: int = setting(3, "", "order of the B-spline (degree + 1)", lower=3, upper=4)


@dataclass(frozen=True)
class TrajectorySettings(Settings):
    """All of the trajectory node."""

    robot: RobotSettings = section(RobotSettings)
    gait: GaitSettings = section(GaitSettings)
    correction: CorrectionSettings = section(CorrectionSettings)
    processor: ProcessorSettings = section(ProcessorSettings)
    correction_limit_m: float = setting(
        0.024, "m", "corrections beyond this are refused", above=0.0, upper=0.2
    )
    look_ahead_ticks: int = setting(
        50,
        "control ticks",
        "reference handed out beyond a segment, for late peers in real time",
        lower=1,
        upper=LONGEST_LOOK_AHEAD_TICKS,
    )
