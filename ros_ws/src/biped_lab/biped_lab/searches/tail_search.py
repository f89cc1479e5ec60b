"""(1+1) search at the point of failure: draw the last corrections before it anew.

An evolution strategy of one parent and one child (Rechenberg 1973), whose mutation is
that of a backtracking search: corrections long before the failure have been walked
with, those behind it were not tried yet, and the ones in between are to blame.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from biped_common.settings import Settings, setting
from biped_lab.searches.plan import COMPONENTS, PlanSpace
from biped_lab.searches.search_contestant import search_entry
from biped_lab.searches.searcher import Walked


@dataclass(frozen=True)
class TailSearchOptions(Settings):
    """How much is drawn anew."""

    points: int = setting(
        3, "control points", "drawn anew, the one at the failure the last", lower=1
    )


class TailSearch:
    """Keeps the best plan, and mutates its end."""

    def __init__(
        self, options: TailSearchOptions, space: PlanSpace, rng: np.random.Generator
    ) -> None:
        """Begin with the walk that is not corrected."""
        self._options = options
        self._space = space
        self._rng = rng
        self._best_m = self._asked_m = np.zeros((space.points, COMPONENTS))
        self._best: Walked | None = None

    def ask(self, points: int) -> NDArray[np.float64]:
        """Return the best plan with its last points before the failure drawn anew."""
        self._asked_m = self._best_m.copy()
        if self._best is not None:
            end = self._space.points_until(self._best.ticks)
            first = max(0, end - self._options.points)
            self._asked_m[first:end] = self._space.random(self._rng, end - first)
        return self._asked_m

    def tell(self, walked: Walked) -> None:
        """Keep the plan if it is not worse than the best so far."""
        if self._best is None or walked.loss <= self._best.loss:
            self._best, self._best_m = walked, self._asked_m


ENTRY = search_entry(
    __name__,
    TailSearchOptions,
    lambda own, _, space, rng: TailSearch(own, space, rng),
)
