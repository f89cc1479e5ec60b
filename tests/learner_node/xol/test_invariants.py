"""What holds in every random episode."""

from dataclasses import replace

import numpy as np
from hypothesis import HealthCheck, given, settings
from tests.learner_node.xol.random_episodes import runs

each_run = settings(
    deadline=None, max_examples=40, suppress_health_check=[HealthCheck.too_slow]
)


def call(agent, step):
    method, arguments = step
    return getattr(agent, method)(*arguments)


def rules_in_use(agent, name):
    return getattr(agent.rules, name)[: agent.states.count]


@each_run
@given(run=runs())
def test_a_normal_state_gets_no_penalty_sub_rule(run):
    case, calls = run
    agent, rules = case.learner(), case.settings
    for step in calls:
        k = agent.state
        if step[0] == "choose":
            failures = agent.rules.failures[k].copy()
            n = agent.rules.selections[k].copy()
            normal = not agent.rules.penalty_state[k]
        call(agent, step)
        if step[0] == "choose" and normal:
            tried = n >= rules.minimum_selections
            forbidden = tried & (failures > rules.failure_threshold * n).any(axis=0)
            chosen = agent.queue.alternatives[agent.queue.head - 1]
            assert not forbidden[np.arange(len(chosen)), chosen].any()


@each_run
@given(run=runs())
def test_eligibility_and_weights_are_never_negative(run):
    case, calls = run
    agent = case.learner()
    for step in calls:
        call(agent, step)
        for array in (agent.queue.eligibility, agent.rules.q, agent.rules.p):
            assert array.min() >= 0.0


@each_run
@given(run=runs())
def test_a_reward_adds_its_value_times_eligibility_to_normal_states_only(run):
    case, calls = run
    best = replace(case.settings.fixed_mode, fixes="best")
    agent = replace(case, settings=replace(case.settings, fixed_mode=best)).learner()
    for step in calls:
        before = rules_in_use(agent, "q").copy()
        normal = ~rules_in_use(agent, "fixed")[:, None, None]
        eligibility = agent.queue.eligibility[: len(before)].copy()
        call(agent, step)
        if step[0] == "reward" and not step[1][3]:
            value = step[1][0]
            after = rules_in_use(agent, "q")
            assert np.array_equal(after, before + value * eligibility * normal)


@each_run
@given(run=runs())
def test_only_rewards_change_weights(run):
    case, calls = run
    agent = case.learner()
    for step in calls:
        before = rules_in_use(agent, "q").copy()
        call(agent, step)
        # New states come last; forgotten ones leave at the end of an episode.
        if step[0] not in ("reward", "finish_episode"):
            assert np.array_equal(rules_in_use(agent, "q")[: len(before)], before)


@each_run
@given(run=runs())
def test_no_state_is_both_fixed_and_a_penalty_state(run):
    case, calls = run
    agent = case.learner()
    for step in calls:
        call(agent, step)
        both = rules_in_use(agent, "fixed") & rules_in_use(agent, "penalty_state")
        assert not both.any()


@each_run
@given(run=runs())
def test_a_sub_rule_fails_in_no_more_episodes_than_it_is_chosen_in(run):
    case, calls = run
    agent = case.learner()
    for step in calls:
        call(agent, step)
        n = rules_in_use(agent, "selections")
        assert (rules_in_use(agent, "failures") <= n[:, None]).all()
        assert n.max(initial=0) <= agent.episode


@each_run
@given(run=runs())
def test_forgetting_spares_rewarded_states(run):
    case, calls = run
    agent = case.learner()
    for step in calls:
        rewarded = rules_in_use(agent, "rewards") > 0
        before = agent.states.centers[: agent.states.count][rewarded].copy()
        call(agent, step)
        if step[0] == "finish_episode":
            still = rules_in_use(agent, "rewards") > 0
            after = agent.states.centers[: agent.states.count][still]
            assert np.array_equal(after, before)
