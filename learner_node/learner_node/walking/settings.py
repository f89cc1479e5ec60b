"""Constants of the walking task (Section 4), and the readings of what is left open."""

from __future__ import annotations

from dataclasses import dataclass

from biped_common.settings import Settings, SettingsError, section, setting
from learner_node.methods import MethodSettings

_MOST_JOINT = 100


@dataclass(frozen=True)
class ActionSettings(Settings):
    """The corrections to choose from (Section 4.2)."""

    limit_m: float = setting(
        0.024, "m", "largest correction dx, dy", above=0.0, upper=0.2
    )
    alternatives: int = setting(
        15,
        "",
        "Na: equally spaced corrections from -limit to limit",
        lower=2,
        upper=1001,
    )
    hold_ticks: int = setting(
        1,
        "learning ticks",
        "a decision is held this long (20 ms each)",
        lower=1,
        upper=50,
    )


@dataclass(frozen=True)
class InputSettings(Settings):
    """Widths of the basis functions, which scale the continuous inputs (4.1)."""

    waist_radius_m: float = setting(0.03, "m", "waist position", above=0.0)
    zmp_error_radius_m: float = setting(0.03, "m", "ZMP error", above=0.0)
    acceleration_radius_m_s2: float = setting(
        0.9, "m/s^2", "waist acceleration", above=0.0
    )
    clock_period_s: float = setting(
        0.0,
        "s",
        "period of a clock that is an input, too, T_step for the gait's (beyond the "
        "paper); 0: none",
        lower=0.0,
        upper=100.0,
    )
    clock_radius_s: float = setting(0.1, "s", "clock", above=0.0)

    @property
    def radii(self) -> tuple[float, ...]:
        """One width per continuous input, in the order of the inputs."""
        radii = (
            (self.waist_radius_m,) * 2
            + (self.zmp_error_radius_m,) * 2
            + (self.acceleration_radius_m_s2,) * 2
        )
        return (*radii, self.clock_radius_s) if self.clock_period_s else radii


@dataclass(frozen=True)
class CostSettings(Settings):
    """T_err (eq. (2)) and its running estimate (eqs. (3), (4))."""

    zmp_limit_m: float = setting(0.065, "m", "zmpLimit of eq. (2)", above=0.0)
    torque_reading: str = setting(
        "in_root",
        "",
        "whether the torque integral shares the square root with the tracking "
        "integral or stands outside it",
        choices=("in_root", "outside_root"),
    )
    first_estimate_factor: float = setting(
        1.05, "", "T_err-hat starts at this multiple of T_err (eq. (3))", above=0.0
    )
    tolerance: float = setting(
        0.001,
        "",
        "T_err counts as below T_err-hat up to this relative excess; without it a "
        "deterministic walk can never succeed again",
        lower=0.0,
        upper=1.0,
    )


@dataclass(frozen=True)
class BlameSettings(Settings):
    """What a failure by the ZMP tells (beyond the paper)."""

    directed: bool = setting(
        False,
        "",
        "true: alternatives are blamed by how they push the ZMP; false: all of the "
        "last decisions are",
    )
    knot_spacing_s: float = setting(
        0.4, "s", "h of the correction's B-spline", above=0.0, upper=5.0
    )
    order: int = setting(3, "", "order of the correction's B-spline", lower=3, upper=4)
    zmp_per_position: float = setting(
        0.83, "m/m", "how far the ZMP moves with the waist"
    )
    zmp_per_acceleration_s2: float = setting(
        -0.051, "s^2", "how far the ZMP moves with the waist's acceleration"
    )


@dataclass(frozen=True)
class RewardSettings(Settings):
    """Rewards (Table 2) and penalties (Table 1)."""

    success: float = setting(10_000.0, "", "RWDforSuc", above=0.0)
    goal: float = setting(10.0, "", "RWDforGD", lower=0.0)
    penalty: float = setting(10.0, "", "pnlty of every type of penalty", above=0.0)


@dataclass(frozen=True)
class ScheduleSettings(Settings):
    """The learning schedule (Section 5.1)."""

    successes_per_subtask: int = setting(
        15, "successes", "LT: RWDforSuc received before t_f is extended", lower=1
    )
    first_target_s: float = setting(
        1.875, "s", "target walking time of the first subtask (T_step)", lower=0.02
    )
    extension_s: float = setting(
        0.9375, "s", "how much later the next subtask ends (T_step / 2)", lower=0.02
    )
    run_on: bool = setting(
        False,
        "",
        "a walk that masters its subtask goes on to the next one's target at once "
        "(beyond the paper)",
    )
    proof_s: float = setting(
        0.6,
        "s",
        "what was decided so shortly before a walk runs on is not rewarded yet",
        lower=0.0,
        upper=100.0,
    )


@dataclass(frozen=True)
class LearnerSettings(MethodSettings):
    """All of the learner of the walking task: the method, and the task."""

    action: ActionSettings = section(ActionSettings)
    inputs: InputSettings = section(InputSettings)
    cost: CostSettings = section(CostSettings)
    blame: BlameSettings = section(BlameSettings)
    rewards: RewardSettings = section(RewardSettings)
    schedule: ScheduleSettings = section(ScheduleSettings)

    def check_together(self) -> None:
        """Refuse what joint rules cannot do.

        Their tables would take all memory, Na^2 of them a state, and they have no order
        by which blame could be directed.
        """
        if self.blame.directed and not self.xol.decomposed:
            raise SettingsError(
                "blame.directed", True, "must be false where xol.decomposed is"
            )
        if not self.xol.decomposed and self.action.alternatives > _MOST_JOINT:
            raise SettingsError(
                "action.alternatives",
                self.action.alternatives,
                f"must be at most {_MOST_JOINT} where xol.decomposed is false",
            )
