"""The learner of Section 3, written down slowly: lists, loops and a dense E.

Nothing is stored that can be worked out anew: whether a sub-rule is a penalty sub-rule,
and whether a state is a penalty state, follows from the counters each time it is asked.
`XolAgent` must agree with this to the last bit, so sums run in the same order there.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from learner_node.problem import Problem
from learner_node.states import StateSettings
from learner_node.xol.settings import XolSettings


@dataclass(eq=False)
class State:
    """One s_k with all that is known of it."""

    discrete: list
    center: list
    life: int
    Q: list  # [component][alternative]
    E: list
    selections: list
    P: list  # [penalty][component][alternative]
    failures: list
    TUC: int = 0
    fixed: bool = False
    selected: set = field(default_factory=set)  # sub-rules, in this episode
    failed: set = field(default_factory=set)  # (penalty, sub-rule), in this episode


@dataclass(eq=False)
class Decision:
    """One place of the queue."""

    state: State
    chosen: list  # alternative per component
    discarded: list  # per component: the sub-rule was chosen again since


class NaiveXol:
    """Answers the same calls as `XolAgent`."""

    def __init__(
        self,
        settings: XolSettings,
        states: StateSettings,
        problem: Problem,
        rng: np.random.Generator,
    ):
        self.settings = settings
        self.basis = states
        self.problem = problem
        self.penalty_values = problem.penalty_values
        self.rng = rng
        self.states: list[State] = []
        self.queue: list[Decision] = []  # newest last
        self.state = None
        self.failures_in_a_row = 0
        self.sizes = list(problem.space.alternatives)
        if not settings.decomposed:
            self.sizes = [math.prod(self.sizes)]
        self.components = len(self.sizes)

    # -- Section 2: states ---------------------------------------------------------

    def locate(self, inputs, create):
        states, n_discrete = self.basis, self.problem.n_discrete
        discrete = [float(x) for x in inputs[:n_discrete]]
        point = [
            float(x) / r
            for x, r in zip(inputs[n_discrete:], self.problem.radii, strict=True)
        ]
        if states.basis == "uniform":
            point = [float(round(x)) for x in point]
        best, best_squared = None, math.inf
        for state in self.states:
            if state.discrete != discrete:
                continue
            squared = 0.0
            for c, x in zip(state.center, point, strict=True):
                squared += (c - x) * (c - x)
            if squared < best_squared:
                best, best_squared = state, squared
        if not create:
            return best
        if states.basis == "uniform":
            covered = best_squared == 0.0
        else:
            covered = math.exp(-0.5 * best_squared) >= states.activation_threshold
        if not covered:
            best = State(
                discrete=discrete,
                center=point,
                life=0,
                Q=self.table(0.0),
                E=self.table(0.0),
                selections=self.table(0),
                P=[self.table(0.0) for _ in self.penalty_values],
                failures=[self.table(0) for _ in self.penalty_values],
            )
            self.states.append(best)
        best.life = states.life_episodes
        return best

    def table(self, value):
        return [[value] * size for size in self.sizes]

    # -- Section 3.4: penalty sub-rules and penalty states -------------------------

    def is_penalty_subrule(self, state, penalty, i, j):
        n = state.selections[i][j]
        often_enough = n >= self.settings.minimum_selections
        threshold = self.settings.failure_threshold
        return often_enough and state.failures[penalty][i][j] > threshold * n

    def avoiding(self, state, i, count):
        """Abar_i(l): alternatives that are no penalty sub-rules for p_1, ..., p_l."""
        return [
            j
            for j in range(self.sizes[i])
            if not any(self.is_penalty_subrule(state, p, i, j) for p in range(count))
        ]

    def is_penalty_state(self, state):
        every = len(self.penalty_values)
        return any(not self.avoiding(state, i, every) for i in range(self.components))

    # -- Section 3.5: selection ----------------------------------------------------

    def choose(self):
        state = self.state
        if state in self.kept:
            self.put_in_queue(state, self.kept[state])
            return self.action_of(self.kept[state])
        draws = self.rng.random(self.components)
        chosen = []
        for i in range(self.components):
            if self.is_penalty_state(state):
                chosen.append(self.ranked(state, i, draws[i]))
            elif state.fixed:
                chosen.append(self.greediest(state, i))
            else:
                chosen.append(self.roulette(state, i, draws[i]))
        for i, j in enumerate(chosen):
            self.count_selection(state, i, j)
        if self.is_penalty_state(state):
            state.fixed = False
        every = range(len(self.penalty_values))
        allowed = self.is_penalty_state(state) or not any(
            self.is_penalty_subrule(state, p, i, j)
            for p in every
            for i, j in enumerate(chosen)
        )
        if allowed and self.settings.redraw == "episode":
            self.kept[state] = chosen
        self.put_in_queue(state, chosen)
        return self.action_of(chosen)

    def count_selection(self, state, i, j):
        if (i, j) not in state.selected:
            state.selected.add((i, j))
            if 0 < self.settings.selection_memory <= state.selections[i][j]:
                state.selections[i][j] //= 2
                for failures in state.failures:
                    failures[i][j] //= 2
            state.selections[i][j] += 1

    def roulette(self, state, i, draw):
        candidates = self.avoiding(state, i, len(self.penalty_values))
        total = 0.0
        for j in candidates:
            total += state.Q[i][j] + self.settings.base_weight
        mark = draw * total
        for j in candidates:
            mark -= state.Q[i][j] + self.settings.base_weight
            if mark < 0.0:
                return j
        return candidates[-1]

    def greediest(self, state, i):
        middle = (self.sizes[i] - 1) / 2
        best = None
        for j in self.last_non_empty(state, i) or range(self.sizes[i]):
            worth = (state.Q[i][j], -self.summed_P(state, i, j), -abs(j - middle))
            if best is None or worth > best[0]:
                best = worth, j
        return best[1]

    def ranked(self, state, i, draw):
        candidates = self.last_non_empty(state, i)
        if not candidates:
            return int(draw * self.sizes[i])
        candidates.sort(key=lambda j: self.summed_P(state, i, j))  # sort() is stable
        n = len(candidates)
        mark = draw * (n * (n + 1) // 2)
        for rank, j in enumerate(candidates, start=1):
            mark -= n - rank + 1
            if mark < 0.0:
                return j
        return candidates[-1]

    def last_non_empty(self, state, i):
        """Abar_i(l) for the largest l at which it is not empty; [] if there is none."""
        for count in range(len(self.penalty_values), 0, -1):
            candidates = self.avoiding(state, i, count)
            if candidates:
                return candidates
        return []

    def summed_P(self, state, i, j):  # noqa: N802
        total = 0.0
        for P in state.P:
            total += P[i][j]
        return total

    def action_of(self, chosen):
        if self.settings.decomposed:
            return list(chosen)
        digits, rest = [], chosen[0]
        for size in reversed(self.problem.space.alternatives):
            digits.insert(0, rest % size)
            rest //= size
        return digits

    # -- Section 3.2: queue and eligibility ----------------------------------------

    def put_in_queue(self, state, chosen):
        if len(self.queue) == self.settings.queue_length:
            oldest = self.queue.pop(0)
            for i, j in enumerate(oldest.chosen):
                if not oldest.discarded[i]:
                    oldest.state.E[i][j] = 0.0
        for older in self.queue:
            if older.state is state:
                for i, j in enumerate(chosen):
                    if older.chosen[i] == j:
                        older.discarded[i] = True
        for i, j in enumerate(chosen):
            state.E[i][j] += 1.0
        self.queue.append(Decision(state, chosen, [False] * self.components))

    def last_decisions(self, count):
        """Newest first."""
        return self.queue[::-1][:count]

    def last_states(self, count):
        """Distinct states of the last decisions, newest first."""
        return list(dict.fromkeys(d.state for d in self.last_decisions(count)))

    # -- Section 3.6 ---------------------------------------------------------------

    def begin_episode(self, inputs):
        self.empty_queue()
        self.kept = {}
        for state in self.states:
            state.selected.clear()
            state.failed.clear()
        self.state = self.locate(inputs, create=True)

    def empty_queue(self):
        self.queue.clear()
        for state in self.states:
            state.E = self.table(0.0)

    def advance(self, inputs):
        following = self.locate(inputs, create=True)
        if following is not self.state and self.is_penalty_state(following):
            self.pay_for_transition(self.queue[-1])
        for state in self.states:
            for i in range(self.components):
                for j in range(self.sizes[i]):
                    state.E[i][j] *= self.settings.discount
        self.state = following

    def reward(self, value, counts, whole_task=True, unproved=0):
        self.failures_in_a_row = 0
        proved = self.queue[: max(0, len(self.queue) - unproved)]
        for decision in proved:
            if not decision.state.fixed:
                for i, j in enumerate(decision.chosen):
                    if not decision.discarded[i]:
                        decision.state.Q[i][j] += value * decision.state.E[i][j]
        if counts:
            mode = self.settings.fixed_mode
            if mode.fixes == "rewarded":
                last = {decision.state: decision for decision in proved}
                for state, decision in last.items():
                    for i, j in enumerate(decision.chosen):
                        if not state.fixed and state.Q[i][j] < max(state.Q[i]):
                            state.Q[i][j] = max(state.Q[i]) + value
            every = mode.counted == "queue_then_episode" and whole_task
            if every or mode.counted == "episode":
                visited = [state for state in self.states if state.selected]
            else:
                visited = list(dict.fromkeys(d.state for d in proved))
            for state in visited:
                state.TUC += 1
                enough = mode.rewards_to_fix <= state.TUC
                if mode.strategy == "strategy1" and enough:
                    state.fixed = not self.is_penalty_state(state)

    def penalise(self, penalty, push=None):
        self.failures_in_a_row += 1
        settings = self.settings
        reach = settings.failure_reach if push is None else len(push)
        blamed = self.last_states(reach)
        known = {state for state in self.states if self.is_penalty_state(state)}
        for decision in self.last_decisions(settings.penalty_reach):
            self.raise_P(decision, penalty)
        if push is None:
            for decision in self.last_decisions(settings.failure_reach):
                self.count_failure(decision, penalty)
        else:
            self.direct_blame(penalty, push)
        self.release()
        new = {s for s in blamed if self.is_penalty_state(s) and s not in known}
        for state in blamed:
            self.kept.pop(state, None)
            if self.is_penalty_state(state):
                state.fixed = False
        # PRD: back along the queue, from each decision to the one that led to it.
        for place in range(len(self.queue) - 1, 0, -1):
            led_to, decision = self.queue[place].state, self.queue[place - 1]
            if led_to in new and decision.state is not led_to:
                before = self.is_penalty_state(decision.state)
                self.pay_for_transition(decision)
                if self.is_penalty_state(decision.state) and not before:
                    new.add(decision.state)

    def direct_blame(self, penalty, push):
        """All alternatives are tried, and those no milder than what failed fail."""
        pushed, chose = {}, {}
        for age, decision in enumerate(self.last_decisions(len(push))):
            for i, effect in enumerate(push[age]):
                key = decision.state, i
                pushed[key] = pushed.get(key, 0.0) + effect
                chose.setdefault(key, []).append(decision.chosen[i])
        strongest = max(map(abs, pushed.values()), default=0.0)
        for (state, i), effect in pushed.items():
            if effect == 0.0 or abs(effect) < self.settings.blame_share * strongest:
                continue
            for j in range(self.sizes[i]):
                self.count_selection(state, i, j)
                mildest = min(chose[state, i]) if effect > 0 else max(chose[state, i])
                fails = (j >= mildest) if effect > 0 else (j <= mildest)
                if fails and (penalty, i, j) not in state.failed:
                    state.failed.add((penalty, i, j))
                    state.failures[penalty][i][j] += 1

    def release(self):
        mode = self.settings.fixed_mode
        patience = mode.patience_episodes
        impatient = patience > 0 and self.failures_in_a_row % patience == 0
        if mode.release == "nearest" or impatient:
            fixed = [s for s in self.last_states(len(self.queue)) if s.fixed]
            fixed = fixed[: mode.released_states]
        else:
            fixed = [s for s in self.last_states(mode.released_states) if s.fixed]
        for state in fixed:
            state.fixed = False
            state.TUC = 0

    def pay_for_transition(self, decision):
        """p_Np, to the decision that led to a penalty state."""
        additional = len(self.penalty_values) - 1
        self.raise_P(decision, additional)
        self.count_failure(decision, additional)
        self.kept.pop(decision.state, None)
        if self.is_penalty_state(decision.state):
            decision.state.fixed = False

    def raise_P(self, decision, penalty):  # noqa: N802
        """Eq. (1)."""
        state = decision.state
        for i, j in enumerate(decision.chosen):
            if not decision.discarded[i]:
                state.P[penalty][i][j] += self.penalty_values[penalty] * state.E[i][j]

    def count_failure(self, decision, penalty):
        state = decision.state
        for i, j in enumerate(decision.chosen):
            if (penalty, i, j) not in state.failed:
                state.failed.add((penalty, i, j))
                state.failures[penalty][i][j] += 1

    def finish_subtask(self):
        if self.settings.fixed_mode.strategy == "strategy2":
            for state in self.states:
                if state.TUC > 0:
                    state.fixed = not self.is_penalty_state(state)

    def finish_episode(self):
        self.empty_queue()
        self.state = None
        for state in self.states:
            state.life -= 1
        self.states = [s for s in self.states if s.life >= 0 or s.TUC > 0]

    def greedy(self, inputs):
        state = self.locate(inputs, create=False)
        if state is None:
            return None
        return self.action_of(
            [self.greediest(state, i) for i in range(self.components)]
        )
