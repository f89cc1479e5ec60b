"""A sound payload of every kind, to be changed with `msgspec.structs.replace`."""

from msgs_json.end_cause import EndCause
from msgs_json.episode_result import CostTerms, EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation, PhaseFlags, StampedPhase
from msgs_json.walk_plan import GaitPhase, WalkPlan

PHASE = PhaseFlags(
    planned_right_support=True,
    planned_double_support=False,
    measured_right_support=True,
    measured_double_support=False,
    step_index=2,
)
STAMPED_PHASE = StampedPhase(
    clock_ticks=1040,
    planned_right_support=True,
    planned_double_support=False,
    measured_right_support=True,
    measured_double_support=True,
    step_index=2,
)
OBSERVATION = Observation(
    simulation="a1",
    episode=3,
    clock_ticks=1040,
    control_tick=40,
    phase=PHASE,
    waist_in_support_foot_m=(0.01, -0.02),
    zmp_error_m=(0.003, 0.004),
    waist_acceleration_m_s2=(0.5, -0.5),
    worst_zmp_error_m=0.005,
    worst_joint_velocity_rad_s=1.5,
    zmp_error_integral_m2_s2=1e-7,
    joint_error_integral_rad2_s=1e-9,
    torque_integral_n2m2_s=20.0,
    mean_joint_error_rad=1e-4,
    mean_joint_velocity_error_rad_s=1e-3,
    trajectory_sha256="6f1c",
    end_cause=EndCause.ZMP_ERROR,
)
RESULT = EpisodeResult(
    episode=3,
    learning=True,
    end_cause=EndCause.COMPLETED,
    control_ticks=940,
    target_ticks=940,
    peak_zmp_error_m=0.03,
    peak_joint_velocity_rad_s=2.0,
    cost=CostTerms(
        zmp=1.0,
        final_zmp=0.5,
        joint_tracking=0.25,
        joint_torque=0.125,
        final_joint_position=0.0625,
        final_joint_velocity=0.03125,
    ),
    t_err_estimate=2.1,
    reward=10.0,
    subtask=0,
    trajectory_sha256="6f1c",
    schedule_complete=False,
)
STATUS = LearnerStatus(
    instance="learner-1",
    seed=0,
    target_time_s=1.88,
    subtask=0,
    subtasks=11,
    successes=3,
    episodes=40,
    survival=0.7,
    figures={"basis_states": 900, "fixed_states": 12, "penalty_states": 80},
    t_err_estimate=2.1,
    schedule_complete=False,
    learned=False,
    frozen=False,
    given_up={EndCause.LATE: 2, EndCause.RESET: 1},
    simulated_s=63.2,
    memory_sha256="0a",
    trajectory_sha256="6f1c",
)
PLAN = WalkPlan(
    walk_ticks=5625,
    waist_m=(0.0, 0.0, 0.475),
    left_foot_m=(0.0, 0.09, 0.0),
    right_foot_m=(0.0, -0.09, 0.0),
    zmp_m=(0.02, 0.0),
    phases=(
        GaitPhase(from_tick=0, right_support=False, double_support=True, step_index=0),
        GaitPhase(
            from_tick=625, right_support=False, double_support=False, step_index=1
        ),
        GaitPhase(
            from_tick=1038, right_support=True, double_support=True, step_index=1
        ),
    ),
)
