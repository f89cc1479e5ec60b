"""ZMP, foot loads and penetration from the contact points with the floor."""

from __future__ import annotations

from typing import Any, NamedTuple

# Indices into PyBullet's contact point tuples.
_LINK_A, _POSITION_ON_B, _DISTANCE, _NORMAL_FORCE = 3, 6, 8, 9


class FloorContact(NamedTuple):
    """What the floor feels in one control tick."""

    zmp_x_m: float
    zmp_y_m: float
    left_load_n: float
    right_load_n: float
    penetration_m: float


NO_CONTACT = FloorContact(0.0, 0.0, 0.0, 0.0, 0.0)


def floor_contact(
    points: Any, left_sole: int, held: tuple[float, float]
) -> FloorContact:
    """Sum up contact points: ZMP = sum(f p) / sum(f) over pressing points.

    With no load on either foot there is no ZMP; the one `held` from the tick before is
    given again, and the loads are zero, so that the caller can tell.

    Args:
        points: PyBullet contact points with the robot as body A.
        left_sole: link index of the left foot; the other contacts are the right's.
        held: (x, y) of the last ZMP, world frame [m].
    """
    left = right = moment_x = moment_y = 0.0
    nearest = 0.0
    for point in points:
        force = point[_NORMAL_FORCE]
        if point[_DISTANCE] < nearest:
            nearest = point[_DISTANCE]
        if force > 0.0:
            position = point[_POSITION_ON_B]
            moment_x += force * position[0]
            moment_y += force * position[1]
            if point[_LINK_A] == left_sole:
                left += force
            else:
                right += force
    load = left + right
    if load > 0.0:
        return FloorContact(moment_x / load, moment_y / load, left, right, -nearest)
    return FloorContact(held[0], held[1], 0.0, 0.0, -nearest)
