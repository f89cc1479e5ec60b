"""CMA-ES (Hansen and Ostermeier 2001; library `cma`) over the control points.

The incremental variant searches only the points that have a part in a walk of the
present target time. When that has been walked, the target grows, and a new CMA-ES
starts around the plan that did it. A CMA-ES that has converged starts anew around the
best plan, too, with its first step size.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cma
import numpy as np
from numpy.typing import NDArray

from biped_bringup.run_settings import RunSettings
from biped_common.settings import Settings, setting
from biped_lab.searches.plan import COMPONENTS, PlanSpace
from biped_lab.searches.search_contestant import search_entry
from biped_lab.searches.searcher import Walked


@dataclass(frozen=True)
class CmaEsOptions(Settings):
    """Constants of CMA-ES; all others are the library's defaults."""

    first_step: float = setting(
        0.3, "largest corrections", "standard deviation at the start", above=0.0
    )
    population: int = setting(
        0, "plans", "lambda; 0: 4 + 3 ln(2 n) of n points", lower=0
    )


class CmaEs:
    """Walks one population after the other."""

    def __init__(
        self, options: CmaEsOptions, space: PlanSpace, rng: np.random.Generator
    ) -> None:
        """Begin around the walk that is not corrected."""
        self._options = options
        self._space = space
        self._rng = rng
        self._best: tuple[float, NDArray[np.float64]] | None = None
        self._strategy: Any = None
        self._points = 0
        self._population: list[NDArray[np.float64]] = []
        self._losses: list[float] = []

    def ask(self, points: int) -> NDArray[np.float64]:
        """Return the next plan of the population; points beyond are not corrected."""
        if points != self._points:
            self._start(points)
        elif len(self._losses) == len(self._population):
            self._strategy.tell(self._population, self._losses)
            if self._strategy.stop():
                self._start(points)
            else:
                self._draw()
        return self._plan(self._population[len(self._losses)])

    def tell(self, walked: Walked) -> None:
        """Take in the loss of that plan."""
        asked = self._population[len(self._losses)]
        self._losses.append(walked.loss)
        if self._best is None or walked.loss < self._best[0]:
            self._best = walked.loss, asked

    def _plan(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        plan_m = np.zeros((self._space.points, COMPONENTS))
        plan_m[: self._points] = point.reshape(-1, COMPONENTS)
        return self._space.limit_m * plan_m

    def _start(self, points: int) -> None:
        """Begin a CMA-ES over so many points, in units of the largest correction."""
        start = np.zeros(points * COMPONENTS)
        if self._best is not None:
            known = self._best[1][: len(start)]
            start[: len(known)] = known
        settings = {
            "bounds": [-1.0, 1.0],
            "randn": lambda *shape: self._rng.standard_normal(shape),
            "seed": np.nan,  # draw from nothing else
            "verbose": -9,
        }
        if self._options.population:
            settings["popsize"] = self._options.population
        self._strategy = cma.CMAEvolutionStrategy(
            start, self._options.first_step, settings
        )
        self._points = points
        self._draw()

    def _draw(self) -> None:
        self._population, self._losses = self._strategy.ask(), []


def _make(
    own: CmaEsOptions, _: RunSettings, space: PlanSpace, rng: np.random.Generator
) -> CmaEs:
    return CmaEs(own, space, rng)


WHOLE = search_entry(__name__, CmaEsOptions, _make)
INCREMENTAL = search_entry(__name__, CmaEsOptions, _make, incremental=True)
