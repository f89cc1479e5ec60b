"""Random problems, and random calls to a learner that follow the order of an episode.

A call is a pair (method, arguments). Inputs come from a handful of points, so that
states repeat.
"""

from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st

from learner_node.problem import ActionSpace, Problem
from learner_node.states import StateSettings
from learner_node.xol.agent import XolAgent
from learner_node.xol.settings import FixedModeSettings, XolSettings

# Differences of these never add up to a squared distance of 1, where a basis function
# of width 1 ends.
CONTINUOUS = (0.0, 0.4, 1.5, 3.0)
DISCRETE = (-10.0, 10.0)
PENALTY_VALUES = (10.0, 3.0, 0.3, 7.0)
REWARDS = (10_000.0, 10.0, 0.1)


RADII = (1.0, 0.7, 2.0)


@dataclass(frozen=True)
class Case:
    """What a learner is made for, and from."""

    settings: XolSettings
    states: StateSettings
    problem: Problem
    seed: int

    def learner(self, kind=XolAgent):
        return kind(
            self.settings,
            self.states,
            self.problem,
            np.random.default_rng(self.seed),
        )


@st.composite
def cases(draw):
    n_continuous = draw(st.integers(0, 3))
    decomposed = draw(st.booleans())
    queue_length = draw(st.integers(1, 8))
    minimum_selections = draw(st.integers(1, 3))
    settings = XolSettings(
        discount=draw(st.sampled_from((0.8, 0.98, 1.0))),
        queue_length=queue_length,
        penalty_reach=draw(st.integers(1, 4)),
        failure_reach=draw(st.integers(1, queue_length)),
        minimum_selections=minimum_selections,
        selection_memory=draw(st.sampled_from((0, 2, 3))) * minimum_selections,
        failure_threshold=draw(st.sampled_from((0.0, 0.3, 0.5, 1.0))),
        base_weight=draw(st.sampled_from((0.5, 100.0))),
        decomposed=decomposed,
        redraw=draw(st.sampled_from(("decision", "episode"))),
        blame_share=draw(st.sampled_from((0.0, 0.5))),
        fixed_mode=FixedModeSettings(
            fixes=draw(st.sampled_from(("best", "rewarded"))),
            strategy=draw(st.sampled_from(("strategy1", "strategy2", "none"))),
            rewards_to_fix=draw(st.integers(1, 3)),
            counted=draw(st.sampled_from(("queue", "episode", "queue_then_episode"))),
            released_states=draw(st.integers(0, 3)),
            patience_episodes=draw(st.integers(0, 3)),
            release=draw(st.sampled_from(("last_decisions", "nearest"))),
        ),
    )
    sizes = st.integers(2, 5 if decomposed else 3)
    alternatives = draw(st.lists(sizes, min_size=1, max_size=3 if decomposed else 2))
    states = StateSettings(
        basis=draw(st.sampled_from(("gaussian", "uniform"))),
        life_episodes=draw(st.integers(1, 4)),
    )
    problem = Problem(
        n_discrete=draw(st.integers(0, 2)),
        radii=RADII[:n_continuous],
        space=ActionSpace(tuple(alternatives)),
        penalty_values=PENALTY_VALUES[: draw(st.integers(2, 4))],
    )
    return Case(settings, states, problem, seed=draw(st.integers(0, 2**16)))


def pushes(components):
    """Push by age and component, of sums that are exact."""
    effects = st.sampled_from((-2.0, -1.0, 0.0, 0.5, 1.0))
    rows = st.lists(effects, min_size=components, max_size=components)
    return st.lists(rows, min_size=1, max_size=6).map(np.array)


@st.composite
def runs(draw, max_episodes=12, max_steps=8):
    """A case and the calls of some episodes."""
    case = draw(cases())
    problem = case.problem
    point = st.tuples(
        *[st.sampled_from(DISCRETE)] * problem.n_discrete,
        *[st.sampled_from(CONTINUOUS)] * len(problem.radii),
    ).map(np.array)
    points = draw(st.lists(point, min_size=1, max_size=5))
    ends = st.one_of(
        st.tuples(
            st.just("reward"),
            st.tuples(
                st.sampled_from(REWARDS),
                st.booleans(),
                st.booleans(),
                st.sampled_from((0, 0, 1, 3)),
            ),
        ),
        st.tuples(
            st.just("penalise"),
            st.tuples(
                st.integers(0, len(problem.penalty_values) - 2),
                st.none() | pushes(len(case.problem.space.alternatives))
                if case.settings.decomposed
                else st.none(),
            ),
        ),
    )
    calls = []
    for _ in range(draw(st.integers(1, max_episodes))):
        for step in range(draw(st.integers(1, max_steps))):
            inputs = draw(st.sampled_from(points))
            if step > 0 and draw(st.integers(0, 9)) == 0:
                calls.append(draw(ends))
            calls.append(("advance" if step else "begin_episode", (inputs,)))
            calls.append(("choose", ()))
        if draw(st.integers(0, 9)) > 0:
            calls.append(draw(ends))
        if draw(st.integers(0, 3)) == 0:
            calls.append(("finish_subtask", ()))
        calls.append(("finish_episode", ()))
        calls.append(("greedy", (draw(st.sampled_from(points)),)))
    return case, calls


def seeded_calls(case, rng, episodes=200, steps=12, n_points=7):
    """Calls of many episodes, a cheaper source than `runs`.

    The points follow one another with few exceptions, so that chains of states repeat;
    spells of failures alternate with spells of rewards, and one point is rare.
    """
    problem = case.problem
    points = np.column_stack(
        [rng.choice(DISCRETE, n_points) for _ in range(problem.n_discrete)]
        + [rng.choice(CONTINUOUS, n_points) for _ in range(len(problem.radii))]
    )
    rare = np.full(points.shape[1], DISCRETE[0])
    for episode in range(episodes):
        place = int(rng.integers(n_points))
        for step in range(int(rng.integers(1, steps))):
            inputs = rare if rng.random() < 0.01 else points[place]
            yield "advance" if step else "begin_episode", (inputs,)
            yield "choose", ()
            place = (place + (1 if rng.random() < 0.8 else 2)) % n_points
        if rng.random() < (0.9 if episode % 50 < 25 else 0.1):
            yield "penalise", (int(rng.integers(len(problem.penalty_values) - 1)),)
        else:
            value, counts = float(rng.choice(REWARDS)), bool(rng.random() < 0.7)
            yield "reward", (value, counts, episode >= 100)
        if rng.random() < 0.3:
            yield "finish_subtask", ()
        yield "finish_episode", ()
        yield "greedy", (points[int(rng.integers(n_points))],)
