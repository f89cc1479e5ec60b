"""The learner does, to the last bit, what a slow and simple one does."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from tests.learner_node.naive_xol import NaiveXol
from tests.learner_node.xol.random_episodes import Problem, runs, seeded_calls

from learner_node.xol.rules import ActionSpace
from learner_node.xol.settings import FixedModeSettings, StateSettings, XolSettings


def differences(agent, naive):
    """Names of what the two hold differently."""
    count = len(naive.states)
    if agent.basis_states != count:
        return [f"{agent.basis_states} states, not {count}"]
    rules = agent.rules
    pairs = {
        "discrete": (agent.states.discrete, [s.discrete for s in naive.states]),
        "centers": (agent.states.centers, [s.center for s in naive.states]),
        "life": (agent.states.life, [s.life for s in naive.states]),
        "Q": (rules.q, [s.Q for s in naive.states]),
        "P": (rules.p, [s.P for s in naive.states]),
        "E": (agent.queue.eligibility, [s.E for s in naive.states]),
        "selections": (rules.selections, [s.selections for s in naive.states]),
        "failures": (rules.failures, [s.failures for s in naive.states]),
        "TUC": (rules.rewards, [s.TUC for s in naive.states]),
        "fixed": (rules.fixed, [s.fixed for s in naive.states]),
        "penalty states": (
            rules.penalty_state,
            [naive.is_penalty_state(s) for s in naive.states],
        ),
    }
    found = [
        name
        for name, (array, rows) in pairs.items()
        if count and not np.array_equal(array[:count], rows)
    ]
    if agent.failures_in_a_row != naive.failures_in_a_row:
        found.append("failures in a row")
    if agent.queue.eligibility[count:].any():
        found.append("E of no state")
    return found


def first_disagreement(problem, calls):
    """Feed both with the calls; return where and how they part, None if never."""
    agent, naive = problem.learner(), problem.learner(NaiveXol)
    for place, (method, arguments) in enumerate(calls):
        answer = getattr(agent, method)(*arguments)
        expected = getattr(naive, method)(*arguments)
        if answer is None or expected is None:
            same = answer is expected
        else:
            same = answer.tolist() == expected
        if not same:
            return place, method, answer, expected
        found = differences(agent, naive)
        if found:
            return place, method, found
    return None


@settings(deadline=None, max_examples=120, suppress_health_check=[HealthCheck.too_slow])
@given(run=runs())
def test_random_episodes_end_in_the_same_memory(run):
    assert first_disagreement(*run) is None


def with_fixed_mode(**changes):
    return replace(BASE, fixed_mode=replace(BASE.fixed_mode, **changes))


BASE = XolSettings(
    discount=0.9,
    queue_length=9,
    failure_reach=4,
    minimum_selections=3,
    selection_memory=0,
    failure_threshold=0.5,
    base_weight=2.0,
    states=StateSettings(radii=(1.0,), life_episodes=8),
    fixed_mode=FixedModeSettings(
        rewards_to_fix=2, counted="queue", patience_episodes=0
    ),
)
LONG_RUNS = {
    "strategy1": BASE,
    "strategy2": with_fixed_mode(strategy="strategy2"),
    "none": with_fixed_mode(strategy="none"),
    "nearest": with_fixed_mode(release="nearest"),
    "episode": with_fixed_mode(counted="episode"),
    "queue then episode": with_fixed_mode(counted="queue_then_episode"),
    "forgetful": replace(BASE, selection_memory=7),
    "impatient": with_fixed_mode(patience_episodes=2),
    "undecomposed": replace(BASE, decomposed=False),
    "uniform": replace(BASE, states=replace(BASE.states, basis="uniform")),
}


def long_run(name, seed):
    problem = Problem(LONG_RUNS[name], ActionSpace(2, 2), 1, 1, 3, seed)
    return problem, seeded_calls(problem, np.random.default_rng(seed))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", LONG_RUNS)
def test_long_runs_end_in_the_same_memory(name, seed):
    assert first_disagreement(*long_run(name, seed)) is None


def run_of_many_states():
    many = replace(BASE, states=StateSettings(radii=(1.0,) * 3, life_episodes=30))
    problem = Problem(many, ActionSpace(2, 3), 2, 3, 3, seed=0)
    calls = seeded_calls(problem, np.random.default_rng(0), n_points=150)
    return problem, calls


def test_more_states_than_first_fit_end_in_the_same_memory():
    assert first_disagreement(*run_of_many_states()) is None


def test_the_run_of_many_states_has_more_than_first_fit():
    problem, calls = run_of_many_states()
    agent = problem.learner()
    room = agent.states.capacity
    for method, arguments in calls:
        getattr(agent, method)(*arguments)
    assert agent.basis_states > room


def incidents(problem, calls):
    """Kinds of things that happen to an agent in these calls."""
    agent = problem.learner()
    seen = set()
    for method, arguments in calls:
        states, fixed = agent.basis_states, agent.fixed_states
        penalty_states = agent.penalty_states
        if method == "choose" and agent.rules.penalty_state[agent.state]:
            seen.add("choice in a penalty state")
        if method == "choose" and agent.rules.fixed[agent.state]:
            seen.add("choice in a fixed state")
        paid = agent.rules.p[:, -1].sum()
        getattr(agent, method)(*arguments)
        if agent.basis_states < states:
            seen.add("a state is forgotten")
        if method == "reward" and agent.fixed_states > fixed:
            seen.add("a state becomes fixed")
        if method == "penalise" and agent.fixed_states < fixed:
            seen.add("a fixed state is released")
        if agent.penalty_states < penalty_states and method == "choose":
            seen.add("a penalty state recovers")
        if agent.rules.p[:, -1].sum() > paid:
            seen.add(f"p_Np is paid by {method}")
    return seen


def test_long_runs_meet_every_kind_of_incident():
    assert incidents(*long_run("strategy1", 0)) == {
        "choice in a penalty state",
        "choice in a fixed state",
        "a state is forgotten",
        "a state becomes fixed",
        "a fixed state is released",
        "a penalty state recovers",
        "p_Np is paid by advance",
        "p_Np is paid by penalise",
    }
