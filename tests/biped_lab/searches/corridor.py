"""A landscape without a robot: plans walk as far as they keep to a hidden corridor."""

import numpy as np

from biped_common.timing import CONTROL_PERIOD_US
from biped_lab.searches.plan import COMPONENTS, PlanSpace
from biped_lab.searches.searcher import Searcher, Walked

SPACE = PlanSpace(points=8, spacing_us=400_000, limit_m=0.024, alternatives=15)
TICKS_PER_POINT = SPACE.spacing_us // CONTROL_PERIOD_US
HALF_WIDTH_M = 0.013


class Corridor:
    """Off the corridor at a point, a walk fails by the end of it."""

    def __init__(self, space: PlanSpace, seed: int) -> None:
        """Lay out the corridor; it winds within the alternatives."""
        rng = np.random.default_rng(seed)
        middle = rng.uniform(-0.018, 0.018, (space.points, COMPONENTS))
        self._middle_m = middle
        self._space = space

    def walk(self, plan_m: np.ndarray, points: int) -> Walked:
        """Walk so many points of a plan."""
        kept_m = self._space.corrections_m(self._space.nearest(plan_m))
        off_m = np.abs(kept_m - self._middle_m)[:points].max(axis=1)
        failed = np.flatnonzero(off_m > HALF_WIDTH_M)
        walked = int(failed[0]) + 1 if len(failed) else points
        cost = float((off_m[:walked] ** 2).sum())
        return Walked(walked * TICKS_PER_POINT, len(failed) == 0, cost)


def search(searcher: Searcher, corridor: Corridor, points: int, most: int) -> int:
    """Ask and tell until so many points are walked; return the plans that it took."""
    for plans in range(1, most + 1):
        walked = corridor.walk(searcher.ask(points), points)
        searcher.tell(walked)
        if walked.completed:
            return plans
    raise AssertionError(f"not found in {most} plans")
