"""The learner does, to the last bit, what a slow and simple one does."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from tests.learner_node.naive_xol import NaiveXol
from tests.learner_node.xol.random_episodes import Case, runs, seeded_calls
from tests.thorough import first_always

from learner_node.problem import ActionSpace, Problem
from learner_node.states import StateSettings
from learner_node.xol.settings import FixedModeSettings, XolSettings


def padded(rows, table):
    """Rows of components that differ in size, with zeros up to the table's width."""
    if table.ndim < 3:
        return rows
    full = np.zeros((len(rows), *table.shape[1:]))
    for place in np.ndindex(full.shape[:-1]):
        values = rows
        for index in place:
            values = values[index]
        full[place][: len(values)] = values
    return full


def differences(agent, naive):
    """Names of what the two hold differently."""
    count = len(naive.states)
    if agent.states.count != count:
        return [f"{agent.states.count} states, not {count}"]
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
        if count and not np.array_equal(array[:count], padded(rows, array))
    ]
    if agent.failures_in_a_row != naive.failures_in_a_row:
        found.append("failures in a row")
    if agent.queue.eligibility[count:].any():
        found.append("E of no state")
    return found


def first_disagreement(case, calls):
    """Feed both with the calls; return where and how they part, None if never."""
    agent, naive = case.learner(), case.learner(NaiveXol)
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
    "uniform": BASE,
    "components of different size": BASE,
}


def long_run(name, seed):
    basis = "uniform" if name == "uniform" else "gaussian"
    alternatives = (2, 4) if name == "components of different size" else (2, 2)
    case = Case(
        LONG_RUNS[name],
        StateSettings(basis=basis, life_episodes=8),
        Problem(1, (1.0,), ActionSpace(alternatives), (10.0, 3.0, 0.3)),
        seed,
    )
    return case, seeded_calls(case, np.random.default_rng(seed))


@pytest.mark.parametrize("seed", first_always(range(3)))
@pytest.mark.parametrize("name", LONG_RUNS)
def test_long_runs_end_in_the_same_memory(name, seed):
    assert first_disagreement(*long_run(name, seed)) is None


def run_of_many_states():
    problem = Problem(2, (1.0,) * 3, ActionSpace((3, 3)), (10.0, 3.0, 0.3))
    case = Case(BASE, StateSettings(life_episodes=30), problem, seed=0)
    return case, seeded_calls(case, np.random.default_rng(0), n_points=150)


@pytest.mark.thorough
def test_more_states_than_first_fit_end_in_the_same_memory():
    assert first_disagreement(*run_of_many_states()) is None


def test_the_run_of_many_states_has_more_than_first_fit():
    case, calls = run_of_many_states()
    agent = case.learner()
    room = agent.states.capacity
    for method, arguments in calls:
        getattr(agent, method)(*arguments)
    assert agent.states.count > room


def incidents(case, calls):
    """Kinds of things that happen to an agent in these calls."""
    agent = case.learner()
    seen = set()
    for method, arguments in calls:
        before = agent.figures()
        if method == "choose" and agent.rules.penalty_state[agent.state]:
            seen.add("choice in a penalty state")
        if method == "choose" and agent.rules.fixed[agent.state]:
            seen.add("choice in a fixed state")
        paid = agent.rules.p[:, -1].sum()
        getattr(agent, method)(*arguments)
        after = agent.figures()
        if after["basis_states"] < before["basis_states"]:
            seen.add("a state is forgotten")
        if method == "reward" and after["fixed_states"] > before["fixed_states"]:
            seen.add("a state becomes fixed")
        if method == "penalise" and after["fixed_states"] < before["fixed_states"]:
            seen.add("a fixed state is released")
        if after["penalty_states"] < before["penalty_states"] and method == "choose":
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
