"""ZMP of a motion by its kinematics: all links as point masses."""

from biped_common.compiled import compiled
from biped_description.kernels import Array

GRAVITY_M_S2 = 9.81


@compiled
def multilink_zmp(
    before: Array,
    com: Array,
    after: Array,
    period_s: float,
    masses: Array,
    force_x: float,
    force_y: float,
    height: float,
) -> tuple[float, float, float]:
    """Return the ZMP (x, y) on the floor [m] and the floor's vertical force [N].

    Where the floor would have to pull, there is no ZMP: zeros are returned.

    With link CoMs (x, y, z) and masses m, and a horizontal force f at the height h:
    `x_zmp = (sum m ((z'' + g) x - x'' z) + f_x h) / sum m (z'' + g)`, y alike, where
    `x'' = (x[i+1] - 2 x[i] + x[i-1]) / T^2`, as in semi-implicit Euler.

    Args:
        before: (links, 3) CoMs one tick ago [m], world frame.
        com: (links, 3) CoMs now [m].
        after: (links, 3) CoMs at the next tick [m].
        period_s: T, from one tick to the next [s].
        masses: (links,) [kg].
        force_x: from outside [N].
        force_y: from outside [N].
        height: at which it acts [m].
    """
    moment_x, moment_y, vertical = force_x * height, force_y * height, 0.0
    for i in range(len(masses)):
        x, y, z = com[i, 0], com[i, 1], com[i, 2]
        ax = (after[i, 0] - 2.0 * x + before[i, 0]) / period_s**2
        ay = (after[i, 1] - 2.0 * y + before[i, 1]) / period_s**2
        az = (after[i, 2] - 2.0 * z + before[i, 2]) / period_s**2
        lift = masses[i] * (az + GRAVITY_M_S2)
        vertical += lift
        moment_x += lift * x - masses[i] * ax * z
        moment_y += lift * y - masses[i] * ay * z
    if vertical <= 0.0:
        return 0.0, 0.0, vertical
    return moment_x / vertical, moment_y / vertical, vertical
