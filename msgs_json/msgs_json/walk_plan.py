"""What the trajectory knows of a walk before it begins."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from msgs_json.bounds import Count

Point = tuple[float, float, float]


class GaitPhase(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A stretch of the walk in which the planned support stays the same."""

    from_tick: Count
    """Control tick of the walk at which it begins."""
    right_support: bool
    """Support leg: right, not left; in double support the coming stance leg."""
    double_support: bool
    """Both feet carry load."""
    step_index: Count
    """Single supports begun so far (0 before the first step)."""


class WalkPlan(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    forbid_unknown_fields=True,
    tag_field="version",
    tag=1,
):
    """The pose in which walks start, their length and their phases; world frame."""

    walk_ticks: Count
    """Control ticks of the whole walk."""
    waist_m: Point
    """Middle of the hip line at the start [m]."""
    left_foot_m: Point
    """Point of the left sole under the ankle at the start [m]."""
    right_foot_m: Point
    """Point of the right sole under the ankle at the start [m]."""
    zmp_m: tuple[float, float]
    """Reference ZMP at the start [m]."""
    phases: Annotated[tuple[GaitPhase, ...], Meta(max_length=500)]
    """In order, the first from tick 0; the last one goes on."""
