"""What the simulated robot reports at every learning tick."""

from __future__ import annotations

from typing import Annotated

import msgspec

from msgs_json.end_cause import EndCause

Count = Annotated[int, msgspec.Meta(ge=0)]


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
    planned_double_support: bool
    measured_right_support: bool
    measured_double_support: bool
    step_index: Count
    """Single supports begun so far (0 before the first step)."""


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

    simulation: str
    """Name of the simulation's run; a clock belongs to it."""
    episode: Count
    """Number of the walk, from 1, as the simulation counts."""
    clock_ticks: Count
    """Control ticks of the simulation's clock; no two observations have the same."""
    control_tick: Count
    """Control ticks walked since the episode began."""
    phase: PhaseFlags
    waist_in_support_foot_m: tuple[float, float]
    """(x, y) of the waist from the planned support foot's ankle point."""
    zmp_error_m: tuple[float, float]
    """Measured minus reference ZMP, (x, y) in the world frame."""
    waist_acceleration_m_s2: tuple[float, float]
    worst_zmp_error_m: float
    worst_joint_velocity_rad_s: float
    zmp_error_integral_m2_s2: float
    """Increment of int |Z_err|^2 t dt."""
    joint_error_integral_rad2_s: float
    """Increment of int |q_ref - q|^2 dt."""
    torque_integral_n2m2_s: float
    """Increment of int |u|^2 dt."""
    mean_joint_error_rad: float
    """Mean over the joints of |q_ref - q| at the last control tick."""
    mean_joint_velocity_error_rad_s: float
    """Mean over the joints of |dq_ref - dq| at the last control tick."""
    trajectory_sha256: str
    """Hash of all that the walk measured so far."""
    end_cause: EndCause | None = None
    """Set when the walk ended within this learning tick."""
