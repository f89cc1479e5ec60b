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

    @property
    def loaded(self) -> bool:
        """Whether a foot carries load; without, there is no ZMP."""
        return self.left_load_n + self.right_load_n > 0.0

    def holding(self, before: FloorContact) -> FloorContact:
        """Return the same with the ZMP of the tick before, for one without load."""
        return self._replace(zmp_x_m=before.zmp_x_m, zmp_y_m=before.zmp_y_m)


NO_CONTACT = FloorContact(0.0, 0.0, 0.0, 0.0, 0.0)
