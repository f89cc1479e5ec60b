"""A genetic algorithm whose mutation knows where the walk failed.

Modelled on the simple genetic algorithm (Goldberg 1989) with tournaments and one elite:
generations of plans, one-point crossover at a time of the walk. Its mutation draws
points before the failure anew, as `tail_search` does. The paper names hybrids of RL and
evolutionary computing [5, 9] as rivals and does not describe them: this is none of
theirs, and no policy evolves here, only an open-loop plan.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from biped_common.settings import Settings, setting
from biped_lab.searches.plan import PlanSpace
from biped_lab.searches.search_contestant import search_entry
from biped_lab.searches.searcher import Walked


@dataclass(frozen=True)
class GeneticOptions(Settings):
    """Constants of the genetic algorithm."""

    population: int = setting(10, "plans", "of a generation", lower=2)
    tournament: int = setting(3, "plans", "drawn; the best becomes a parent", lower=1)
    mutated_points: int = setting(
        4, "control points", "up to the failure, that a mutation can reach", lower=1
    )
    mutation: float = setting(
        0.5, "", "chance of each of these to be drawn anew", above=0.0, upper=1.0
    )


class _Individual(NamedTuple):
    plan_m: NDArray[np.float64]
    walked: Walked


class Genetic:
    """Breeds one generation of plans from the other."""

    def __init__(
        self, options: GeneticOptions, space: PlanSpace, rng: np.random.Generator
    ) -> None:
        """Begin with a generation of random plans."""
        self._options = options
        self._space = space
        self._rng = rng
        self._parents: list[_Individual] = []
        self._generation: list[_Individual] = []
        self._asked_m = np.zeros(0)

    def ask(self, points: int) -> NDArray[np.float64]:
        """Return the next child, or a random plan of the first generation."""
        if self._parents:
            self._asked_m = self._child()
        else:
            self._asked_m = self._space.random(self._rng, self._space.points)
        return self._asked_m

    def tell(self, walked: Walked) -> None:
        """Add the plan to its generation; a full one becomes the parents."""
        self._generation.append(_Individual(self._asked_m, walked))
        if len(self._generation) == self._options.population:
            self._parents = self._generation
            self._generation = [min(self._parents, key=_loss)]  # the elite

    def _child(self) -> NDArray[np.float64]:
        one, other = self._parent(), self._parent()
        end = self._space.points_until(one.walked.ticks)
        cut = self._rng.integers(end + 1)
        plan_m = np.concatenate((other.plan_m[:cut], one.plan_m[cut:]))
        first = max(0, end - self._options.mutated_points)
        drawn = self._space.random(self._rng, end - first)
        mutated = self._rng.random((end - first, 1)) < self._options.mutation
        plan_m[first:end] = np.where(mutated, drawn, plan_m[first:end])
        return plan_m

    def _parent(self) -> _Individual:
        among = len(self._parents)
        drawn = self._rng.integers(among, size=self._options.tournament).tolist()
        best: _Individual = min((self._parents[i] for i in drawn), key=_loss)
        return best


def _loss(individual: _Individual) -> float:
    return individual.walked.loss


ENTRY = search_entry(
    __name__,
    GeneticOptions,
    lambda own, _, space, rng: Genetic(own, space, rng),
)
