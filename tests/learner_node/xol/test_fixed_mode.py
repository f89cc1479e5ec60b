"""Rewards and fixed-mode states (Sections 3.2 and 3.3)."""

import numpy as np
import pytest
from tests.learner_node.xol.lettered_states import (
    NEVER,
    at,
    failed_walk,
    fixed_letters,
    index,
    is_fixed,
    make_penalty_state,
    new_agent,
    q_of,
    rewarded_walk,
    rewards_of,
    take,
    take_any,
    walk,
)

STRATEGY_1 = {"strategy": "strategy1", "rewards_to_fix": 2}
AT_ONCE = {"strategy": "strategy1", "rewards_to_fix": 1}
STRATEGY_2 = {"strategy": "strategy2"}
NONE = {"strategy": "none", "rewards_to_fix": 1}

# -- rewards --------------------------------------------------------------------------


def test_a_reward_reinforces_the_rules_in_the_queue_by_their_eligibility():
    agent = new_agent()
    rewarded_walk(agent, "ABC", "010", value=8.0)
    assert [q_of(agent, letter) for letter in "ABC"] == [[2, 0], [0, 4], [8, 0]]


def test_a_reward_reaches_back_as_far_as_the_queue():
    agent = new_agent(queue_length=2)
    rewarded_walk(agent, "ABC", "000", value=8.0)
    assert [q_of(agent, letter)[0] for letter in "ABC"] == [0, 4, 8]


def test_a_rule_chosen_twice_is_reinforced_once():
    agent = new_agent()
    rewarded_walk(agent, "AA", "00", value=8.0)
    assert q_of(agent, "A") == [8.0 * (0.5 + 1.0), 0]


def test_a_reward_leaves_the_penalties_alone():
    agent = new_agent()
    failed_walk(agent, "A", "0")
    before = agent.rules.p.copy()
    rewarded_walk(agent, "A", "1")
    assert np.array_equal(agent.rules.p, before)


def test_an_episode_starts_with_an_empty_queue():
    agent = new_agent()
    walk(agent, "AB", "00")
    walk(agent, "C", "0")
    agent.reward(8.0, counts=True)
    assert q_of(agent, "A") == q_of(agent, "B") == [0, 0]


def test_a_reward_counts_once_per_state():
    agent = new_agent()
    rewarded_walk(agent, "ABAA", "0011")
    assert [rewards_of(agent, letter) for letter in "AB"] == [1, 1]


@pytest.mark.parametrize(
    "counted, expected", [("queue", [0, 0, 1, 1]), ("episode", [1, 1, 1, 1])]
)
def test_a_reward_counts_in_the_queue_or_in_the_whole_episode(counted, expected):
    agent = new_agent(queue_length=2, fixed_mode={"counted": counted})
    rewarded_walk(agent, "ABCD", "0000")
    assert [rewards_of(agent, letter) for letter in "ABCD"] == expected


@pytest.mark.parametrize("whole_task, expected", [(False, [0, 1]), (True, [1, 1])])
def test_a_reward_counts_beyond_the_queue_once_the_whole_task_is_done(
    whole_task, expected
):
    agent = new_agent(queue_length=1, fixed_mode={"counted": "queue_then_episode"})
    rewarded_walk(agent, "AB", "00", whole_task=whole_task)
    assert [rewards_of(agent, letter) for letter in "AB"] == expected


@pytest.mark.parametrize("counted", ("queue", "episode"))
def test_a_reward_does_not_count_for_states_of_other_episodes(counted):
    agent = new_agent(fixed_mode={"counted": counted})
    rewarded_walk(agent, "A", "0")
    rewarded_walk(agent, "B", "0")
    assert rewards_of(agent, "A") == 1


def test_a_reward_may_not_count():
    agent = new_agent(fixed_mode=AT_ONCE)
    rewarded_walk(agent, "AB", "00", counts=False)
    assert rewards_of(agent, "A") == 0
    assert fixed_letters(agent, "AB") == ""


# -- becoming fixed -------------------------------------------------------------------


def test_strategy_1_leaves_a_state_normal_before_k_rewards():
    agent = new_agent(fixed_mode=STRATEGY_1)
    rewarded_walk(agent, "AB", "00")
    assert fixed_letters(agent, "AB") == ""


def test_strategy_1_fixes_a_state_after_k_rewards():
    agent = new_agent(fixed_mode=STRATEGY_1)
    rewarded_walk(agent, "AB", "00")
    rewarded_walk(agent, "BC", "00")
    assert fixed_letters(agent, "ABC") == "B"


def test_strategy_1_does_not_ask_for_the_end_of_a_subtask():
    agent = new_agent(fixed_mode=STRATEGY_1)
    rewarded_walk(agent, "A", "0")
    agent.finish_subtask()
    assert not is_fixed(agent, "A")


def test_strategy_2_leaves_states_normal_within_a_subtask():
    agent = new_agent(fixed_mode=STRATEGY_2)
    for _ in range(20):
        rewarded_walk(agent, "A", "0")
    assert not is_fixed(agent, "A")


def test_strategy_2_fixes_the_rewarded_states_at_the_end_of_a_subtask():
    agent = new_agent(fixed_mode=STRATEGY_2, minimum_selections=NEVER)
    rewarded_walk(agent, "AB", "00")
    failed_walk(agent, "C", "0")
    agent.finish_subtask()
    assert fixed_letters(agent, "ABC") == "AB"


def test_without_a_strategy_no_state_is_ever_fixed():
    agent = new_agent(fixed_mode=NONE)
    for _ in range(20):
        rewarded_walk(agent, "AB", "00")
        agent.finish_subtask()
    assert fixed_letters(agent, "AB") == ""


def rewarded_penalty_state(fixed_mode):
    """An agent that is rewarded in the penalty state A."""
    agent = new_agent(fixed_mode=fixed_mode, failure_threshold=0.0)
    make_penalty_state(agent, "A")
    agent.begin_episode(at("A"))
    take_any(agent)
    agent.reward(1.0, counts=True)
    agent.finish_subtask()
    return agent


@pytest.mark.parametrize("fixed_mode", (AT_ONCE, STRATEGY_2), ids=("1", "2"))
def test_no_strategy_fixes_a_penalty_state(fixed_mode):
    assert not is_fixed(rewarded_penalty_state(fixed_mode), "A")


# -- being fixed ----------------------------------------------------------------------


def fixed_agent(letters, **changes):
    """An agent whose states are fixed, with the second alternative the better one."""
    mode = {**AT_ONCE, **changes.pop("fixed_mode", {})}
    agent = new_agent(
        fixed_mode=mode, minimum_selections=changes.pop("n0", NEVER), **changes
    )
    rewarded_walk(agent, letters, "1" * len(letters), value=1e9)
    assert fixed_letters(agent, letters) == letters
    return agent


@pytest.mark.parametrize("draw", (0.0, 0.4, 0.6, 0.999))
def test_a_fixed_state_acts_greedily_whatever_is_drawn(draw):
    agent = fixed_agent("A")
    agent.begin_episode(at("A"))
    agent.rng.coming = [draw]
    assert agent.choose().tolist() == [1]


def test_a_reward_does_not_change_the_weights_of_a_fixed_state():
    agent = fixed_agent("A")
    before = q_of(agent, "A")
    rewarded_walk(agent, "AB", "10", value=1e9)
    assert q_of(agent, "A") == before


def test_a_reward_changes_the_weights_of_normal_states_beside_a_fixed_one():
    agent = fixed_agent("A")
    rewarded_walk(agent, "AB", "10", value=8.0, counts=False)
    assert q_of(agent, "B") == [8, 0]


def test_a_fixed_state_goes_on_counting_rewards():
    agent = fixed_agent("A")
    rewarded_walk(agent, "A", "1")
    assert rewards_of(agent, "A") == 2


# -- release --------------------------------------------------------------------------


def test_a_penalty_releases_the_last_three_fixed_states():
    agent = fixed_agent("ABCDE")
    failed_walk(agent, "ABCDE", "11111")
    assert fixed_letters(agent, "ABCDE") == "AB"


@pytest.mark.parametrize("count, left", [(0, "ABCDE"), (1, "ABCD"), (5, "")])
def test_as_many_fixed_states_are_released_as_is_set(count, left):
    agent = fixed_agent("ABCDE", fixed_mode={"released_states": count})
    failed_walk(agent, "ABCDE", "11111")
    assert fixed_letters(agent, "ABCDE") == left


def test_fixed_states_before_the_last_three_decisions_stay_fixed():
    agent = fixed_agent("AB")
    failed_walk(agent, "ABXYZ", "11000")
    assert fixed_letters(agent, "AB") == "AB"


def test_the_last_three_decisions_may_all_be_in_one_state():
    agent = fixed_agent("AB")
    failed_walk(agent, "ABBB", "1111")
    assert fixed_letters(agent, "AB") == "A"


def test_the_nearest_fixed_states_may_lie_before_the_last_three_decisions():
    agent = fixed_agent("ABCD", fixed_mode={"release": "nearest"})
    failed_walk(agent, "ABCDXYZ", "1111000")
    assert fixed_letters(agent, "ABCD") == "A"


def test_the_nearest_fixed_states_must_be_in_the_queue():
    agent = fixed_agent("AB", fixed_mode={"release": "nearest"}, queue_length=4)
    failed_walk(agent, "ABXYZ", "11000")
    assert fixed_letters(agent, "AB") == "A"


def failures_until_released(letters, walked, most=12, **fixed_mode):
    """How many failures it takes until each fixed state is released, None if more."""
    agent = fixed_agent(letters, fixed_mode=fixed_mode)
    released = dict.fromkeys(letters)
    for failure in range(1, most + 1):
        failed_walk(agent, walked, "1" * len(walked))
        for letter in letters:
            if released[letter] is None and not is_fixed(agent, letter):
                released[letter] = failure
    return released


def test_when_patience_ends_the_nearest_fixed_states_are_released():
    released = failures_until_released("ABCD", "ABCDXYZ", patience_episodes=4, most=4)
    assert released == {"A": None, "B": 4, "C": 4, "D": 4}


def test_when_patience_ends_again_the_next_nearest_are_released():
    released = failures_until_released(
        "ABC", "ABCXYZ", patience_episodes=3, released_states=1
    )
    assert released == {"A": 9, "B": 6, "C": 3}


def test_endless_patience_releases_only_what_is_near():
    released = failures_until_released("AB", "ABXYZ", patience_episodes=0, most=30)
    assert released == {"A": None, "B": None}


def test_a_reward_restores_patience():
    agent = fixed_agent("AB", fixed_mode={"patience_episodes": 3})
    for _ in range(4):
        for _ in range(2):
            failed_walk(agent, "ABXYZ", "11000")
        rewarded_walk(agent, "W", "0", counts=False)
    assert fixed_letters(agent, "AB") == "AB"


def test_a_released_state_counts_its_rewards_from_zero():
    agent = fixed_agent("A")
    failed_walk(agent, "A", "1")
    assert rewards_of(agent, "A") == 0


def test_a_released_state_needs_k_rewards_to_be_fixed_again():
    agent = new_agent(fixed_mode=STRATEGY_1, minimum_selections=NEVER)
    for _ in range(2):
        rewarded_walk(agent, "A", "1")
    failed_walk(agent, "A", "1")
    rewarded_walk(agent, "A", "1")
    assert not is_fixed(agent, "A")
    rewarded_walk(agent, "A", "1")
    assert is_fixed(agent, "A")


def test_a_released_state_keeps_its_weights():
    agent = fixed_agent("A")
    before = q_of(agent, "A")
    failed_walk(agent, "A", "1")
    assert q_of(agent, "A") == before


def test_a_released_state_learns_again():
    agent = fixed_agent("A")
    failed_walk(agent, "A", "1")
    rewarded_walk(agent, "A", "0", value=8.0)
    assert q_of(agent, "A")[0] == 8.0


def test_a_normal_state_keeps_its_reward_count_on_a_penalty():
    agent = new_agent(fixed_mode=STRATEGY_1, minimum_selections=NEVER)
    rewarded_walk(agent, "A", "1")
    failed_walk(agent, "A", "1")
    assert rewards_of(agent, "A") == 1


def test_a_fixed_state_that_turns_penalty_state_is_no_longer_fixed():
    agent = new_agent(fixed_mode={**AT_ONCE, "released_states": 0})
    failed_walk(agent, "A", "0")
    rewarded_walk(agent, "A", "1")
    assert is_fixed(agent, "A")
    for _ in range(2):  # 2 failures in 3 selections
        walk(agent, "A", "1")
        agent.penalise(0)
        agent.finish_episode()
    assert agent.rules.penalty_state[index(agent, "A")]
    assert not is_fixed(agent, "A")


def test_a_fixed_state_that_leads_to_a_penalty_state_may_turn_one_itself():
    agent = new_agent(fixed_mode=AT_ONCE, failure_threshold=0.4)
    failed_walk(agent, "A", "0")
    rewarded_walk(agent, "A", "1")
    make_penalty_state(agent, "B")
    agent.begin_episode(at("A"))
    take(agent, 1)
    assert is_fixed(agent, "A")
    agent.advance(at("B"))  # 1 failure in 2 selections
    assert not is_fixed(agent, "A")
