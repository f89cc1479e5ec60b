"""What the floor feels: ZMP, foot loads and penetration."""

from __future__ import annotations

from typing import NamedTuple


class FloorContact(NamedTuple):
    """What the floor feels in one control tick."""

    zmp_x_m: float
    zmp_y_m: float
    left_load_n: float
    right_load_n: float
    penetration_m: float


NO_CONTACT = FloorContact(0.0, 0.0, 0.0, 0.0, 0.0)
