"""The overall algorithm of Section 3.6, step by step, for one stream of inputs.

    begin_episode   2(a), (b)         the initial state; an empty queue
    choose          2(c)i to iii      an action by Section 3.5; its rule into the queue
    reward          2(c)v             Q <- Q + rwd E; TUC; Strategy 1 fixes states
    penalise        2(c)vi            P <- P + pnlty E; fixed states released; PRD
    advance         2(c)iv, vii       the next state; p_Np; E <- gamma E
    finish_subtask  2(c)viii          Strategy 2 fixes states
    finish_episode  2(c)vii, ix       useless states are forgotten
    give_up_episode                   as if the episode had never begun

It answers the calls of `learner_node.learner.Learner`; who owns the task makes them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from learner_node.journal import RowJournal
from learner_node.learner import Push
from learner_node.memory import Arrays, check_memory, count_of_states
from learner_node.problem import Problem
from learner_node.states import NO_STATE, BasisStates, StateSettings
from learner_node.xol import blame, penalties, selection
from learner_node.xol.queue import DecisionQueue
from learner_node.xol.rules import RuleTable
from learner_node.xol.settings import XolSettings


class XolAgent:
    """Online profit sharing with penalty avoidance and fixed-mode states."""

    def __init__(
        self,
        settings: XolSettings,
        states: StateSettings,
        problem: Problem,
        rng: np.random.Generator,
    ) -> None:
        """Start with an empty memory (step 1).

        Args:
            settings: the constants of Section 3.
            states: how inputs become states.
            problem: inputs, actions and penalties.
            rng: source of every random choice.
        """
        self.settings = settings
        self.problem = problem
        self.rng = rng
        self.states = BasisStates(states, problem)
        self.rules = RuleTable(
            replace(problem.space, decomposed=settings.decomposed),
            len(problem.penalty_values),
        )
        self.queue = DecisionQueue(settings.queue_length, self.rules.space.table_shape)
        self.episode = 0
        self.failures_in_a_row = 0
        self.state = NO_STATE
        self._chosen = np.zeros(self.rules.space.table_shape[0], dtype=np.int64)
        self._kept: dict[int, NDArray[np.int64]] = {}
        """What states keep to in this episode, where they draw once in it."""
        self._journal = RowJournal()
        self._failures_before = 0
        """Failures in a row when the episode began."""

    # -- one episode -------------------------------------------------------------

    def begin_episode(self, inputs: NDArray[np.float64]) -> None:
        """Take the initial state and empty the queue (2(a), 2(b))."""
        self.episode += 1
        self._failures_before = self.failures_in_a_row
        self.states.mark()
        self._journal.begin()
        self.queue.clear()
        self._kept.clear()
        self.state = self._locate(inputs)

    def choose(self) -> NDArray[np.int64]:
        """Select an action by Section 3.5 and put its rule in the queue (2(c)i-iii).

        Returns:
            (Nm,) index of the chosen alternative per component.
        """
        k = self.state
        rules = self.rules
        if k in self._kept:
            self.queue.push(k, self._kept[k])
            return rules.space.alternatives_of(self._kept[k])
        draws = self.rng.random(len(self._chosen))
        if rules.penalty_state[k]:
            selection.choose_ranked(
                k, draws, rules.p, rules.avoided, rules.sizes, self._chosen
            )
        elif rules.fixed[k]:
            selection.choose_greedy(
                k, rules.q, rules.p, rules.avoided, rules.sizes, self._chosen
            )
        else:
            selection.choose_roulette(
                k,
                draws,
                rules.q,
                rules.avoided,
                rules.n_penalties,
                self.settings.base_weight,
                self._chosen,
            )
        if penalties.count_selection(
            k,
            self._chosen,
            self.episode,
            rules.selections,
            rules.last_episode,
            rules.failures,
            self.settings.selection_memory,
        ):
            self._judge(k)
        self.queue.push(k, self._chosen)
        if self.settings.redraw == "episode":
            self._keep(k)
        return rules.space.alternatives_of(self._chosen)

    def advance(self, inputs: NDArray[np.float64]) -> None:
        """Move to the next state, discount, and pay p_Np on a penalty state.

        Steps 2(c)iv, vi for l = Np, vii and viii.
        """
        previous = self.state
        following = self._locate(inputs)
        if following != previous and self.rules.penalty_state[following]:
            self._penalise_transition(age=0)
        self.queue.decay(self.settings.discount)
        self.state = following

    def reward(
        self, value: float, counts: bool, whole_task: bool = True, unproved: int = 0
    ) -> None:
        """Reinforce every sub-rule in the queue (2(c)v) and fix states (Strategy 1).

        Args:
            value: rwd.
            counts: the reward raises TUC, once per state.
            whole_task: it was earned on the whole task, not on a part of it.
            unproved: the last so many decisions are passed over.
        """
        self.failures_in_a_row = 0
        rules = self.rules
        queue = self.queue
        ages = np.arange(unproved, queue.filled)
        newest_first = (queue.head - 1 - ages) % queue.length
        states = queue.states[newest_first]
        alternatives = queue.alternatives[newest_first]
        payable = queue.live[newest_first] & ~rules.fixed[states, None]
        for i in range(alternatives.shape[1]):
            paid = payable[:, i]
            k, j = states[paid], alternatives[paid, i]
            rules.q[k, i, j] += value * queue.eligibility[k, i, j]
        if counts:
            mode = self.settings.fixed_mode
            if mode.fixes == "rewarded":
                self._prefer_rewarded(value, states, alternatives)
            if mode.counted == "episode" or (
                mode.counted == "queue_then_episode" and whole_task
            ):
                chosen_in = rules.last_episode[: self.states.count]
                visited = np.flatnonzero((chosen_in == self.episode).any(axis=(1, 2)))
            else:
                visited = np.unique(states)
            rules.rewards[visited] += 1
            if mode.strategy == "strategy1":
                enough = rules.rewards[visited] >= mode.rewards_to_fix
                self._fix(visited[enough])

    def penalise(self, penalty: int, push: Push | None = None) -> None:
        """Apply p_l (0-based l < Np - 1) and the penalty rule decision (2(c)vi).

        Where the `push` is known, blame is directed (`blame.py`) instead of put on all
        of the last decisions.
        """
        self.problem.check_penalty(penalty)
        self.failures_in_a_row += 1
        reach = self.settings.failure_reach
        if push is None:
            self._pay_penalty(penalty, 0, self.settings.penalty_reach, reach)
        else:
            self._pay_penalty(penalty, 0, self.settings.penalty_reach, 0)
            reach = self._direct_blame(penalty, push)
        self._release_fixed_states()
        self._propagate_penalty_states(reach)

    def finish_episode(self) -> None:
        """Let the basis functions age; unrewarded, unvisited ones are forgotten.

        The paper's life_k (2(c)vii) is read as episodes: counted in decisions, a
        state would die within the episode that made it.
        """
        self.queue.clear()
        self.state = NO_STATE
        remaining = self.states.age(kept=self.rules.rewards[: self.states.count] > 0)
        if remaining is not None:
            self.rules.keep(remaining)

    def give_up_episode(self) -> None:
        """Become what it was before the episode began, but for the random numbers."""
        self._journal.undo(self.rules.tables())
        self.states.rewind()
        self.failures_in_a_row = self._failures_before
        self.episode -= 1
        self.queue.clear()
        self.state = NO_STATE

    def finish_subtask(self) -> None:
        """Fix every rewarded state that is no penalty state (Strategy 2, 2(c)viii)."""
        if self.settings.fixed_mode.strategy == "strategy2":
            count = self.states.count
            rewarded = np.flatnonzero(self.rules.rewards[:count] > 0)
            for k in rewarded.tolist():  # the episode may yet be given up
                self._journal.visit(k, self.rules.tables())
            self._fix(rewarded)

    # -- greedy use --------------------------------------------------------------

    def greedy(self, inputs: NDArray[np.float64]) -> NDArray[np.int64] | None:
        """Return the greedy action without learning anything, None where no state is.

        Nothing of the agent changes: no state, count or random number.
        """
        k = self.states.find(inputs, create=False)
        if k == NO_STATE:
            return None
        rules = self.rules
        selection.choose_greedy(
            k, rules.q, rules.p, rules.avoided, rules.sizes, self._chosen
        )
        return self.rules.space.alternatives_of(self._chosen)

    # -- figures -----------------------------------------------------------------

    def figures(self) -> dict[str, float]:
        """Return NB, and how many of the states are fixed or penalty states."""
        count = self.states.count
        return {
            "basis_states": count,
            "fixed_states": int(self.rules.fixed[:count].sum()),
            "penalty_states": int(self.rules.penalty_state[:count].sum()),
        }

    # -- checkpoint --------------------------------------------------------------

    def memory(self) -> Arrays:
        """Return a copy of all that was learned, as arrays; valid between episodes."""
        arrays = {
            **self.states.memory(),
            "episode": np.array(self.episode, dtype=np.int64),
            "failures_in_a_row": np.array(self.failures_in_a_row, dtype=np.int64),
        }
        for name in RuleTable.ARRAYS:
            arrays[name] = getattr(self.rules, name)[: self.states.count]
        return {name: array.copy() for name, array in arrays.items()}

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `memory` returned.

        Raises:
            ValueError: an array is missing or its shape belongs to another problem.
        """
        count = count_of_states(memory)
        check_memory(memory, self.memory(), count)
        self.states.restore(memory)
        self._make_room()
        for name in RuleTable.ARRAYS:
            getattr(self.rules, name)[:count] = memory[name]
        self.rules.clear_from(count)
        self.episode = int(memory["episode"])
        self.failures_in_a_row = int(memory["failures_in_a_row"])
        self.queue.clear()
        self.state = NO_STATE

    # -- inner steps -------------------------------------------------------------

    def _locate(self, inputs: NDArray[np.float64]) -> int:
        k = self.states.find(inputs, create=True)
        self._make_room()
        self._journal.visit(k, self.rules.tables())
        return k

    def _make_room(self) -> None:
        capacity = self.states.capacity
        self.rules.grow(capacity)
        self.queue.grow(capacity)

    def _fix(self, states: NDArray[np.int64]) -> None:
        self.rules.fixed[states] = ~self.rules.penalty_state[states]

    def _pay_penalty(
        self, penalty: int, newest: int, p_reach: int, failure_reach: int
    ) -> None:
        """Raise P and the failure counts of decisions from the age `newest` back."""
        queue, rules = self.queue, self.rules
        penalties.add_penalty(
            penalty,
            self.problem.penalty_values[penalty],
            newest,
            min(newest + p_reach, queue.filled),
            queue.head,
            queue.states,
            queue.alternatives,
            queue.live,
            queue.eligibility,
            rules.p,
        )
        penalties.count_failures(
            penalty,
            newest,
            min(newest + failure_reach, queue.filled),
            self.episode,
            queue.head,
            queue.states,
            queue.alternatives,
            rules.failures,
            rules.last_failure,
        )

    def _keep(self, k: int) -> None:
        """Let state k keep to what it chose.

        In normal mode no penalty sub-rule is kept: the choice may just have become one.
        """
        rules = self.rules
        avoided = rules.avoided[k, np.arange(len(self._chosen)), self._chosen]
        if rules.penalty_state[k] or (avoided == rules.n_penalties).all():
            self._kept[k] = self._chosen.copy()

    def _prefer_rewarded(
        self, value: float, states: NDArray[np.int64], alternatives: NDArray[np.int64]
    ) -> None:
        """Raise what normal states did last to their largest Q.

        Without it, a success by chance fixes them to something else, which was rewarded
        more often with other states behind it: the walk is not repeated.

        Args:
            value: rwd.
            states: (n,) rewarded, newest decision first.
            alternatives: (n, I) that they chose.
        """
        rules = self.rules
        k, newest = np.unique(states, return_index=True)
        k, newest = k[~rules.fixed[k]], newest[~rules.fixed[k]]
        for i in range(alternatives.shape[1]):
            j = alternatives[newest, i]
            best = rules.q[k, i].max(axis=1)
            behind = rules.q[k, i, j] < best
            rules.q[k[behind], i, j[behind]] = best[behind] + value

    def _direct_blame(self, penalty: int, push: Push) -> int:
        """Count a failure for what pushed to it; return how many decisions could."""
        queue, rules = self.queue, self.rules
        reach = min(len(push), queue.filled)
        newest_first = (queue.head - 1 - np.arange(reach)) % queue.length
        for k, i, no_better in blame.directed(
            push[:reach],
            queue.states[newest_first],
            queue.alternatives[newest_first],
            rules.sizes,
            self.settings.blame_share,
        ):
            n = rules.sizes[i]
            blame.count_trials(
                rules.selections[k, i, :n],
                rules.last_episode[k, i, :n],
                rules.failures[k, :, i, :n],
                self.episode,
                self.settings.selection_memory,
            )
            fails = no_better & (rules.last_failure[k, penalty, i, :n] != self.episode)
            rules.failures[k, penalty, i, :n][fails] += 1
            rules.last_failure[k, penalty, i, :n][fails] = self.episode
        return reach

    def _penalise_transition(self, age: int) -> None:
        """Pay p_Np to the decision of this age, which led to a penalty state."""
        self._pay_penalty(self.rules.n_penalties - 1, age, 1, 1)
        self._judge(self._state_of_age(age))

    def _judge(self, k: int) -> bool:
        """Judge state k anew; return whether it has just become a penalty state."""
        rules = self.rules
        before = bool(rules.penalty_state[k])
        rules.penalty_state[k] = penalties.judge_state(
            k,
            rules.failures,
            rules.selections,
            self.settings.minimum_selections,
            self.settings.failure_threshold,
            rules.sizes,
            rules.avoided,
        )
        if rules.penalty_state[k]:
            rules.fixed[k] = False
        self._kept.pop(k, None)  # it may be a penalty sub-rule now
        return bool(rules.penalty_state[k]) and not before

    def _propagate_penalty_states(self, reach: int) -> None:
        """Penalty rule decision (PRD): follow new penalty states back in the queue.

        A rule that leads to a new penalty state is penalised with p_Np, which can
        make its own state a penalty state, and so on. A state that only leads to
        itself is passed over.
        """
        new = {k for k in self._states_of_ages(reach) if self._judge(k)}
        for age in range(self.queue.filled - 1):
            k, origin = self._state_of_age(age), self._state_of_age(age + 1)
            if k in new and origin != k:
                known = bool(self.rules.penalty_state[origin])
                self._penalise_transition(age + 1)
                if self.rules.penalty_state[origin] and not known:
                    new.add(origin)

    def _release_fixed_states(self) -> None:
        """Return up to three fixed states ahead of the penalty to normal mode.

        Where the fixed states themselves lead to the failure, the last decisions may
        be in normal states every time, and nothing would ever be released: when
        patience ends, the nearest fixed states are. If that does not help, the next
        ones behind them follow, since those released stay normal until rewarded.
        """
        mode = self.settings.fixed_mode
        rules = self.rules
        impatient = (
            mode.patience_episodes > 0
            and self.failures_in_a_row % mode.patience_episodes == 0
        )
        nearest = mode.release == "nearest" or impatient
        reach = self.queue.filled if nearest else mode.released_states
        nearest_first = self._states_of_ages(reach)
        fixed = [k for k in nearest_first if rules.fixed[k]][: mode.released_states]
        rules.fixed[fixed] = False
        rules.rewards[fixed] = 0

    def _state_of_age(self, age: int) -> int:
        return int(self.queue.states[(self.queue.head - 1 - age) % self.queue.length])

    def _states_of_ages(self, reach: int) -> list[int]:
        """Distinct states of the last `reach` decisions, newest first."""
        ages = range(min(reach, self.queue.filled))
        return list(dict.fromkeys(self._state_of_age(age) for age in ages))
