"""What one control tick measures, for whoever listens at 500 Hz."""

from __future__ import annotations

from typing import NamedTuple

import msgspec

from msgs_json.observation import PhaseFlags, StampedPhase
from sim_node.contact import FloorContact
from sim_node.joint_references import PlannedPhase


class ControlTick(NamedTuple):
    """All that one control tick measured."""

    clock_ticks: int
    """Control ticks of the simulation's clock."""
    control_tick: int
    """Control ticks since the walk began."""
    joint_reference: list[float]
    """(12,) [rad]"""
    joint_velocity_reference: list[float]
    """(12,) [rad/s]"""
    joint_position: tuple[float, ...]
    """(12,) [rad]"""
    joint_velocity: tuple[float, ...]
    """(12,) [rad/s]"""
    joint_torque: tuple[float, ...]
    """(12,) [N m]"""
    contact: FloorContact
    zmp_reference: list[float]
    """(x, y) [m]"""
    zmp_error_m: float
    """Norm of measured minus reference ZMP."""
    planned_phase: PlannedPhase

    @property
    def phase(self) -> StampedPhase:
        """The support phase, planned and measured."""
        flags = phase_flags(self.planned_phase, self.contact)
        return StampedPhase(
            clock_ticks=self.clock_ticks, **msgspec.structs.asdict(flags)
        )


def phase_flags(planned: PlannedPhase, contact: FloorContact) -> PhaseFlags:
    """Put the planned phase and the one that the feet feel side by side."""
    right_support, double_support, step_index = planned
    left, right = contact.left_load_n, contact.right_load_n
    return PhaseFlags(
        planned_right_support=right_support,
        planned_double_support=double_support,
        measured_right_support=right > left,
        measured_double_support=left > 0.0 and right > 0.0,
        step_index=step_index,
    )
