"""What the simulated robot reports at every learning tick."""

from __future__ import annotations

import msgspec

from msgs_json.bounds import Count, Digest, Name
from msgs_json.end_cause import EndCause


class PhaseFlags(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    forbid_unknown_fields=True,
    tag_field="version",
    tag=1,
):
    """Support phase, as planned by the gait and as measured by contact.

    In double support the planned support leg is the coming stance leg; the measured
    one is the leg that carries more load.
    """

    planned_right_support: bool
    """Support leg as planned: right, not left."""
    planned_double_support: bool
    """Both feet are planned to carry load."""
    measured_right_support: bool
    """The right foot carries more load than the left."""
    measured_double_support: bool
    """Both feet carry load."""
    step_index: Count
    """Single supports begun so far (0 before the first step)."""


class StampedPhase(PhaseFlags, frozen=True, kw_only=True, tag=2):
    """Support phase at a control tick, as it is published by itself."""

    clock_ticks: Count
    """Control ticks of the simulation's clock."""


class Observation(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    forbid_unknown_fields=True,
    tag_field="version",
    tag=1,
):
    """State inputs and cost increments of one learning tick (paper, Section 4.1).

    Positions and errors are those of the tick's last control tick; worst values and
    integrals run over all of its control ticks.
    """

    simulation: Name
    """Name of the simulation's run; a clock belongs to it."""
    episode: Count
    """Number of the walk, from 1, as the simulation counts."""
    clock_ticks: Count
    """Control ticks of the simulation's clock; no two observations have the same."""
    control_tick: Count
    """Control ticks walked since the episode began."""
    phase: PhaseFlags
    """Support phase at the last control tick."""
    waist_in_support_foot_m: tuple[float, float]
    """(x, y) of the waist from the planned support foot's ankle point [m]."""
    zmp_error_m: tuple[float, float]
    """Measured minus reference ZMP, (x, y) in the world frame [m]."""
    waist_acceleration_m_s2: tuple[float, float]
    """Change of the waist's velocity per time since the last observation [m/s^2]."""
    worst_zmp_error_m: float
    """Largest norm of the ZMP error [m]."""
    worst_joint_velocity_rad_s: float
    """Largest joint speed [rad/s]."""
    zmp_error_integral_m2_s2: float
    """Increment of int |Z_err|^2 t dt [m^2 s^2]."""
    joint_error_integral_rad2_s: float
    """Increment of int |q_ref - q|^2 dt [rad^2 s]."""
    torque_integral_n2m2_s: float
    """Increment of int |u|^2 dt [N^2 m^2 s]."""
    mean_joint_error_rad: float
    """Mean over the joints of |q_ref - q| at the last control tick [rad]."""
    mean_joint_velocity_error_rad_s: float
    """Mean over the joints of |dq_ref - dq| at the last control tick [rad/s]."""
    trajectory_sha256: Digest
    """Hash of all that the walk measured so far."""
    end_cause: EndCause | None = None
    """Set when the walk ended within this learning tick."""
