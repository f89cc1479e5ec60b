"""Observations made by hand."""

from biped_common.timing import TICKS_PER_LEARNING_TICK
from msgs_json.observation import Observation, PhaseFlags

PHASE = PhaseFlags(
    planned_right_support=False,
    planned_double_support=True,
    measured_right_support=False,
    measured_double_support=True,
    step_index=0,
)
QUIET = Observation(
    simulation="by hand",
    episode=0,
    clock_ticks=0,
    control_tick=0,
    phase=PHASE,
    waist_in_support_foot_m=(0.0, 0.0),
    zmp_error_m=(0.0, 0.0),
    waist_acceleration_m_s2=(0.0, 0.0),
    worst_zmp_error_m=0.0,
    worst_joint_velocity_rad_s=0.0,
    zmp_error_integral_m2_s2=0.0,
    joint_error_integral_rad2_s=0.0,
    torque_integral_n2m2_s=0.0,
    mean_joint_error_rad=0.0,
    mean_joint_velocity_error_rad_s=0.0,
    trajectory_sha256="",
)
FIELDS = QUIET.__struct_fields__


def observation(control_tick=0, **changes):
    """An observation in which all is quiet but for the changes."""
    fields = {name: getattr(QUIET, name) for name in FIELDS}
    return Observation(**{**fields, "control_tick": control_tick, **changes})


def phase(**changes):
    names = PHASE.__struct_fields__
    return PhaseFlags(**{**{name: getattr(PHASE, name) for name in names}, **changes})


def ticks_until(end):
    """Control ticks of a walk's observations: every learning tick, and the end."""
    return [*range(0, end, TICKS_PER_LEARNING_TICK), end]
