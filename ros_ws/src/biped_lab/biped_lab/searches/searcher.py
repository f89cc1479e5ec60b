"""Ask and tell: a searcher proposes a plan, and is told how far it walked.

All chance comes from the generator that it was made with. A searcher that is asked and
told the same things therefore proposes the same plans: a checkpoint needs no more than
the history of its walks.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray


class Walked(NamedTuple):
    """What became of a plan."""

    ticks: int
    """Control ticks walked."""
    completed: bool
    """The target time was reached."""
    cost: float
    """T_err of eq. (2), from 0 to infinity."""

    @property
    def loss(self) -> float:
        """The smaller the better: more ticks first, among equals the smaller cost."""
        return 1.0 - 1.0 / (1.0 + self.cost) - self.ticks


class Searcher(Protocol):
    """Looks for a plan that walks the whole walk."""

    def ask(self, points: int) -> NDArray[np.float64]:
        """Return the next plan to walk, (n, 2) corrections [m].

        Args:
            points: how many of its points, from the first, have a part in a walk of
                the present target time.
        """

    def tell(self, walked: Walked) -> None:
        """Take in what became of the plan that was asked for last."""
