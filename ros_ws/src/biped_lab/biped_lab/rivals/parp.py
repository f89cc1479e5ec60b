"""Penalty avoiding rational policy making (PARP, [11]), read by its Section 2 here.

    a rule is a penalty rule if it has failed once, or can lead to a penalty state;
    a state is a penalty state if it has no other rules;
    among the other rules: profit sharing.

The penalty rule decision (PRD) finds both from what was seen: failures, and which state
followed on which rule. With sub-rules (Section 3.4), a state is a penalty state if all
alternatives of some component are penalty sub-rules. One failure is enough, for ever:
N0 and lambda, which ask for more, came with the improved PARP [18].
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from biped_common.settings import setting
from biped_lab.learner_contestant import learner_entry
from biped_lab.rivals.episodic_ps import EpisodicProfitSharing, EpisodicSettings
from learner_node.learner import Push
from learner_node.memory import Arrays, count_of_states
from learner_node.problem import Problem
from learner_node.states import StateSettings

Transition = tuple[int, int, int, int]
"""A state, component and alternative of a sub-rule, and another state it led to."""


def penalty_rule_decision(
    failed: NDArray[np.bool_], exists: NDArray[np.bool_], leads_to: NDArray[np.int64]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return the (N, I, J) penalty sub-rules and the (N,) penalty states.

    Args:
        failed: (N, I, J) the sub-rule has got a penalty directly.
        exists: (I, J) the component has that many alternatives.
        leads_to: (n, 4) transitions.
    """
    rules, states = failed.copy(), np.zeros(len(failed), dtype=np.bool_)
    k, i, j, following = leads_to.T
    while True:
        found = np.any(np.all(rules | ~exists, axis=2), axis=1)
        if (found == states).all():
            return rules, states
        states = found
        doomed = states[following]
        rules[k[doomed], i[doomed], j[doomed]] = True


@dataclass(frozen=True)
class ParpSettings(EpisodicSettings):
    """Constants of PARP: those of profit sharing, and whom a failure marks."""

    blamed_decisions: int = setting(
        1,
        "decisions",
        "before a failure, whose sub-rules have failed; 1: directly responsible",
        lower=1,
        upper=100_000,
    )


class Parp(EpisodicProfitSharing):
    """Profit sharing among the rules that are no penalty rules."""

    TABLES: ClassVar[tuple[str, ...]] = ("q", "failed")

    def __init__(
        self,
        settings: ParpSettings,
        states: StateSettings,
        problem: Problem,
        rng: np.random.Generator,
    ) -> None:
        """Start with all weights zero and no penalty rules.

        Args:
            settings: gamma, base weight, decisions blamed.
            states: how inputs become states.
            problem: inputs, actions and penalties.
            rng: source of every random choice.
        """
        super().__init__(settings, states, problem, rng)
        self.blamed_decisions = settings.blamed_decisions
        self.failed = np.zeros(self.q.shape, dtype=np.bool_)
        """(capacity, I, J) the sub-rule has got a penalty directly."""
        self.transitions: set[Transition] = set()
        self._new_transitions: set[Transition] = set()
        """Seen in this episode for the first time."""
        self._decide()

    def begin_episode(self, inputs: NDArray[np.float64]) -> None:
        """Take the initial state."""
        super().begin_episode(inputs)
        self._new_transitions.clear()
        self._chosen: list[int] = []

    def choose(self) -> NDArray[np.int64]:
        """Choose by the roulette, and remember it."""
        alternatives = super().choose()
        # Beside the series, which a reward empties.
        self._chosen = self.series[-1][1].tolist()
        return alternatives

    def advance(self, inputs: NDArray[np.float64]) -> None:
        """Move to the next state, and remember what led to it."""
        origin = self.state
        super().advance(inputs)
        if self.state != origin:
            seen = {(origin, i, j, self.state) for i, j in enumerate(self._chosen)}
            self._new_transitions |= seen - self.transitions
            self.transitions |= seen

    def penalise(self, penalty: int, push: Push | None = None) -> None:
        """Mark what has failed."""
        for k, chosen in self.series[-self.blamed_decisions :]:
            self.failed[k, self.components, chosen] = True
        super().penalise(penalty)

    def finish_episode(self) -> None:
        """Decide anew who is a penalty rule."""
        super().finish_episode()
        self._new_transitions.clear()
        self._decide()

    def give_up_episode(self) -> None:
        """Become what it was before the episode began, but for the random numbers."""
        super().give_up_episode()
        self.transitions -= self._new_transitions
        self._new_transitions.clear()

    def refused(self, k: int) -> NDArray[np.bool_] | None:
        """Return the (I, J) penalty sub-rules of state k."""
        if k >= len(self.penalty_rules):
            return None  # made since the last decision
        refused: NDArray[np.bool_] = self.penalty_rules[k]
        return refused

    def figures(self) -> dict[str, float]:
        """Return the numbers of states, promising ones and penalty states."""
        return {**super().figures(), "penalty_states": int(self.penalty_states.sum())}

    def memory(self) -> Arrays:
        """Return a copy of all that was learned, as arrays; between episodes."""
        return {**super().memory(), "transitions": self._transition_array()}

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `memory` returned.

        Raises:
            ValueError: an array is missing or belongs to another problem.
        """
        found = memory.get("transitions")
        limits = np.array([count := count_of_states(memory), *self.exists.shape, count])
        if (
            found is None
            or found.dtype != np.int64
            or found.shape[1:] != limits.shape
            or not ((found >= 0) & (found < limits)).all()
        ):
            raise ValueError("memory: array transitions is missing or does not fit")
        super().restore(memory)
        self.transitions = set(map(tuple, found.tolist()))
        self._decide()

    def _decide(self) -> None:
        self.penalty_rules, self.penalty_states = penalty_rule_decision(
            self.failed, self.exists, self._transition_array()
        )

    def _transition_array(self) -> NDArray[np.int64]:
        return np.array(sorted(self.transitions), dtype=np.int64).reshape(-1, 4)

    def _keep(self, remaining: NDArray[np.int64]) -> None:
        super()._keep(remaining)
        new_number = {int(old): new for new, old in enumerate(remaining)}
        self.transitions = {
            (new_number[k], i, j, new_number[following])
            for k, i, j, following in self.transitions
            if k in new_number and following in new_number
        }


ENTRY = learner_entry(
    __name__,
    ParpSettings,
    lambda options, settings, problem, rng: Parp(
        options, settings.states, problem, rng
    ),
)
