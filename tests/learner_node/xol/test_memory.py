"""What an agent learned, taken out and put back."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.learner_node.xol.lettered_states import (
    at,
    fixed_letters,
    make_penalty_state,
    new_agent,
    rewarded_walk,
)
from tests.learner_node.xol.random_episodes import runs

NAMES = tuple(new_agent().memory())


def same(a, b):
    return a.keys() == b.keys() and all(np.array_equal(a[name], b[name]) for name in a)


def feed(agent, calls):
    """Return the agent's answers."""
    answers = [getattr(agent, method)(*arguments) for method, arguments in calls]
    return [None if a is None else a.tolist() for a in answers]


@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(run=runs(), data=st.data())
def test_a_restored_agent_goes_on_like_the_one_it_was_taken_from(run, data):
    problem, calls = run
    ends = [n + 1 for n, call in enumerate(calls) if call[0] == "finish_episode"]
    interruption = data.draw(st.sampled_from(ends))
    first, second = problem.learner(), problem.learner()
    feed(first, calls[:interruption])
    second.restore(first.memory())
    second.rng.bit_generator.state = first.rng.bit_generator.state
    rest = calls[interruption:]
    assert feed(first, rest) == feed(second, rest)
    assert same(first.memory(), second.memory())


def test_a_memory_survives_its_way_through_a_file(tmp_path):
    agent = experienced_agent()
    np.savez(tmp_path / "memory.npz", **agent.memory())
    restored = new_agent()
    with np.load(tmp_path / "memory.npz") as file:
        restored.restore(dict(file))
    assert same(restored.memory(), agent.memory())


def test_more_states_than_first_fit_are_restored():
    agent = new_agent()
    letters = [chr(ord("A") + n) for n in range(200)]
    for letter in letters:
        rewarded_walk(agent, letter, "1")
    restored = new_agent()
    restored.restore(agent.memory())
    assert [restored.greedy(at(letter)).tolist() for letter in letters] == [[1]] * 200


def test_a_memory_replaces_all_that_was_known_before():
    restored = new_agent()
    for letter in "PQRSTUV":
        rewarded_walk(restored, letter, "0")
    agent = experienced_agent()
    restored.restore(agent.memory())
    rewarded_walk(restored, "W", "0", value=8.0)
    assert restored.states.count == agent.states.count + 1
    assert restored.rules.q[restored.states.count - 1, 0].tolist() == [8, 0]


def test_an_agent_restored_from_its_own_memory_is_the_same():
    agent, twin = experienced_agent(), experienced_agent()
    agent.restore(agent.memory())
    assert same(agent.memory(), twin.memory())


def test_the_memory_of_a_new_agent_can_be_restored():
    restored = experienced_agent()
    restored.restore(new_agent().memory())
    assert restored.states.count == 0


# -- refusal --------------------------------------------------------------------------


def experienced_agent():
    """An agent with a normal, a fixed and a penalty state."""
    agent = new_agent(fixed_mode={"rewards_to_fix": 2})
    rewarded_walk(agent, "AB", "01")
    rewarded_walk(agent, "A", "0")
    make_penalty_state(agent, "C")
    assert fixed_letters(agent, "ABC") == "A"
    return agent


@pytest.mark.parametrize("name", NAMES)
def test_a_missing_array_is_named(name):
    memory = experienced_agent().memory()
    del memory[name]
    with pytest.raises(ValueError, match=f"array {name} is missing"):
        new_agent().restore(memory)


@pytest.mark.parametrize("name", sorted(set(NAMES) - {"state_life"}))
def test_an_array_of_the_wrong_shape_is_named(name):
    memory = experienced_agent().memory()
    memory[name] = np.zeros((2, 3, 4, 5, 6), dtype=memory[name].dtype)
    with pytest.raises(ValueError, match=f"array {name} is .*2, 3, 4, 5, 6"):
        new_agent().restore(memory)


@pytest.mark.parametrize("name", NAMES)
def test_an_array_of_the_wrong_type_is_named(name):
    memory = experienced_agent().memory()
    memory[name] = memory[name].astype(np.float32)
    with pytest.raises(ValueError, match=f"array {name} is float32"):
        new_agent().restore(memory)


@pytest.mark.parametrize(
    "other, named",
    [({"n_alternatives": 3}, "q"), ({"n_components": 2}, "q")],
    ids=("Na", "Nm"),
)
def test_the_memory_of_another_action_space_is_refused(other, named):
    memory = experienced_agent().memory()
    with pytest.raises(ValueError, match=f"array {named} is"):
        new_agent(**other).restore(memory)


def test_a_memory_with_joint_rules_is_refused_where_sub_rules_are_learned():
    joint = new_agent(n_components=2, decomposed=False)
    joint.begin_episode(at("A"))
    assert joint.rules.space.table_shape == (1, 4)
    with pytest.raises(ValueError, match="array q is"):
        new_agent(n_components=2).restore(joint.memory())


def test_a_refused_memory_changes_nothing():
    agent = experienced_agent()
    before = {name: array.copy() for name, array in agent.memory().items()}
    memory = new_agent().memory()
    del memory["avoided"]
    with pytest.raises(ValueError, match="avoided"):
        agent.restore(memory)
    assert same(agent.memory(), before)
