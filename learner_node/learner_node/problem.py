"""What there is to learn, in a learner's terms (Section 2)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class ActionSpace:
    """Nm components with alternatives each, seen by the tables as sub-rules.

    With decomposition (Section 3.4) a rule (state, action) is a set of sub-rules, one
    per component. Without it there is one component, whose alternatives are all joint
    actions. Components may differ in size; tables are as wide as the largest.
    """

    alternatives: tuple[int, ...]
    """Na of each component."""
    decomposed: bool = True

    def __post_init__(self) -> None:
        """Refuse spaces without a choice."""
        if not self.alternatives:
            raise ValueError("alternatives = (): at least one component is needed")
        if min(self.alternatives) < 2:
            raise ValueError(
                f"alternatives = {self.alternatives}: must be at least 2 of each"
            )

    @property
    def sizes(self) -> tuple[int, ...]:
        """Sub-rules of each component of the tables."""
        return self.alternatives if self.decomposed else (math.prod(self.alternatives),)

    @property
    def table_shape(self) -> tuple[int, int]:
        """(components, alternatives) of the tables."""
        return len(self.sizes), max(self.sizes)

    def alternatives_of(self, chosen: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the (Nm,) alternatives that the chosen sub-rules stand for."""
        if self.decomposed:
            return chosen.copy()
        digits = np.unravel_index(int(chosen[0]), self.alternatives)
        return np.array(digits, dtype=np.int64)


@dataclass(frozen=True)
class Problem:
    """Inputs, actions and penalties, without what they mean."""

    n_discrete: int
    """Leading inputs that are discrete; they partition the space."""
    radii: tuple[float, ...]
    """Width of a basis function per continuous input, in its unit; they come after
    the discrete ones. Ns = n_discrete + len(radii)."""
    space: ActionSpace
    penalty_values: tuple[float, ...]
    """pnlty per type, highest priority first; the last one is that of the additional
    penalty p_Np for moving to a penalty state, which the learner pays itself."""

    def __post_init__(self) -> None:
        """Refuse problems that cannot be asked."""
        if any(not 0.0 < radius < math.inf for radius in self.radii):
            raise ValueError(f"radii = {self.radii}: must be positive and finite")
        if len(self.penalty_values) < 2:
            raise ValueError("penalty_values: at least one penalty and p_Np are needed")

    def check_penalty(self, penalty: int) -> None:
        """Refuse a 0-based penalty type that the task cannot give."""
        if not 0 <= penalty < len(self.penalty_values) - 1:
            raise ValueError(
                f"penalty = {penalty}: must be between 0 and "
                f"{len(self.penalty_values) - 2}"
            )
