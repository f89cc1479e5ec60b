"""When a task is learned, and after how many episodes."""

from dataclasses import replace

import gymnasium
import pytest

from biped_lab.control_task import TRIALS, ControlTask, good_enough, learn, show
from biped_lab.gym_learning import Step, arrival
from learner_node.learner import Outcome
from learner_node.methods import MethodSettings


def lake(step):
    """A hole ends the episode without reward, which is a failure."""
    if step.terminated and step.reward == 0.0:
        return Outcome(penalty=0, ended=True)
    return arrival(step)


TASK = ControlTask(
    make=lambda: gymnasium.make("FrozenLake-v1", is_slippery=False),
    radii=(),
    settings=MethodSettings(method="q_lambda"),
    goal=1.0,
    best=1.0,
    most_episodes=2000,
    judge=lake,
)


def trials(scores):
    """Return whether these reach a mean of 0.9, and how many of them were seen."""
    left = list(scores)
    found = good_enough(replace(TASK, goal=0.9), lambda: left.pop(0))
    return found, len(scores) - len(left)


def test_a_mean_that_is_the_goal_is_good_enough():
    assert trials([0.0, 0.0] + [1.0] * (TRIALS - 2)) == (True, TRIALS)


def test_no_more_is_tried_than_can_change_the_answer():
    assert trials([1.0, 0.0, 0.0, 0.0] + [1.0] * TRIALS) == (False, 4)


def test_the_last_trial_can_still_decide():
    assert trials([1.0] * (TRIALS - 3) + [0.0] * 3) == (False, TRIALS)


def test_learning_ends_at_a_check_that_reaches_the_goal():
    learned = learn(TASK, TASK.settings, seed=1)
    assert learned.reached
    assert learned.episodes % TASK.check_every == 0
    assert learned.episodes < learned.steps


def test_the_same_seed_learns_the_same():
    runs = [learn(TASK, TASK.settings, seed) for seed in (1, 1, 2)]
    assert runs[0] == runs[1] != runs[2]


def test_what_is_never_good_enough_takes_all_episodes():
    task = replace(TASK, goal=2.0, most_episodes=30)
    learned = learn(task, task.settings, seed=1)
    assert (learned.reached, learned.episodes) == (False, 30)


def test_a_score_stands_for_the_return():
    task = replace(TASK, goal=3.0, best=3.0, score=lambda env: 3.0)
    assert learn(task, task.settings, seed=1).episodes == task.check_every


def test_values_may_be_judged_otherwise():
    def nothing(step):
        return Outcome(ended=step.ended)

    task = replace(TASK, judge_of_values=nothing)
    hole = Step(1, 0.0, True, False, {})
    said = [task.asked(method).outcome(hole) for method in ("xol", "q_lambda")]
    assert [outcome.penalty for outcome in said] == [0, None]


@pytest.mark.parametrize(("goal", "status"), [(0.0, 0), (2.0, 1)])
def test_what_is_shown_says_whether_it_was_learned(goal, status, capsys):
    assert show(replace(TASK, goal=goal, most_episodes=25), seed=1) == status
    said = "learned" if status == 0 else "not learned"
    assert capsys.readouterr().out.startswith(f"{said} after 25 episodes, ")
